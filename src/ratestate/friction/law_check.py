"""Whether a law that a user brings is one: its rates, its friction, its steady sliding."""

import numpy as np

from .expressions import FormulaError
from .law_properties import EXAMPLE
from .steady_state import steady_variables

#: speeds [m/s] and, at each, ln(V theta/D) at which a law is tried
SPEEDS = 10.0 ** np.arange(-12.0, 1.5, 0.5)
AGES = np.linspace(-20.3, 20.9, 207)
#: part of a rate by which it may depend on another state, or be off where it is steady
ROUNDING = 1e-9
#: largest error of variables that are made from states, and these from them
ERROR = 1e-10


def check(law, values):
    """Raise FormulaError for what is wrong with a law; nothing is returned.

    values : symbol -> an example of each of its own parameters [SI]
    """
    values = {symbol: np.float64(x) for symbol, x in (EXAMPLE | values).items()}
    _check_coupling(law)
    for V in SPEEDS:
        p = law.equations.coefficients(V, values)
        states = _states(law, V, p)
        _check_finite(law, V, states, p)
        _check_friction(law, V, states, p)
        _check_steady(law, V, states, p)
    _check_root(law, p)
    _check_variables(law, p)


def _states(law, V, p):
    """psi where every ln(V theta/D) is one of `AGES`: a tuple of arrays."""
    return tuple(
        np.broadcast_to(x, AGES.shape) for x in law.variables(0.0, (AGES,) * len(law.states), p)
    )


def _check_coupling(law):
    equations = law.equations
    for k, rate in enumerate(equations.rates):
        for j, psi in enumerate(equations.psi):
            slope = equations.derivative(rate, psi)
            if j != k and not (slope.kind == "number" and slope.parts[0] == 0.0):
                names = list(law.states)
                raise FormulaError(
                    f"the rate of {names[k]} depends on {names[j]}. A state may depend on V and "
                    f"itself alone.",
                    "evolution",
                )


def _check_finite(law, V, psi, p):
    e = law.exponentials(0.0, 1.0, psi, p)
    found = {
        ("", "evolution"): law.rates(0.0, 1.0, psi, e, p),
        ("a derivative of ", "evolution"): law.rate_partials(0.0, 1.0, psi, e, p),
        ("", "friction"): law.resistance(0.0, 1.0, psi, p),
        ("a derivative of ", "friction"): law.resistance_partials(0.0, 1.0, psi, p),
    }
    for (what, method), numbers in found.items():
        for x in _leaves(numbers):
            if (bad := ~np.isfinite(np.broadcast_to(x, AGES.shape))).any():
                age = AGES[np.argmax(bad)]
                raise FormulaError(
                    f"{what}{method} is infinite or NaN at V = {V:.3g} m/s and V theta/D = "
                    f"{np.exp(age):.3g}. Write another formula there by ratestate.laws.where.",
                    method,
                )


def _check_friction(law, V, psi, p):
    by_v, _ = law.resistance_partials(0.0, 1.0, psi, p)
    by_v = np.broadcast_to(by_v, AGES.shape)
    if not (by_v > 0.0).all():
        k = int(np.argmin(by_v))
        raise FormulaError(
            f"friction must rise with V at a constant state: d mu/d ln V = "
            f"{by_v[k] * EXAMPLE['a']:.4g} at V = {V:.3g} m/s and V theta/D = "
            f"{np.exp(AGES[k]):.3g}. Mend friction, or the examples of parameters.",
            "friction",
        )


def _check_steady(law, V, psi, p):
    """Each state has one theta at which it is steady: there its rate falls through 0."""
    rates = law.rates(0.0, 1.0, psi, law.exponentials(0.0, 1.0, psi, p), p)
    for name, rate in zip(law.states, rates, strict=True):
        rate = np.broadcast_to(rate, AGES.shape)
        ages, rate = AGES[rate != 0.0], rate[rate != 0.0]
        at = np.flatnonzero(np.diff(np.sign(rate)))
        if len(at) == 1 and rate[at[0]] > 0.0:
            continue
        if len(at) == 0:
            raise FormulaError(
                f"{name} has no steady value at V = {V:.3g} m/s: d {name}/dt has one sign for all "
                f"V {name}/D from 2e-9 to 1e9. Mend evolution, or the examples of parameters.",
                "evolution",
            )
        where = " and ".join(f"{np.exp(ages[k]):.3g}" for k in at)
        problem = "several steady values" if len(at) > 1 else "an unstable steady value"
        raise FormulaError(
            f"{name} has {problem} at V = {V:.3g} m/s: V {name}/D near {where}. A law needs one, "
            f"which {name} goes to.",
            "evolution",
        )


def _check_root(law, p):
    psi = steady_variables(law, tuple(np.array([x]) for x in p), 0.0)
    e = law.exponentials(0.0, 1.0, psi, p)
    slopes = law.rate_partials(0.0, 1.0, psi, e, p)
    if not all(np.isfinite(x).all() for x in _leaves(slopes)):
        raise FormulaError(
            "a derivative of evolution is not a number in steady sliding. Write it another way.",
            "evolution",
        )
    for name, slope in zip(law.states, slopes[1], strict=True):
        if not np.all(slope < 0.0):
            raise FormulaError(
                f"{name} does not go to its steady value: there d {name}/dt does not fall with "
                f"{name}. Mend evolution, or the examples of parameters.",
                "evolution",
            )


def _check_variables(law, p):
    n = range(len(law.states))
    logs = tuple(np.array([0.3 + k, -0.7]) for k in n)
    again = law.log_states(0.4, law.variables(0.4, logs, p), p)
    if not all(np.abs(x - y).max() <= ERROR for x, y in zip(logs, again, strict=True)):
        raise FormulaError(
            "variables_of is not the inverse of log_theta. Mend either.", "variables_of"
        )


def _leaves(nested):
    return [x for one in nested for x in _leaves(one)] if isinstance(nested, tuple) else [nested]
