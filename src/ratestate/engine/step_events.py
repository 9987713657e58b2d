"""Events inside an accepted step, from its dense output; the period of a run.

The spring stress has its extremes at V = V_lp, because dx/dT = kappa (w_lp - w).  An upward
crossing is a stress maximum and closes a cycle.  A downward crossing is a stress minimum.

The period of a run follows from the stress maxima and minima of its last cycles.
"""

import math

from . import rows as R
from .rows import OUTPUT, call_point

#: allowed error of extreme forces, as a multiple of the tolerance of a step
FORCE_TOLERANCE = 0.01
# Weights of x, the stress S that opposes motion, the strength N and friction R in `units.force`.
INERTIAL_FORCE = (1.0, -1.0, 0.0, 0.0)
FRICTION, X_PLUS_N = (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 1.0, 0.0)
NO_INPUTS = (0.0, 0.0, 0.0, 0.0)  # inputs of `units.speed`
#: `root` looks for the zero, whatever the value there
ANY_VALUE = (math.inf, -math.inf)
#: height of an extreme above the ends of a Taylor step that is assumed not to be exceeded, as a
#: multiple of the height at which the tangents of both ends meet; it is 1/2 for a parabola
HIGHEST = 4.0

# Smallest visible change of stress maxima or minima from one return to the next, divided by the
# amplitude; fraction of that change that may remain after a whole period.
VISIBLE, REPEATS = 1e-3, 0.1
# Largest change after a period of several returns, divided by the amplitude, since chaos may nearly
# repeat.  Errors of a run, as a multiple of its tolerance, may raise this limit up to `VISIBLE`.
EXACT, ERRORS = 1e-4, 100.0
# A motion is irregular if the recorded stress maxima reverse their trend this often, and if their
# later changes are more than this fraction of the earlier ones: else it may settle to a period.
# The second condition is dropped if changes after a period grow: it is then leaving an orbit.
REVERSALS, LASTING = 3, 0.5


def evaluate(run, l, unit, inputs, fraction):
    """Return a quantity at a fraction of the step, and the number that `root` zeroes.

    unit : `force`, `speed` or `lead` of `run.units`; inputs : four numbers, as units.py says
    """
    work = run.work
    work[0] = fraction
    work[1], work[2], work[3], work[4] = inputs
    call_point(unit, run.s, l, work)
    return work[OUTPUT], work[OUTPUT + 1]


def farthest_value(value_at_low, slope_at_low, value, slope):
    """Return a bound of the extreme of a smooth step from values and slopes at its ends.

    NaN, which lies between no values, if the slope is not monotonic.
    """
    meeting = slope_at_low * (value - value_at_low - slope) / (slope_at_low - slope)
    is_maximum = slope_at_low > 0.0
    end = max(value_at_low, value) if is_maximum else min(value_at_low, value)
    height = value_at_low + meeting - end
    if (height > 0.0) == is_maximum:
        return end + HIGHEST * height
    return math.nan


def smaller_weight(residual, previous):
    """Return the factor for the residual at the other end if two in a row have the same sign."""
    weight = 1.0 - residual / previous
    return weight if weight > 0.0 else 0.5


def root(run, l, unit, inputs, low, high, tolerance, known):
    """Find the zero of `evaluate`'s second number; return it and the first number.

    The method is regula falsi (Anderson & Bjorck 1973 doi:10.1007/BF01951936).  If the sign is the
    same at both ends, the result is the end at which the second number is smaller in size.

    tolerance : error that the first number may have if the second is its slope; else 0
    known : least and greatest value so far, if an extreme between them is not needed.  It is
        searched for after a step of Rodas5P, which may be longer than an oscillation of the forces.
    """
    value_at_low, at_low = evaluate(run, l, unit, inputs, low)
    value, at_high = evaluate(run, l, unit, inputs, high)
    if (at_low < 0.0) == (at_high < 0.0):
        return (low, value_at_low) if abs(at_low) < abs(at_high) else (high, value)
    if known[0] < known[1] and run.s[R.TAYLOR + l] > 0.0:
        farthest = farthest_value(value_at_low, at_low, value, at_high)
        if known[0] <= farthest and farthest <= known[1]:
            return low, value_at_low
    side, at, last = 0, high, 2.0
    for _ in range(100):
        at = (low * at_high - high * at_low) / (at_high - at_low)
        value, residual = evaluate(run, l, unit, inputs, at)
        if residual == 0.0 or abs(at - last) < 1e-14 or abs(residual * (at - last)) < tolerance:
            break
        last = at
        if (residual < 0.0) == (at_low < 0.0):
            at_high = at_high * smaller_weight(residual, at_low) if side == 1 else at_high
            low, at_low, side = at, residual, 1
        else:
            at_low = at_low * smaller_weight(residual, at_high) if side == -1 else at_low
            high, at_high, side = at, residual, -1
    return at, value


def extreme_value(run, l, weights, tolerance, known):
    """Return the extreme value of a weighted sum of forces inside the step.

    If the extreme lies between the two known values, the result is any value between them.
    """
    _, value = root(run, l, run.units.force, weights, 0.0, 1.0, tolerance, known)
    return value


def extreme_speed(run, l, known):
    """Return the fraction of the step at which the speed is extreme, and the speed.

    If the extreme lies between the two known values, the result is the start of the step.
    """
    return root(run, l, run.units.speed, NO_INPUTS, 0.0, 1.0, 0.0, known)


def crossing(run, l, speeds, low, high):
    """Return where V, which crosses V_lp between two fractions, equals V_lp.

    speeds : w_lp at the start of the step, and its change in the step
    """
    inputs = speeds[0], speeds[1], 0.0, 0.0
    fraction, _ = root(run, l, run.units.lead, inputs, low, high, 0.0, ANY_VALUE)
    return fraction


def known_speeds(run, l):
    """Return least and greatest speed between which an extreme in the step is not needed.

    Extremes so far are not exceeded.  A minimum above V_lp, or a maximum below, is always needed,
    because there V may cross V_lp twice.  (The speed is ln w: Taylor steps need slip that does not
    reverse.)
    """
    s = run.s
    low, high = s[R.V_LOW + l], s[R.V_HIGH + l]
    start, end, w_lp = s[R.V + l], s[R.V_NEW + l], s[R.W_LP + l]
    is_above = s[R.W + l] >= w_lp
    if is_above == (s[R.W_NEW + l] >= w_lp + s[R.H_USED + l] * s[R.RAMP + l]):
        if is_above:
            low = max(start, end)
        else:
            high = min(start, end)
    return low, high


def record_extremes(run, l):
    """Record extremes of V, |g|, f and x + N inside the step; `commit` adds its end.

    Returns the fraction of the step at which V is extreme, or -1 if V has no extreme inside.
    """
    s = run.s
    tolerance, events, at = FORCE_TOLERANCE * s[R.TOLERANCE + l], int(s[R.EVENTS + l]), -1.0
    if events & R.V_EXTREME > 0:
        at, v = extreme_speed(run, l, known_speeds(run, l))
        s[R.V_HIGH + l] = max(s[R.V_HIGH + l], v)
        s[R.V_LOW + l] = min(s[R.V_LOW + l], v)
    if events & R.G_EXTREME > 0:
        g_high = s[R.G_HIGH + l]
        force = extreme_value(run, l, INERTIAL_FORCE, tolerance, (-g_high, g_high))
        s[R.G_HIGH + l] = max(g_high, abs(force))
    if events & R.F_EXTREME > 0:
        known = s[R.F_LOW + l], math.inf
        s[R.F_LOW + l] = min(known[0], extreme_value(run, l, FRICTION, tolerance, known))
    if events & R.XF_EXTREME > 0:
        known = s[R.XF_LOW + l], math.inf
        s[R.XF_LOW + l] = min(known[0], extreme_value(run, l, X_PLUS_N, tolerance, known))
    return at


def record_crossing(run, l, speeds, rises, low, high):
    """Record a crossing between two fractions: a stress maximum if V rises."""
    s = run.s
    at = crossing(run, l, speeds, low, high)
    run.work[0] = at
    call_point(run.units.state, s, l, run.work)
    x = run.work[OUTPUT]
    if rises:
        close_cycle(run, l, s[R.T_LOW + l] + at * s[R.H_USED + l], x)
    else:
        s[R.X_LOW + l] = x


def handle(run, l):
    """Handle all events of the lane's accepted step, before the step is committed."""
    s = run.s
    speeds = s[R.W_LP + l], s[R.H_USED + l] * s[R.RAMP + l]
    events, at = int(s[R.EVENTS + l]), -1.0  # where V is extreme
    if s[R.OBSERVE + l] > 0.0:
        at = record_extremes(run, l)
    elif events & R.GRAZES > 0:
        at, _ = extreme_speed(run, l, ANY_VALUE)
    if run.shape.rigid:
        return
    above = s[R.W_NEW + l] >= speeds[0] + speeds[1]
    if (s[R.W + l] < speeds[0]) == above:
        record_crossing(run, l, speeds, above, 0.0, 1.0)
    elif at > 0.0:
        inputs = speeds[0], speeds[1], 0.0, 0.0
        _, lead = evaluate(run, l, run.units.lead, inputs, at)
        if (lead < 0.0) == above:  # V crosses V_lp twice in this step
            record_crossing(run, l, speeds, not above, 0.0, at)
            record_crossing(run, l, speeds, above, at, 1.0)
    if events & R.OVER_V_LIMIT > 0:
        call_point(run.units.check_runaway, s, l, run.work)


# The period of a run


def close_cycle(run, l, t_low, x_high):
    """Record the cycle that ends at an upward crossing, at the time s[T] + t_low."""
    s, shape = run.s, run.shape
    if s[R.CROSS_T_LOW + l] < math.inf:
        at = (int(s[R.CYCLES + l]) % R.RING) * R.LANES + int(s[R.RING_COLUMN + l])
        s[shape.highs + at], s[shape.lows + at] = x_high, s[R.X_LOW + l]
        s[shape.durations + at] = (s[R.T + l] - s[R.CROSS_T + l]) + (t_low - s[R.CROSS_T_LOW + l])
        s[R.CYCLES + l] += 1.0
    s[R.CROSS_T + l], s[R.CROSS_T_LOW + l] = s[R.T + l], t_low


def max_change(s, home, shape, first, end, p):
    """Return the largest change of stress maxima and minima after p returns.

    The returns first to end - 1 are compared; home : the column that keeps them
    """
    largest = 0.0
    for k in range(first, end):
        current, other = (k % R.RING) * R.LANES + home, ((k - p) % R.RING) * R.LANES + home
        largest = max(largest, abs(s[shape.highs + current] - s[shape.highs + other]))
        largest = max(largest, abs(s[shape.lows + current] - s[shape.lows + other]))
    return largest


def last_period(run, l):
    """Return the last period's amplitude (in x), duration (in T) and returns.

    There are several returns if the motion repeats after these and hardly after fewer.  If the
    motion is irregular, there are 0 returns, the amplitude is over the later half of the recorded
    returns, and the duration is their mean.  Before the first return the result is 0.0, inf and 0.
    """
    s, shape = run.s, run.shape
    cycles, home = int(s[R.CYCLES + l]), int(s[R.RING_COLUMN + l])
    if cycles == 0:
        return 0.0, math.inf, 0
    recorded = min(cycles, R.RING)
    last = ((cycles - 1) % R.RING) * R.LANES + home
    amplitude = s[shape.highs + last] - s[shape.lows + last]
    visible = VISIBLE * amplitude
    errors = ERRORS * s[R.TOLERANCE + l]
    exact = max(EXACT * amplitude, min(visible, errors))
    first = cycles - recorded // 2  # in chaos a few returns may repeat by chance
    returns, remaining = 1, max_change(s, home, shape, first, cycles, 1)
    for p in range(2, recorded // 2 + 1):
        if remaining > (visible if returns == 1 else exact):
            by_p = max_change(s, home, shape, first, cycles, p)
            if by_p < REPEATS * remaining:
                returns, remaining = p, by_p
    changes = remaining > (visible if returns == 1 else exact)
    half = first + recorded // 4
    earlier = max(errors, max_change(s, home, shape, first, half, returns))
    grows = (changes or returns > 1) and max_change(s, home, shape, half, cycles, returns) > earlier
    irregular = (changes or grows) and is_irregular(s, home, shape, cycles, visible, grows)
    n_cycles = recorded // 2 if irregular else returns
    high, low, span = -math.inf, math.inf, 0.0
    for k in range(cycles - n_cycles, cycles):
        at = (k % R.RING) * R.LANES + home
        high, low = max(high, s[shape.highs + at]), min(low, s[shape.lows + at])
        span += s[shape.durations + at]
    return high - low, span / n_cycles if irregular else span, 0 if irregular else returns


def is_irregular(s, home, shape, cycles, visible, grows):
    """Return whether stress maxima go up and down, lately not much less than before.

    grows : whether changes after a period grow; changes after a return then need not last
    """
    count, previous_rise, earlier, later = 0, 0.0, 0.0, 0.0
    recorded = min(cycles, R.RING)
    for k in range(cycles - recorded + 1, cycles):
        current, previous = (k % R.RING) * R.LANES + home, ((k - 1) % R.RING) * R.LANES + home
        rise = s[shape.highs + current] - s[shape.highs + previous]
        if abs(rise) > visible:
            count += rise * previous_rise < 0.0
            previous_rise = rise
        if k < cycles - recorded // 2:
            earlier = max(earlier, abs(rise))
        else:
            later = max(later, abs(rise))
    return count >= REVERSALS and (grows or later > LASTING * earlier)
