"""What happens inside an accepted step, read off its dense output, and what period it makes.

Where V = V_lp the spring stress is extreme, because dx/dT = kappa (w_lp - w).  An upward
crossing is a stress maximum and closes a cycle; a downward one is its minimum.

The dense output of a step is a polynomial for each number, in the fraction of the step that is
over, 0 to 1.  Its coefficients, the constant first, stand in rows of the lane buffer: of degree 4
after a step of Rodas5P, of `taylor.ORDER` after one of the Taylor method.

The period of a run is seen where stress maxima and minima of its last cycles are compared.
"""

import math

from ..friction.functions import log
from . import rows as R
from .rows import FOUND, call_point

#: by how much extreme forces may be off, over the tolerance of a step
ENOUGH = 0.01
#: what `of_step` finds
FORCE, SPEED, LEAD = 0, 1, 2
# Parts of x, the stress S that opposes motion, the strength N and friction R: `units.force`.
NONE, INERTIAL_FORCE, FRICTION = (0.0, 0.0, 0.0, 0.0), (1.0, -1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
WITH_STRENGTH = (1.0, 0.0, 1.0, 0.0)
NO_LOAD = (0.0, 0.0)
#: a speed of the load point that stands for rest
LEAST = 1e-300

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


def component(run, l, i, at):
    """Number i of (x, v, psi...) at a place in the lane's step, and its derivative by the place.

    After a step of the Taylor method those of the perturbations z follow in a return map.
    """
    s, shape = run.s, run.shape
    row = shape.c + i * shape.terms * R.LANES + l
    last = (shape.terms if s[R.TAYLOR + l] > 0.0 else R.OF_RODAS5P) - 1
    y, dy = s[row + last * R.LANES], 0.0
    for k in range(1, last + 1):
        dy = y + at * dy
        y = s[row + (last - k) * R.LANES] + at * y
    return y, dy


def state_at(run, l, at, work, place):
    """Put x, v and each psi at a place in the lane's step into `work`, and their derivatives."""
    n = 2 + run.shape.states
    for i in range(n):
        work[place + i], work[place + n + i] = component(run, l, i, at)


def of_step(run, l, what, parts, load, at):
    """A number at a place in the lane's step, and what is to vanish where `root` finds it.

    =====  ==========================================================================
    FORCE  a sum of parts of x, S, N and R, and its slope
    SPEED  the speed, as of `Point.speed_measure`, and its slope
    LEAD   the same, and how far v is ahead of the load point's, of which `load` holds
           the speed at the start of the step and its change in the step
    =====  ==========================================================================
    """
    work = run.work
    if what == FORCE:
        work[0] = at
        work[1], work[2], work[3], work[4] = parts
        state_at(run, l, at, work, 5)
        call_point(run.units.force, run.s, l, work)
        return work[FOUND], work[FOUND + 1]
    w_lp = load[0] + load[1] * at
    if run.shape.reverses == 0:
        v, slope = component(run, l, 1, at)
        return v, slope if what == SPEED else v - log(max(w_lp, LEAST))
    work[0] = w_lp
    state_at(run, l, at, work, 1)
    call_point(run.units.speed, run.s, l, work)
    return work[FOUND], work[FOUND + 1] if what == SPEED else work[FOUND + 2]


def root(run, l, what, parts, load, low, high, enough):
    """Find where from low to high the second number of `of_step` is 0, and the first number there.

    By regula falsi (Illinois).  Where it has one sign at both ends, the end where it is smaller in
    size.

    enough : the error that the first may have, of which the second is the slope; 0 if it is not
    """
    first, at_low = of_step(run, l, what, parts, load, low)
    here, at_high = of_step(run, l, what, parts, load, high)
    if (at_low < 0.0) == (at_high < 0.0):
        return (low, first) if abs(at_low) < abs(at_high) else (high, here)
    side, at, last = 0, high, 2.0
    for _ in range(100):
        at = (low * at_high - high * at_low) / (at_high - at_low)
        here, off = of_step(run, l, what, parts, load, at)
        if off == 0.0 or abs(at - last) < 1e-14 or abs(off * (at - last)) < enough:
            break
        last = at
        if (off < 0.0) == (at_low < 0.0):
            low, at_low = at, off
            at_high = 0.5 * at_high if side == 1 else at_high
            side = 1
        else:
            high, at_high = at, off
            at_low = 0.5 * at_low if side == -1 else at_low
            side = -1
    return at, here


def extreme_value(run, l, parts, enough):
    """The value of a sum of parts where in the lane's step its slope vanishes, as of `root`."""
    _, value = root(run, l, FORCE, parts, NO_LOAD, 0.0, 1.0, enough)
    return value


def extreme_speed(run, l):
    """Where in the lane's step the speed is extreme, and its `speed_measure`."""
    return root(run, l, SPEED, NONE, NO_LOAD, 0.0, 1.0, 0.0)


def crossing(run, l, load, low, high):
    """Where from low to high the speed is the load point's, which the caller has seen it cross."""
    at, _ = root(run, l, LEAD, NONE, load, low, high, 0.0)
    return at


def observe(run, l):
    """Extremes of V, |g|, f and x + N inside the step; `commit` sees to its end.

    Returns where in the step, 0 to 1, V has one, or -1.
    """
    s = run.s
    enough, events, at = ENOUGH * s[R.TOLERANCE + l], int(s[R.EVENTS + l]), -1.0
    if events & R.V_EXTREME > 0:
        at, v = extreme_speed(run, l)
        s[R.V_HIGH + l] = max(s[R.V_HIGH + l], v)
        s[R.V_LOW + l] = min(s[R.V_LOW + l], v)
    if events & R.G_EXTREME > 0:
        force = extreme_value(run, l, INERTIAL_FORCE, enough)
        s[R.G_HIGH + l] = max(s[R.G_HIGH + l], abs(force))
    if events & R.F_EXTREME > 0:
        s[R.F_LOW + l] = min(s[R.F_LOW + l], extreme_value(run, l, FRICTION, enough))
    if events & R.XF_EXTREME > 0:
        s[R.XF_LOW + l] = min(s[R.XF_LOW + l], extreme_value(run, l, WITH_STRENGTH, enough))
    return at


def cross(run, l, load, rises, low, high):
    """Record that V crosses V_lp from low to high in the step: a maximum of stress if it rises."""
    s = run.s
    at = crossing(run, l, load, low, high)
    x, _ = component(run, l, 0, at)
    if rises:
        close_cycle(run, l, s[R.T_LOW + l] + at * s[R.H_USED + l], x)
    else:
        s[R.X_LOW + l] = x


def handle(run, l):
    """Everything of interest in the lane's accepted step, before it is committed."""
    s = run.s
    load = s[R.W_LP + l], s[R.H_USED + l] * s[R.RAMP + l]
    events, at = int(s[R.EVENTS + l]), -1.0  # where V is extreme
    if s[R.OBSERVE + l] > 0.0:
        at = observe(run, l)
    elif events & R.GRAZES > 0:
        at, _ = extreme_speed(run, l)
    if run.shape.rigid:
        return
    above = s[R.W_NEW + l] >= load[0] + load[1]
    if (s[R.W + l] < load[0]) == above:
        cross(run, l, load, above, 0.0, 1.0)
    elif at > 0.0:
        _, lead = of_step(run, l, LEAD, NONE, load, at)
        if (lead < 0.0) == above:  # there and back
            cross(run, l, load, not above, 0.0, at)
            cross(run, l, load, above, at, 1.0)
    if events & R.BEYOND > 0:
        call_point(run.units.outrun, s, l, run.work)


# The period of a run


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
