"""The equations of motion under a law as recurrences of Taylor coefficients (expansion.py)."""

import functools
from typing import NamedTuple

from .expansion import expand
from .series import Graph, NotASeries

#: order of the Taylor method: degree of its polynomials in time
ORDER = 12


class Equations(NamedTuple):
    """The equations of motion as `Series`."""

    derivatives: dict  # x, v and each psi -> derivative in T
    integrands: list  # powers of `works`


@functools.cache
def equations(law):
    """`Equations` under a law; NotASeries where it has no recurrences."""
    graph = Graph()
    x, v, *states = (graph.unknown(("y", i)) for i in range(2 + len(law.states)))
    psi, p = tuple(states), tuple(graph.name(("p", i)) for i in range(law.n_coefficients))
    w, w_lp = graph.exp(v, "w"), graph.line("w_lp", "ramp")
    try:
        if law.reverses or law.history(p):
            raise NotASeries("slip that may reverse, or normal stress that varies")
        exponents = law.own_exponents(v, w, psi, p)
        e = tuple(graph.exp(graph.series(one), ("e", i)) for i, one in enumerate(exponents))
        stress = graph.series(law.stress_in_v(v, w, psi, p))
        rates = law.rates_in_v(v, w, psi, e, p)
        acceleration = graph.name("1/eta0") * (x - stress)
        derivatives = [graph.name("kappa") * (w_lp - w), acceleration / w, *rates]
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


@functools.cache
def variational_equations(law):
    """The equations of motion, and those of as many small perturbations as a return map follows.

    `Equations` whose derivatives are x, v and each psi, then these of each perturbation, and whose
    only integrand is the trace of the Jacobian matrix.
    """
    derivatives, _ = equations(law)
    graph, y = next(iter(derivatives)).graph, list(derivatives)
    everything = dict(derivatives)
    for j in range(len(y) - 1):
        z = [graph.unknown(("z", j, i)) for i in range(len(y))]
        changes = dict(zip(y, z, strict=True))
        rates = [graph.differential(rate, changes) for rate in derivatives.values()]
        everything |= dict(zip(z, rates, strict=True))
    unit = {one: {other: graph.series(float(other is one)) for other in y} for one in y}
    diagonal = [graph.differential(rate, unit[one]) for one, rate in derivatives.items()]
    return Equations(everything, [sum(diagonal, graph.series(0.0))])


def coefficients(law, y, w, e, w_lp, ramp, kappa, eta0, p):
    """Taylor coefficients in T of x, v and each psi, and of the powers of `works`.

    Lists, the latter of one less; arguments as of `rodas5p.step`, any kind of numbers.
    """
    known = _known(y, w, e, w_lp, kappa, eta0, p) | {"ramp": ramp}
    derivatives, powers = equations(law)
    return expand(derivatives, powers, ORDER, known)


def variational_coefficients(law, y, w, e, z, kappa, eta0, p):
    """Taylor coefficients in T of x, v and psi, of each number of z in turn, and of the trace.

    Lists.  The load point is at V0.

    z : perturbations of the state
    """
    known = _known(y, w, e, 1.0, kappa, eta0, p) | {"ramp": None}
    known |= {("z", j, i): value for j, one in enumerate(z) for i, value in enumerate(one)}
    derivatives, integrands = variational_equations(law)
    found, (trace,) = expand(derivatives, integrands, ORDER, known)
    n = len(y)
    return found[:n], found[n:], trace


def _known(y, w, e, w_lp, kappa, eta0, p):
    """What `equations` has names for; but for the ramp."""
    known = {"w": w, "1/eta0": 1.0 / eta0, "kappa": kappa, "w_lp": w_lp}
    for name, values in ("y", y), ("e", e), ("p", p):
        known |= {(name, i): value for i, value in enumerate(values)}
    return known
