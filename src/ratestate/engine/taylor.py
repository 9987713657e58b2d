"""Steps of the Taylor method, and the choice of the method for the next step.

The coefficients follow from recurrences (friction/taylor.py).  The polynomial of the step is also
its dense output.  The length follows from the last two coefficients (Jorba & Zou 2005
doi:10.1080/10586458.2005.10128904), and no step is rejected.

The Taylor method needs a law with recurrences.  It is the faster method if the motion is not stiff:
if accuracy limits a step more than the fastest rate of the equations does.  Each slider takes the
steps that suit it.
"""

import functools
import math

from ..friction.functions import exp, larger, rough_log2, where
from ..friction.rewriting import Derivative
from ..friction.taylor import expand
from ..friction.tuples import largest, pairwise_sum, product, total
from . import lanes as L
from . import rows as R
from .rows import ORDER, rows_of, store_each

#: largest size of the last terms of a step, as a fraction of the tolerance
TERM_SHARE = 0.1
#: smallest size of a coefficient, which limits the length of a step
TINY = 1e-300
LN2 = math.log(2.0)
#: integrals of the powers of s from 0 to 1
INTEGRAL_WEIGHTS = tuple(1.0 / (k + 1.0) for k in range(ORDER))

# The fastest rate of the equations decides between the two methods.
#: Longest Taylor step, times this rate.  At order 12 it is stable up to 5.8 if the rate is a decay.
STABLE = 4.0
#: Rodas5P takes over if accuracy alone would allow a step that is this many times longer.
RODAS5P_ABOVE = 3.0
#: Rodas5P also takes over if stability has limited more than this many steps in a row.
MAX_LIMITED = 8.0
#: The Taylor method takes over if the next step of Rodas5P, times the rate, is shorter than this.
TAYLOR_BELOW = 2.0
#: Powers of rates above this, or below its inverse, would overflow, for example at rest.
FASTEST = 1e20


@functools.cache
def variational_equations(law):
    """Return the equations of motion with the perturbations that a return map needs.

    Returns the symbols of the perturbations, a list of lists; x, v, each psi and these symbols ->
    derivative; and the trace of the Jacobian matrix.
    """
    (motion, _), graph = law.motion.in_time, law.motion.graph
    expressions, perturbations = dict(motion), []
    for j in range(len(motion) - 1):
        z = [graph.symbol(("z", j, i), is_constant=False) for i in range(len(motion))]
        derivative = Derivative(graph, dict(zip(motion, z, strict=True)))
        expressions |= dict(zip(z, map(derivative, motion.values()), strict=True))
        perturbations.append(z)
    diagonal = (Derivative(graph, {y: graph.one})(rate) for y, rate in motion.items())
    return perturbations, expressions, sum(diagonal, graph.number(0.0))


def coefficients(start, w_lp, ramp):
    """Return Taylor coefficients in T of x, v, each psi, and the powers of `work_rates`.

    They are in lists, which are one shorter for powers.  The arguments are as for `rodas5p.step`.
    """
    derivatives, powers = start.motion.in_time
    return expand(derivatives, powers, ORDER, _values(start, (w_lp, ramp)))


def variational_coefficients(start, z):
    """Return Taylor coefficients in T of x, v and psi, of z, and of the trace of J.

    The coefficients of all numbers of z are in one list.  The load point moves at V0.

    z : perturbations of the state
    """
    values, n = _values(start, 1.0), len(start.y)
    perturbations, derivatives, trace = variational_equations(start.law)
    for symbols, numbers in zip(perturbations, z, strict=True):
        values |= zip(symbols, numbers, strict=True)
    series, (trace_series,) = expand(derivatives, [trace], ORDER, values)
    return series[:n], series[n:], trace_series


def _values(start, w_lp):
    """Return the values of all symbols and exponentials of `Motion.in_time`."""
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
    h_powers = [1.0, h]
    for k in range(2, ORDER + 1):
        h_powers.append(h_powers[k // 2] * h_powers[k - k // 2])
    return tuple(h_powers)


def integrals(c, h):
    """Return the means of polynomials over a step; h : `powers` of its length."""
    weights = product(INTEGRAL_WEIGHTS, h)
    return tuple(pairwise_sum(product(row, weights)) for row in c)


# Loops over lanes


def fastest_rate(at, frequency):
    """Return the fastest rate: relaxation of v or of a state, or free vibration."""
    _, of_psi = at.f_slopes
    return larger(larger(abs(at.S_slopes[0]) / (at.eta0 * at.w), frequency), largest(of_psi))


def momentum_of(s, l):
    """Return the momentum of the lane's slider, as `norm` needs it."""
    return s[R.ETA0 + l] * s[R.FREQUENCY + l] * s[R.W + l]


def step_lengths(s, l, c):
    """Return the longest accurate step, by coefficients c, and the longest stable."""
    last, previous = (norm([row[k] for row in c], momentum_of(s, l)) for k in (ORDER, ORDER - 1))
    return step_length(last, previous, s[R.TOLERANCE + l]), STABLE / s[R.RATE + l]


def store_step(s, l, start, h, h_powers, c, lengths, other_sum):
    """Store the outcome of a Taylor step; decide whether Rodas5P goes next.

    start : a `Point`; h : length of the step; h_powers : `powers` of h
    lengths : returned by `step_lengths`
    other_sum : sum of all other results of the step, to test that they are finite
    """
    accurate, stable = lengths
    dense = tuple(product(row, h_powers) for row in c)
    store_each(s, rows_of(start.law).c, l, dense)
    end = start.at(tuple(map(pairwise_sum, dense)))
    L.write_point(s, l, end, True)
    s[R.H_USED + l] = h
    ok = abs(total(end.y) + other_sum) < 1e300
    fails = ok ^ True
    rate = fastest_rate(end, s[R.FREQUENCY + l])
    stable = where(ok, STABLE / rate, stable)
    # (if the step is repeated to end at a crossing, this rate is near enough for the shorter step)
    s[R.RATE + l] = rate
    limited = where(accurate > stable, s[R.LIMITED + l] + 1.0, 0.0)
    stiff = (accurate > RODAS5P_ABOVE * stable) | (limited > MAX_LIMITED) | fails
    s[R.LIMITED + l] = where(stiff, 0.0, limited)
    s[R.OK + l], s[R.CHANGES + l] = where(ok, 1.0, 0.0), where(stiff, 1.0, 0.0)
    # (used by the first step of Rodas5P, if Rodas5P goes next)
    s[R.H_NEXT + l], s[R.MEMORY_NEW + l] = stable, 1.0


def try_step(s, l, law):
    start = L.read_point(s, l, law)
    c, rates_of_work = coefficients(start, s[R.W_LP + l], s[R.RAMP + l])
    lengths = step_lengths(s, l, c)
    h = where(lengths[0] < lengths[1], lengths[0], lengths[1])
    h = L.step_size(h, s[R.BREAKPOINT + l], s[R.T + l], s[R.T_LOW + l])
    h_powers = powers(h)
    load, friction = integrals(rates_of_work, h_powers)
    s[R.D_LOAD + l], s[R.D_FRICTION + l] = h * load, h * friction
    store_step(s, l, start, h, h_powers, c, lengths, load + friction)


def choose_method(s, l, law):
    """Set CHANGES if the step after one of Rodas5P is short enough for Taylor."""
    rate = fastest_rate(L.read_point(s, l, law, True), s[R.FREQUENCY + l])
    s[R.RATE + l] = rate
    short = (s[R.H_NEXT + l] * rate < TAYLOR_BELOW) & (rate < FASTEST) & (rate > 1.0 / FASTEST)
    s[R.CHANGES + l] = where(short & (s[R.OK + l] > 0.0), 1.0, 0.0)
