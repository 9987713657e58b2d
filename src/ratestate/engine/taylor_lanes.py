"""Taylor steps of lanes, and the choice of the method for the next step.

The Taylor method needs a law with recurrences.  It is the faster method if the motion is not stiff:
if accuracy limits a step more than the fastest rate of the equations does.  Each slider takes the
steps that suit it.
"""

from ..friction.functions import larger, where
from ..friction.tuples import largest, pairwise_sum, product, total
from . import lanes as L
from . import rows as R
from .rows import rows_of, store_each
from .taylor import ORDER, coefficients, integrals, norm, powers, step_length

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


def fastest_rate(at, frequency):
    """Return the fastest rate: relaxation of v or of a state, or free vibration."""
    _, of_psi = at.f_slopes
    return larger(larger(abs(at.S_slopes[0]) / (at.eta0 * at.w), frequency), largest(of_psi))


def momentum_of(s, l):
    """Return the momentum of the lane's slider, as `taylor.norm` needs it."""
    return s[R.ETA0 + l] * s[R.FREQUENCY + l] * s[R.W + l]


def step_lengths(s, l, c):
    """Return the longest accurate step, by coefficients c, and the longest stable."""
    last, previous = (norm([one[k] for one in c], momentum_of(s, l)) for k in (ORDER, ORDER - 1))
    return step_length(last, previous, s[R.TOLERANCE + l]), STABLE / s[R.RATE + l]


def store_step(s, l, start, h, h_powers, c, lengths, other_sum):
    """Store the outcome of a Taylor step; decide whether Rodas5P goes next.

    start : a `Point`; h : length of the step; h_powers : `powers` of h
    lengths : returned by `step_lengths`
    other_sum : sum of all other results of the step, to test that they are finite
    """
    accurate, stable = lengths
    dense = tuple(product(one, h_powers) for one in c)
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
    """Take one step of the lane by the Taylor method."""
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
