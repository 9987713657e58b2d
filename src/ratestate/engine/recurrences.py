"""The equations of motion under a law, and Taylor coefficients of it (friction/taylor.py)."""

import functools
from typing import NamedTuple

from ..friction.rewriting import Derivative
from ..friction.taylor import NoSeries, expand

#: order of the Taylor method: degree of its polynomials in time
ORDER = 12


class Equations(NamedTuple):
    """The equations of motion as expressions of the law's graph."""

    symbols: dict  # name -> symbol of what is no quantity of the law
    p: tuple  # symbols of all coefficients
    derivatives: dict  # x, v and each psi -> derivative in T
    integrands: list  # powers of `works`


@functools.cache
def equations(law):
    """`Equations` under a law; NoSeries where it has no recurrences."""
    if law.reverses or law.varies:
        raise NoSeries("slip that may reverse, or normal stress that varies")
    motion = law.motion
    graph, names = motion.graph, ("stiffness", "1/eta0")
    symbols = {name: graph.symbol(name) for name in names}
    symbols |= {name: graph.symbol(name, is_constant=False) for name in ("x", "w_lp")}
    x, v, w, (stress,) = symbols["x"], motion.v, motion.w, motion.stress
    derivatives = {
        x: symbols["stiffness"] * (symbols["w_lp"] - w),
        v: symbols["1/eta0"] * (x - stress) / w,
        **dict(zip(motion.psi, motion.rates, strict=True)),
    }
    return Equations(symbols, motion.p, derivatives, [x * symbols["w_lp"], stress * w])


@functools.cache
def has_recurrences(law):
    """Whether all that a law's equations hold has a rule."""
    try:
        expand(equations(law).derivatives, [], 0, {})
    except NoSeries:
        return False
    return True


@functools.cache
def variational_equations(law):
    """The equations of motion, and those of as many small perturbations as a return map follows.

    Symbols of the perturbations, a list of lists; x, v and each psi, then these, -> derivatives;
    and the trace of the Jacobian matrix.
    """
    motion, graph = equations(law).derivatives, law.equations.graph
    everything, perturbations = dict(motion), []
    for j in range(len(motion) - 1):
        z = [graph.symbol(("z", j, i), is_constant=False) for i in range(len(motion))]
        along = Derivative(graph, dict(zip(motion, z, strict=True)))
        everything |= dict(zip(z, map(along, motion.values()), strict=True))
        perturbations.append(z)
    diagonal = (Derivative(graph, {y: graph.one})(rate) for y, rate in motion.items())
    return perturbations, everything, sum(diagonal, graph.number(0.0))


def coefficients(law, y, w, e, w_lp, ramp, kappa, eta0, p):
    """Taylor coefficients in T of x, v and each psi, and of the powers of `works`.

    Lists, the latter of one less; arguments as of `rodas5p.step`, any kind of numbers.
    """
    known = _known(law, y, w, e, (w_lp, ramp), kappa, eta0, p)
    of_law = equations(law)
    return expand(of_law.derivatives, of_law.integrands, ORDER, known)


def variational_coefficients(law, y, w, e, z, kappa, eta0, p):
    """Taylor coefficients in T of x, v and psi, of each number of z in turn, and of the trace.

    Lists.  The load point is at V0.

    z : perturbations of the state
    """
    known = _known(law, y, w, e, 1.0, kappa, eta0, p)
    perturbations, derivatives, trace = variational_equations(law)
    for symbols, one in zip(perturbations, z, strict=True):
        known |= zip(symbols, one, strict=True)
    found, (of_trace,) = expand(derivatives, [trace], ORDER, known)
    n = len(y)
    return found[:n], found[n:], of_trace


def _known(law, y, w, e, w_lp, kappa, eta0, p):
    """Values of all symbols and exponentials of `equations`."""
    of_law, own = equations(law), law.equations
    known = {of_law.symbols["stiffness"]: kappa, of_law.symbols["1/eta0"]: 1.0 / eta0}
    known |= {own.w: w, of_law.symbols["w_lp"]: w_lp}
    known |= zip(of_law.derivatives, y, strict=True)
    known |= zip(of_law.p, p, strict=True)
    return known | dict(zip(own.exponentials, e, strict=True))
