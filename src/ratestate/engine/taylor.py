"""One step of the Taylor method: its coefficients by recurrences, and its length.

The polynomial of the step is also its dense output.  The length follows from the last two
coefficients (Jorba & Zou 2005 doi:10.1080/10586458.2005.10128904), and no step is rejected.
"""

import functools
import math

from ..friction.functions import exp, larger, rough_log2, where
from ..friction.rewriting import Derivative
from ..friction.taylor import NoSeries, expand
from ..friction.tuples import largest, pairwise_sum, product

#: order of the method: degree of its polynomials in time
ORDER = 12
#: largest size of the last terms of a step, as a fraction of the tolerance
TERM_SHARE = 0.1
#: smallest size of a coefficient, which limits the length of a step
TINY = 1e-300
LN2 = math.log(2.0)
#: integrals of the powers of s from 0 to 1
INTEGRAL_WEIGHTS = tuple(1.0 / (k + 1.0) for k in range(ORDER))


@functools.cache
def equations(law):
    """Return x, v, psi -> derivative in T, and a list of the powers of `work_rates`.

    They are expressions.  NoSeries if slip may reverse or normal stress varies.
    """
    if law.reverses or law.varies:
        raise NoSeries("slip that may reverse, or normal stress that varies")
    motion, symbols = law.motion, law.motion.symbols
    x, w_lp, w, S = symbols["x"], symbols["w_lp"], motion.w, motion.S
    of_x_and_v = symbols["kappa"] * (w_lp - w), symbols["1/eta0"] * (x - S) / w
    derivatives = zip((x, motion.v, *motion.psi), (*of_x_and_v, *motion.f), strict=True)
    return dict(derivatives), [x * w_lp, S * w]


@functools.cache
def has_recurrences(law):
    """Return whether every expression in a law's equations has a recurrence."""
    try:
        expand(equations(law)[0], [], 0, {})
    except NoSeries:
        return False
    return True


@functools.cache
def variational_equations(law):
    """Return the equations of motion with the perturbations that a return map needs.

    Returns the symbols of the perturbations, a list of lists; x, v, each psi and these symbols ->
    derivative; and the trace of the Jacobian matrix.
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
    """Return Taylor coefficients in T of x, v, each psi, and the powers of `work_rates`.

    Lists, one shorter for powers.  Arguments are those of `rodas5p.step`, in numbers of any kind.
    """
    derivatives, powers = equations(start.law)
    return expand(derivatives, powers, ORDER, _values(start, (w_lp, ramp)))


def variational_coefficients(start, z):
    """Return Taylor coefficients in T of x, v and psi, of z, and of the trace of J.

    The coefficients of all numbers of z are in one list.  The load point moves at V0.

    z : perturbations of the state
    """
    values, n = _values(start, 1.0), len(start.y)
    perturbations, derivatives, trace = variational_equations(start.law)
    for symbols, one in zip(perturbations, z, strict=True):
        values |= zip(symbols, one, strict=True)
    series, (trace_series,) = expand(derivatives, [trace], ORDER, values)
    return series[:n], series[n:], trace_series


def _values(start, w_lp):
    """Return the values of all symbols and exponentials of `equations`."""
    symbols = start.motion.symbols
    numbers = {"x": start.x, "w_lp": w_lp, "kappa": start.kappa, "1/eta0": 1.0 / start.eta0}
    return start.symbol_values | {symbols[name]: x for name, x in numbers.items()}


def step_length(last, previous, tolerance):
    """Return the step that the sizes of the last two coefficients allow, to 1 %.

    last, previous : sizes of the coefficients of order `ORDER` and `ORDER` - 1; at least `TINY`
    """
    allowed = rough_log2(TERM_SHARE * tolerance)
    by_last = (allowed - rough_log2(last)) * (1.0 / ORDER)
    by_previous = (allowed - rough_log2(previous)) * (1.0 / (ORDER - 1))
    return exp(LN2 * where(by_last < by_previous, by_last, by_previous))


def norm(y, momentum):
    """Return the largest size of x, v and each psi; at least `TINY`.

    momentum : factor by which an error of v grows into an error of x, if it is above 1:
        sqrt(kappa eta0) w, the amplitude in x of a free vibration of this speed
    """
    weight = where(momentum > 1.0, momentum, 1.0)
    return larger(larger(abs(y[0]), weight * abs(y[1])), larger(largest(y[2:]), TINY))


def powers(h):
    """Return h**k for k from 0 to `ORDER`."""
    each = [1.0, h]
    for k in range(2, ORDER + 1):
        each.append(each[k // 2] * each[k - k // 2])
    return tuple(each)


def integrals(c, h):
    """Return the means of polynomials over a step; h : `powers` of its length."""
    weights = product(INTEGRAL_WEIGHTS, h)
    return tuple(pairwise_sum(product(one, weights)) for one in c)
