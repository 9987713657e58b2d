"""Lanes under a law with recurrences: steps of the Taylor method, and which method goes next.

The Taylor method is the faster one where the motion is not stiff: where the fastest rate of the
equations is no faster than what a step, to be accurate, has to follow.  Each slider takes the steps
that suit it.
"""

from ..friction.functions import larger, where
from ..friction.tuples import largest, pairwise_sum, product, total
from . import lanes as L
from . import rows as R
from .rows import rows_of, store_each
from .taylor import ORDER, coefficients, integrals, longest, powers, size

# Steps of either method are measured by the fastest rate of the equations.
#: The longest step of the Taylor method: of order 12 it is stable up to 5.8 where that rate is one
#: of decay.
STABLE = 4.0
#: Rodas5P takes over where accuracy alone would allow a step so many times longer than that.
STIFF = 3.0
#: It also does where accuracy has allowed a longer one so many times in a row.
PATIENCE = 8.0
#: The Taylor method takes over where the next step of Rodas5P is shorter than this.
CALM = 2.0
#: Powers of rates beyond this, or below its inverse, would be no numbers: at rest, say.
FASTEST = 1e20


def fastest_rate(at, frequency):
    """The fastest of these: how v relaxes, how each state does, how the slider vibrates."""
    _, of_psi = at.f_slopes
    return larger(larger(abs(at.S_slopes[0]) / (at.eta0 * at.w), frequency), largest(of_psi))


def momentum_of(s, l):
    """The momentum of the lane's slider, as of `taylor.size`."""
    return s[R.ETA0 + l] * s[R.FREQUENCY + l] * s[R.W + l]


def step_lengths(s, l, c):
    """How long a step may be to be accurate, by its last two `coefficients`, and to be stable."""
    last, before = (size([one[k] for one in c], momentum_of(s, l)) for k in (ORDER, ORDER - 1))
    return longest(last, before, s[R.TOLERANCE + l]), STABLE / s[R.RATE + l]


def record(s, l, start, h, h_powers, c, lengths, also):
    """Put the outcome of a step into its rows, and see whether the next is Rodas5P's.

    start : a `Point`; h : the step's length; h_powers : `powers` of that
    lengths : what `step_lengths` gave
    also : the sum of what else the step has found: not finite where any of that is not
    """
    accurate, stable = lengths
    dense = tuple(product(one, h_powers) for one in c)
    store_each(s, rows_of(start.law).c, l, dense)
    end = start.at(tuple(map(pairwise_sum, dense)))
    L.write_point(s, l, end, True)
    s[R.H_USED + l] = h
    ok = abs(total(end.y) + also) < 1e300
    fails = ok ^ True
    rate = fastest_rate(end, s[R.FREQUENCY + l])
    stable = where(ok, STABLE / rate, stable)
    # (if the step is taken back, to end at a crossing, a rate nearby will do for the shorter one)
    s[R.RATE + l] = rate
    limited = where(accurate > stable, s[R.LIMITED + l] + 1.0, 0.0)
    stiff = (accurate > STIFF * stable) | (limited > PATIENCE) | fails
    s[R.LIMITED + l] = where(stiff, 0.0, limited)
    s[R.OK + l], s[R.CHANGES + l] = where(ok, 1.0, 0.0), where(stiff, 1.0, 0.0)
    # (of the first step of Rodas5P, if that comes next)
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
    record(s, l, start, h, h_powers, c, lengths, load + friction)


def find_calm(s, l, law):
    """Set CHANGES: whether, after a step of Rodas5P, the next one is not too long for Taylor's."""
    rate = fastest_rate(L.read_point(s, l, law, True), s[R.FREQUENCY + l])
    s[R.RATE + l] = rate
    calm = (s[R.H_NEXT + l] * rate < CALM) & (rate < FASTEST) & (rate > 1.0 / FASTEST)
    s[R.CHANGES + l] = where(calm & (s[R.OK + l] > 0.0), 1.0, 0.0)
