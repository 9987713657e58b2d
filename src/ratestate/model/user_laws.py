"""The function `register`: check a user's friction law and make it available by name."""

import keyword
import os

from ..errors import ParameterError
from ..friction import laws
from ..friction.expressions import FormulaError
from ..friction.law_formula import HASH_MARK
from ..friction.user_law import (
    USER_ERRORS,
    check_formulas,
    class_from_file,
    class_from_text,
    describe_error,
    make_user_law,
    reason_of,
)
from .names import refusal
from .quantities import KINDS, QUANTITIES, Quantity, add_quantities_of, quantity
from .units import to_si

#: names that sliders, scenario files and results use for other things than quantities
RESERVED_NAMES = frozenset(
    "law law_file area values parameters friction replace slider loading method function file plot"
    " steps times initial parameter start stop point case columns units".split()
)


def register(law):
    """Check a friction law of your own and make it available by its name.

    Parameters
    ----------
    law : type or path
        A class that derives from `ratestate.FrictionLaw`, with the method
        ``evolution(self, V, theta, p)``, or a Python file with one such class, which is run.

    Returns
    -------
    str
        The name of the law with the first digits of a hash of its formula, such as
        "mine@1f6ac03b".  Results record this name.  The parameter ``law`` of `SpringSlider` accepts
        this name, the class, which it registers too, or "mine", which means the last law registered
        under this name.

    Raises
    ------
    ParameterError
        If the file cannot be read or run, or does not contain exactly one law; if the name belongs
        to a built-in law; if the name or unit of a parameter is not allowed; if the formula uses
        ``if`` or a function that `ratestate.laws` does not have, or gives infinite values or NaN;
        if a state depends on another state; if a state has no steady value, or several.

    Examples
    --------
    >>> import ratestate as rs
    >>> class Mine(rs.FrictionLaw):
    ...     name = "mine"
    ...     def evolution(self, V, theta, p):
    ...         return 1.0 - (V * theta / p.Dc) ** 1.5
    >>> rs.register(Mine).partition("@")[0]
    'mine'
    """
    law_class = class_from_file(law) if isinstance(law, str | os.PathLike) else law
    try:
        new = make_user_law(law_class)
    except ParameterError:
        raise
    except USER_ERRORS as error:
        raise ParameterError(f"law{_origin(law)} cannot be made: {reason_of(error)}") from error
    base_name = new.name.partition(HASH_MARK)[0]
    if new.name in laws.LAWS:
        laws.add(new, base_name)
        return new.name
    try:
        _check_names(new, base_name)
        check_formulas(new, {symbol: _example(symbol, new) for symbol in new.parameters})
    except ParameterError as error:
        raise ParameterError(
            f"law {base_name!r}{_origin(law)}: {error.problem}", error.remedy
        ) from None
    except FormulaError as error:
        raise ParameterError(describe_error(base_name, new, error)) from None
    except USER_ERRORS as error:
        raise ParameterError(
            f"law {base_name!r}{_origin(law)} cannot be tried: {reason_of(error)}"
        ) from error
    add_quantities_of(new)
    laws.add(new, base_name)
    return new.name


def _origin(law):
    """Return the file of a law for a message; "" if the law is a class."""
    return "" if isinstance(law, type) else f" of {law}"


def _check_names(law, base_name):
    """Raise ParameterError if a name is in use or a quantity is not allowed."""
    for name in (base_name, *law.synonyms):
        known = laws.find_law_name(name)
        if known and HASH_MARK not in known:
            raise refusal("law.built_in", name=name)
    for symbol, parameter in law.parameters.items():
        quantity = Quantity(*parameter)
        if not _is_allowed_name(symbol) or _is_other_quantity(symbol, quantity, base_name):
            raise refusal("law.other_quantity", symbol=symbol)
        if quantity.unit not in KINDS or quantity.bound not in ("", "> 0", ">= 0"):
            known = ", ".join(KINDS)
            raise refusal("law.quantity", symbol=symbol, quantity=quantity, units=known)
    known = {state for other in laws.LAWS.values() for state in other.states}
    for state, (_, distance) in law.states.items():
        if not _is_allowed_name(state) or (state in QUANTITIES and state not in known):
            raise refusal("law.state", state=state)
        if distance != "Dc" and getattr(law.parameters.get(distance), "unit", "") != "m":
            raise refusal("law.distance", state=state, distance=distance)


def _is_allowed_name(text):
    return text.isidentifier() and not keyword.iskeyword(text) and text not in RESERVED_NAMES


def _is_other_quantity(symbol, quantity, base_name):
    """Return whether a symbol is another quantity, except in versions of this law."""
    owners = laws.laws_with(symbol)
    if not owners:
        return symbol in QUANTITIES
    others = [name for name in owners if name.partition(HASH_MARK)[0] != base_name]
    known = QUANTITIES[symbol]
    return bool(others) and (known.unit, known.bound) != (quantity.unit, quantity.bound)


def _example(symbol, law):
    """Return the example of a parameter [SI], or 1 if it has none."""
    law_quantity = Quantity(*law.parameters[symbol])
    if not law_quantity.example:
        return 1.0
    before = QUANTITIES.get(symbol)
    QUANTITIES[symbol] = quantity(*law_quantity._replace(example=""))
    try:
        return to_si(symbol, law_quantity.example.strip("'\""))
    except ParameterError as error:
        raise ParameterError(
            f"the example of its parameter {symbol} cannot be used: {error.text(symbol)}"
        ) from None
    finally:
        del QUANTITIES[symbol]
        if before is not None:
            QUANTITIES[symbol] = before


def file_of_law(name):
    """Return the Path of the law's file; None if the law is not from a file."""
    return vars(type(laws.LAWS[name])).get("file")


def source_of_law(name):
    """Return the file's text, or the class, of a user's law; None if it is built in."""
    if HASH_MARK not in name:
        return None
    law_class = type(laws.LAWS[name])
    return vars(law_class).get("file_text") or law_class


def register_source(source):
    """Register a law from `source_of_law`, unless it is registered already."""
    registered = (vars(type(law)).get("file_text") or type(law) for law in laws.LAWS.values())
    if source is not None and source not in registered:
        register(class_from_text(source, "a law file") if isinstance(source, str) else source)
