"""What period a run has: stress maxima and minima of its last cycles, compared.

A cycle ends where V rises through V_lp, at a maximum of the stress.
"""

import math

from . import rows as R

# Smallest visible change of stress maxima or minima from one return to the next, divided by the
# amplitude; part of it that may be left after a whole period.
VISIBLE, REPEATS = 1e-3, 0.1
# Largest change after a period of several returns, divided by the amplitude: chaos comes near one
# by chance.  Errors of a run may be so many times its tolerance, and hide it up to `VISIBLE`.
EXACT, ERRORS = 1e-4, 100.0
# How often stress maxima turn back, among those that are known, where a motion is irregular; and
# what part of their earlier changes the later ones then are, for it may be on its way to a period.
# Where changes after a period grow it is irregular too: it leaves an orbit that it came near to.
REVERSALS, LASTING = 3, 0.5


def close_cycle(run, l, here, x_high):
    """Record the cycle that ends at this upward crossing; `here` is the time since s[T]."""
    s, shape = run.s, run.shape
    if s[R.CROSS_LOW + l] < math.inf:
        at = (int(s[R.CYCLES + l]) % R.RING) * R.LANES + int(s[R.HOME + l])
        s[shape.highs + at], s[shape.lows + at] = x_high, s[R.X_LOW + l]
        s[shape.spans + at] = (s[R.T + l] - s[R.CROSS_T + l]) + (here - s[R.CROSS_LOW + l])
        s[R.CYCLES + l] += 1.0
    s[R.CROSS_T + l], s[R.CROSS_LOW + l] = s[R.T + l], here


def change(s, home, shape, first, end, p):
    """Largest change of a maximum or minimum of x after p returns, at the returns first to end - 1.

    home : the column where they are kept
    """
    most = 0.0
    for k in range(first, end):
        now, before = (k % R.RING) * R.LANES + home, ((k - p) % R.RING) * R.LANES + home
        most = max(most, abs(s[shape.highs + now] - s[shape.highs + before]))
        most = max(most, abs(s[shape.lows + now] - s[shape.lows + before]))
    return most


def last_period(run, l):
    """Amplitude (in x) and duration (in T) of the last period, and how many returns it has.

    More than one where the motion repeats after these, and hardly after fewer.  Where it is
    irregular there is no period: 0 returns, the amplitude of the later half of those that are
    known, and how long one of them takes.  Before the first return 0.0, inf and 0.
    """
    s, shape = run.s, run.shape
    cycles, home = int(s[R.CYCLES + l]), int(s[R.HOME + l])
    if cycles == 0:
        return 0.0, math.inf, 0
    known = min(cycles, R.RING)
    last = ((cycles - 1) % R.RING) * R.LANES + home
    amplitude = s[shape.highs + last] - s[shape.lows + last]
    visible = VISIBLE * amplitude
    errors = ERRORS * s[R.TOLERANCE + l]
    exact = max(EXACT * amplitude, min(visible, errors))
    first = cycles - known // 2  # in chaos a few returns may repeat by chance
    returns, left = 1, change(s, home, shape, first, cycles, 1)
    for p in range(2, known // 2 + 1):
        if left > (visible if returns == 1 else exact):
            by_p = change(s, home, shape, first, cycles, p)
            if by_p < REPEATS * left:
                returns, left = p, by_p
    changes = left > (visible if returns == 1 else exact)
    half = first + known // 4
    before = max(errors, change(s, home, shape, first, half, returns))
    grows = (changes or returns > 1) and change(s, home, shape, half, cycles, returns) > before
    irregular = (changes or grows) and is_irregular(s, home, shape, cycles, visible, grows)
    over = known // 2 if irregular else returns
    high, low, span = -math.inf, math.inf, 0.0
    for k in range(cycles - over, cycles):
        at = (k % R.RING) * R.LANES + home
        high, low = max(high, s[shape.highs + at]), min(low, s[shape.lows + at])
        span += s[shape.spans + at]
    return high - low, span / over if irregular else span, 0 if irregular else returns


def is_irregular(s, home, shape, cycles, visible, grows):
    """Whether stress maxima go up and down visibly, and lately not much less than before.

    grows : whether changes after a period grow; then changes after a return need not last
    """
    count, rise_before, earlier, later = 0, 0.0, 0.0, 0.0
    known = min(cycles, R.RING)
    for k in range(cycles - known + 1, cycles):
        now, last = (k % R.RING) * R.LANES + home, ((k - 1) % R.RING) * R.LANES + home
        rise = s[shape.highs + now] - s[shape.highs + last]
        if abs(rise) > visible:
            count += rise * rise_before < 0.0
            rise_before = rise
        if k < cycles - known // 2:
            earlier = max(earlier, abs(rise))
        else:
            later = max(later, abs(rise))
    return count >= REVERSALS and (grows or later > LASTING * earlier)
