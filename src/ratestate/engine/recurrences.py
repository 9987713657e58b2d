"""The equations of motion under a law as recurrences of Taylor coefficients (series.py)."""

import functools
from typing import NamedTuple

from .series import Graph, NotASeries, expand

#: order of the Taylor method: degree of its polynomials in time
ORDER = 12


class Equations(NamedTuple):
    """The equations of motion as `Series`."""

    derivatives: dict  # x, v and each psi -> derivative in T
    powers: list  # of `works`


@functools.cache
def equations(law):
    """`Equations` under a law; NotASeries where it has no recurrences."""
    graph = Graph()
    x, v, *states = (graph.unknown(("y", i)) for i in range(2 + len(law.states)))
    psi, p = tuple(states), tuple(graph.name(("p", i)) for i in range(law.n_coefficients))
    w, w_lp = graph.exp(v, "w"), graph.line("w_lp", "ramp")
    response = graph.exp(-v, "1/(eta0 w)")  # of dv/dT to the inertial force
    try:
        if law.reverses or law.history(p):
            raise NotASeries("slip that may reverse, or normal stress that varies")
        exponents = law.own_exponents(v, w, psi, (), p)
        e = tuple(graph.exp(graph.series(one), ("e", i)) for i, one in enumerate(exponents))
        stress = graph.series(law.stress_in_v(v, w, psi, p))
        rates = law.rates_in_v(v, w, psi, e, p)
        derivatives = [graph.name("kappa") * (w_lp - w), (x - stress) * response, *rates]
        named = zip((x, v, *psi), map(graph.series, derivatives), strict=True)
    except Exception as error:  # (where it gets no numbers, a law of a user may raise anything)
        raise NotASeries(f"the law {law.name}") from error
    return Equations(dict(named), [x * w_lp, stress * w])


def has_recurrences(law):
    """Whether all that a law's equations hold has a rule."""
    try:
        equations(law)
    except NotASeries:
        return False
    return True


def coefficients(law, y, w, e, w_lp, ramp, kappa, eta0, p):
    """Taylor coefficients in T of x, v and each psi, and of the powers of `works`.

    Lists, the latter of one less; arguments as of `rodas5p.step`, any kind of numbers.
    """
    known = {"w": w, "1/(eta0 w)": 1.0 / (eta0 * w), "kappa": kappa, "w_lp": w_lp, "ramp": ramp}
    for name, values in ("y", y), ("e", e), ("p", p):
        known |= {(name, i): value for i, value in enumerate(values)}
    derivatives, powers = equations(law)
    return expand(derivatives, powers, ORDER, known)
