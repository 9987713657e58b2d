"""One step of the Taylor method: its coefficients by recurrences, and the step that they allow.

The polynomial of the step is its dense output too.  The step follows from the last two coefficients
(Jorba & Zou 2005 doi:10.1080/10586458.2005.10128904), and is never rejected.
"""

import functools
import math

from ..friction.functions import exp, larger, rough_log2, where
from ..friction.rewriting import Derivative
from ..friction.taylor import NoSeries, expand
from ..friction.tuples import largest, pairwise_sum, product

#: order of the method: degree of its polynomials in time
ORDER = 12
#: part of the tolerance that the last terms of a step may reach
PART = 0.1
#: least size of a coefficient, where a step is at its longest
LEAST = 1e-300
LN2 = math.log(2.0)
#: integrals of the powers of s from 0 to 1
OF_INTEGRAL = tuple(1.0 / (k + 1.0) for k in range(ORDER))


@functools.cache
def equations(law):
    """x, v and each psi -> derivative in T, and a list of `work_rates`: expressions.

    NoSeries if slip may reverse, or normal stress varies.
    """
    if law.reverses or law.varies:
        raise NoSeries("slip that may reverse, or normal stress that varies")
    motion, known = law.motion, law.motion.symbols
    x, w_lp, w, S = known["x"], known["w_lp"], motion.w, motion.S
    of_x_and_v = known["kappa"] * (w_lp - w), known["1/eta0"] * (x - S) / w
    derivatives = zip((x, motion.v, *motion.psi), (*of_x_and_v, *motion.f), strict=True)
    return dict(derivatives), [x * w_lp, S * w]


@functools.cache
def has_recurrences(law):
    """Whether all that a law's equations hold has a rule."""
    try:
        expand(equations(law)[0], [], 0, {})
    except NoSeries:
        return False
    return True


@functools.cache
def variational_equations(law):
    """The equations of motion, and those of as many small perturbations as a return map follows.

    Symbols of the perturbations, a list of lists; x, v and each psi, then these, -> derivatives;
    and the trace of the Jacobian matrix.
    """
    (motion, _), graph = equations(law), law.motion.graph
    everything, perturbations = dict(motion), []
    for j in range(len(motion) - 1):
        z = [graph.symbol(("z", j, i), is_constant=False) for i in range(len(motion))]
        along = Derivative(graph, dict(zip(motion, z, strict=True)))
        everything |= dict(zip(z, map(along, motion.values()), strict=True))
        perturbations.append(z)
    diagonal = (Derivative(graph, {y: graph.one})(rate) for y, rate in motion.items())
    return perturbations, everything, sum(diagonal, graph.number(0.0))


def coefficients(start, w_lp, ramp):
    """Taylor coefficients in T of x, v and each psi, and of `work_rates`, lists of lists.

    Of the powers one less; arguments as of `rodas5p.step`, any kind of numbers.
    """
    derivatives, powers = equations(start.law)
    return expand(derivatives, powers, ORDER, _known(start, (w_lp, ramp)))


def variational_coefficients(start, z):
    """Taylor coefficients in T of x, v and psi, of each number of z in turn, and of the trace.

    Lists.  The load point is at V0.

    z : perturbations of the state
    """
    known, n = _known(start, 1.0), len(start.y)
    perturbations, derivatives, trace = variational_equations(start.law)
    for symbols, one in zip(perturbations, z, strict=True):
        known |= zip(symbols, one, strict=True)
    found, (of_trace,) = expand(derivatives, [trace], ORDER, known)
    return found[:n], found[n:], of_trace


def _known(start, w_lp):
    """Values of all symbols and exponentials of `equations`."""
    symbols = start.motion.symbols
    numbers = {"x": start.x, "w_lp": w_lp, "kappa": start.kappa, "1/eta0": 1.0 / start.eta0}
    return start.symbol_values | {symbols[name]: x for name, x in numbers.items()}


def longest(last, before, tolerance):
    """The step that the sizes of the last two coefficients allow, to 1 %.

    last, before : of order `ORDER`, and one less; `LEAST` at least
    """
    allowed = rough_log2(PART * tolerance)
    by_last = (allowed - rough_log2(last)) * (1.0 / ORDER)
    by_before = (allowed - rough_log2(before)) * (1.0 / (ORDER - 1))
    return exp(LN2 * where(by_last < by_before, by_last, by_before))


def size(y, momentum):
    """The largest size of x, v and each psi; `LEAST` at least.

    momentum : how many times larger an error of v becomes one of x, if that is more than once:
        sqrt(kappa eta0) w, the amplitude in x of a free vibration of this speed
    """
    weight = where(momentum > 1.0, momentum, 1.0)
    return larger(larger(abs(y[0]), weight * abs(y[1])), larger(largest(y[2:]), LEAST))


def powers(h):
    """h**k for k from 0 to `ORDER`."""
    found = [1.0, h]
    for k in range(2, ORDER + 1):
        found.append(found[k // 2] * found[k - k // 2])
    return tuple(found)


def integrals(c, h):
    """The integrals of polynomials over a step, over its length; h : its `powers`."""
    weights = product(OF_INTEGRAL, h)
    return tuple(pairwise_sum(product(one, weights)) for one in c)
