"""Friction laws of users: read from a file or class, named with a hash.

The hash is taken of the expressions that a run of the formula yields (equations.py), with all
constants in them.  So an edited law gets another name and its own machine code, and each result
names the law that made it.  A law file is Python code and runs when it is read, so it is read only
if the user names it.
"""

import hashlib
import re
import sys
import traceback
import types
from pathlib import Path

import numpy as np

from ..errors import MissingFileError, ParameterError
from .expressions import FormulaError
from .law import FrictionLaw
from .law_formula import EXAMPLE, HASH_MARK
from .rewriting import Derivative
from .steady_state import steady_point, steady_problem

#: errors that a user's code may raise, except an interrupt
USER_ERRORS = (Exception, SystemExit)
NAME = re.compile(r"[a-z][a-z0-9-]*")
#: prefix of the module name of a law file
MODULE_PREFIX = "ratestate_law_"
#: methods that run once, with expressions
FORMULA_METHODS = ("evolution", "friction", "runaway", "log_theta", "variables_of", "constants")
#: attributes of `FrictionLaw` that a user's law may replace
REPLACEABLE = (
    *(*FORMULA_METHODS, "complaint", "jumps_with_normal_stress"),
    *("name", "label", "synonyms", "source", "form", "states", "parameters"),
    *("__module__", "__doc__", "__dict__", "__weakref__", "__annotations__", "__init__"),
)
#: speeds [m/s] and ln(V theta/D) at which `check_formulas` tests a law
SPEEDS, AGES = 10.0 ** np.arange(-12.0, 1.5, 0.5)[:, None], np.linspace(-20.3, 20.9, 207)
#: largest error allowed in `log_theta` of `variables_of`
INVERSION_ERROR = 1e-10


def class_from_file(path):
    """Run a Python file and return its only class of laws, else ParameterError."""
    try:
        if Path(path).exists() and not Path(path).is_file():  # a folder, or an endless device
            raise OSError(0, "it is not a file")
        text = Path(path).read_text("utf-8")
    except FileNotFoundError:
        raise MissingFileError(f"law file {path} does not exist", "Give its path.") from None
    except (OSError, ValueError) as error:  # ValueError: encoding, or a null character in the path
        reason = getattr(error, "strerror", None) or error
        raise ParameterError(f"law file {path} cannot be read: {reason}") from None
    kind = class_from_text(text, path)
    kind.file = Path(path).resolve()
    return kind


def class_from_text(text, path):
    """Return the only class of laws in a file's text; path : the file, for messages."""
    module = types.ModuleType(f"{MODULE_PREFIX}{_hash(text)}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # pickle looks up the class here
    try:
        exec(compile(text, str(path), "exec"), module.__dict__)
        laws = [x for x in vars(module).values() if _is_law(x) and x.__module__ == module.__name__]
        names = ", ".join(kind.__name__ for kind in laws) or "no law"
    except USER_ERRORS as error:
        del sys.modules[module.__name__]
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == str(path)]
        line = getattr(error, "lineno", None) or (lines[-1] if lines else 1)
        raise ParameterError(
            f"law file {path} cannot be loaded, line {line}: {reason_of(error)}",
            "Correct that line.",
        ) from None
    if len(laws) != 1:
        raise ParameterError(
            f"law file {path} holds {names}",
            "It must hold one class that derives from ratestate.FrictionLaw.",
        )
    laws[0].file_text = text
    return laws[0]


def reason_of(error):
    """Return the type of an error and the first line of its text, if it has one."""
    kind = type(error).__name__
    try:
        return f"{kind}: {error}".splitlines()[0]
    except USER_ERRORS:
        return kind


def make_user_law(kind):
    """Return an instance of a class of laws, named with the hash of its formula.

    ParameterError if it is not such a class, its name is not valid, or its formula cannot be run.
    """
    if not _is_law(kind):
        raise ParameterError(
            f"{kind!r} is not a law", "Give a class that derives from ratestate.FrictionLaw."
        )
    name = getattr(kind, "name", None)
    if not (isinstance(name, str) and NAME.fullmatch(name)):
        raise ParameterError(
            "is not a name in small letters, digits and -",
            "Give for example name = 'mine'.",
            symbol=f"{kind.__name__}.name",
            value=repr(name),
        )
    law = kind()
    if not isinstance(getattr(kind, "label", None), str):
        law.label = f"{name} law"
    bases = kind.__mro__[: kind.__mro__.index(FrictionLaw)]
    defined = {name for base in bases for name in vars(base)}
    if "rates" in defined:
        raise ParameterError(
            f"law {name!r} has the method rates, an old form of laws",
            (
                "Replace it, and its derivatives, by evolution(self, V, theta, p), which "
                "returns d theta/dt."
            ),
        )
    if derived := sorted(x for x in defined if hasattr(FrictionLaw, x) and x not in REPLACEABLE):
        raise ParameterError(
            (
                f"law {name!r} defines {derived[0]}, a name that ratestate uses for a quantity "
                "derived from the formula"
            ),
            "Rename or remove it.",
        )
    if "evolution" not in defined:
        raise ParameterError(
            f"law {name!r} has no method evolution",
            "Add evolution(self, V, theta, p), which returns d theta/dt.",
        )
    try:
        _check_states(law)
        quantities = {symbol: (spec.unit, spec.bound) for symbol, spec in law.parameters.items()}
        content = f"{law.form} {dict(law.states)} {quantities}\n{law.equations.text}"
    except USER_ERRORS as error:
        raise ParameterError(describe_error(name, law, error)) from error
    law.name = f"{name}{HASH_MARK}{_hash(content)}"
    return law


def describe_error(name, law, error):
    """Return the problem with a law's formula, its place in the code, and the remedy."""
    return f"law {name!r}{_code_place(error, law)}: {_explain(error)}"


def _check_states(law):
    """Raise FormulaError if the states use symbols that the law does not have."""
    parameters = (*EXAMPLE, *law.parameters)
    if not law.states:
        raise FormulaError("states is empty. Leave it out for theta alone.")
    for state, symbols in law.states.items():
        missing = [x for x in symbols if x not in parameters]
        if missing or isinstance(symbols, str) or len(symbols) != 2:
            raise FormulaError(
                f"states[{state!r}] = {symbols!r} must be the symbols of b and Dc of this state. "
                f"Add symbols of the law alone to parameters too."
            )


def _code_place(error, law):
    """Return the file and line of an error in a law, or of the method at fault."""
    frames = traceback.extract_tb(error.__traceback__)
    package = Path(__file__).parent
    in_law = [
        k
        for k, frame in enumerate(frames)
        if frame.name in FORMULA_METHODS and package not in Path(frame.filename).parents
    ]
    if in_law:
        file = frames[in_law[0]].filename
        line = [frame.lineno for frame in frames[in_law[0] :] if frame.filename == file][-1]
    elif code := getattr(getattr(law, getattr(error, "method", ""), None), "__code__", None):
        file, line = code.co_filename, code.co_firstlineno
    else:
        return ""
    return f", line {line} of {file}"


def _explain(error):
    if isinstance(error, FormulaError):
        return str(error)
    if isinstance(error, AttributeError) and isinstance(error.obj, types.SimpleNamespace):
        parameters = ", ".join(vars(error.obj))
        return (
            f"p.{error.name} is not a parameter. Add {error.name} to parameters, or take one of "
            f"{parameters}."
        )
    if isinstance(error, RecursionError):
        return "the formula nests too many functions. Write it with fewer."
    return f"{reason_of(error)}. Correct the formula, which runs with symbols for V, theta and p."


def _is_law(value):
    return isinstance(value, type) and issubclass(value, FrictionLaw) and value is not FrictionLaw


def _hash(text):
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def check_formulas(law, values):
    """Raise FormulaError if a law's formulas fail on a grid of speeds and states.

    values : symbol -> example of each of its own parameters [SI]
    """
    _check_coupling(law)
    values = {symbol: np.float64(x) for symbol, x in (EXAMPLE | values).items()}
    p = law.equations.coefficients(SPEEDS, values)
    psi = law.variables(0.0, (AGES,) * len(law.states), p)
    at = law.at_speed(0.0, psi, p)
    _check_finite("", "evolution", at.f)
    _check_finite("a derivative of ", "evolution", at.f_slopes)
    _check_finite("", "friction", at.R)
    _check_finite("a derivative of ", "friction", at.R_slopes)
    if (by_v := _grid_values(at.R_slopes[0])).min() <= 0.0:
        k = np.argmax(by_v <= 0.0)
        raise FormulaError(
            f"friction must rise with V at a constant state: d mu/d ln V = "
            f"{by_v.flat[k] * EXAMPLE['a']:.4g} at {_describe_point(k)}. Correct friction, or "
            f"the examples of parameters.",
            "friction",
        )
    for name, rate in zip(law.states, at.f, strict=True):
        for V, row in zip(SPEEDS[:, 0], _grid_values(rate), strict=True):
            _check_steady(name, V, row)
    if problem := steady_problem(steady_point(law, p, 0.0)):
        raise FormulaError(
            f"{problem}. Correct evolution, or the examples of parameters.", "evolution"
        )
    logs = tuple(AGES + k for k in range(len(law.states)))
    inverse = law.log_states(0.4, law.variables(0.4, logs, p), p)
    if not all(np.abs(x - y).max() <= INVERSION_ERROR for x, y in zip(logs, inverse, strict=True)):
        raise FormulaError(
            "variables_of is not the inverse of log_theta. Correct one of them.", "variables_of"
        )


def _check_coupling(law):
    equations = law.equations
    for k, rate in enumerate(equations.rates):
        for j, psi in enumerate(equations.psi):
            slope = Derivative(equations.graph, {psi: equations.graph.one})(rate)
            if j != k and not (slope.kind == "number" and slope.parts[0] == 0.0):
                names = list(law.states)
                raise FormulaError(
                    f"the rate of {names[k]} depends on {names[j]}. A state may depend on V and "
                    f"itself alone.",
                    "evolution",
                )


def _check_finite(prefix, method, numbers):
    if isinstance(numbers, tuple):
        for number in numbers:
            _check_finite(prefix, method, number)
    elif (bad := ~np.isfinite(_grid_values(numbers))).any():
        raise FormulaError(
            f"{prefix}{method} is infinite or NaN at {_describe_point(np.argmax(bad))}. Give "
            f"another formula for this range with ratestate.laws.where.",
            method,
        )


def _check_steady(name, V, rate):
    """Raise FormulaError unless the rate falls through 0 at exactly one theta."""
    ages, rate = AGES[rate != 0.0], rate[rate != 0.0]
    at = np.flatnonzero(np.diff(np.sign(rate)))
    if len(at) == 1 and rate[at[0]] > 0.0:
        return
    if len(at) == 0:
        raise FormulaError(
            f"{name} has no steady value at V = {V:.3g} m/s: d {name}/dt has one sign for all "
            f"V {name}/D from 2e-9 to 1e9. Correct evolution, or the examples of parameters.",
            "evolution",
        )
    ages_text = " and ".join(f"{np.exp(ages[k]):.3g}" for k in at)
    problem = "several steady values" if len(at) > 1 else "an unstable steady value"
    raise FormulaError(
        f"{name} has {problem} at V = {V:.3g} m/s: V {name}/D near {ages_text}. It needs "
        f"exactly one, which {name} approaches.",
        "evolution",
    )


def _grid_values(x):
    return np.broadcast_to(x, (SPEEDS.size, AGES.size))


def _describe_point(k):
    V, age = SPEEDS.flat[k // AGES.size], AGES[k % AGES.size]
    return f"V = {V:.3g} m/s and V theta/D = {np.exp(age):.3g}"
