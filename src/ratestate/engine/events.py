"""What happens inside an accepted step, read off its dense output.

Where V = V_lp the spring stress is extreme, because dx/dT = kappa (w_lp - w).  An upward
crossing is a stress maximum and closes a cycle; a downward one is its minimum.
"""

import math

from ..friction.laws import AGING
from . import rows as R
from .exp import LIMIT
from .jit import inner
from .lanes import extrema
from .model import NOT_FINITE, RUNAWAY, runs_away

# Change of stress maxima or minima from one return to the next, over the amplitude, that is seen;
# part of it that may be left after a whole period.
VISIBLE, REPEATS = 1e-3, 0.1
# How often stress maxima turn back, among those that are known, where a motion is irregular; and
# what part of their earlier changes the later ones then are, for it may be on its way to a period.
REVERSALS, LASTING = 3, 0.5


@inner
def coefficients(y0, y1, k1, k2, k3):
    """Dense output of one component as a polynomial in s, the fraction of the step."""
    return y0, (y1 - y0) + k1, k2 - k1, k3 - k2, -k3


@inner
def polynomial(c, s):
    return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4])))


@inner
def derivative(c, s):
    return c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * 4.0 * c[4]))


@inner
def combined(a, factor, b):
    """The polynomial a + factor b."""
    return (
        a[0] + factor * b[0],
        a[1] + factor * b[1],
        a[2] + factor * b[2],
        a[3] + factor * b[3],
        a[4] + factor * b[4],
    )


@inner
def extreme(c):
    """Where in 0..1 the polynomial's derivative vanishes (Newton inside a bracket)."""
    low, high = 0.0, 1.0
    d_low, d_high = derivative(c, low), derivative(c, high)
    if (d_low < 0.0) == (d_high < 0.0):
        return 0.0 if abs(d_low) < abs(d_high) else 1.0
    s = d_low / (d_low - d_high)
    for _ in range(60):
        d = derivative(c, s)
        if (d < 0.0) == (d_low < 0.0):
            low = s
        else:
            high = s
        curvature = 2.0 * c[2] + s * (6.0 * c[3] + s * 12.0 * c[4])
        step = d / curvature if curvature != 0.0 else 2.0
        new = s - step
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) < 1e-14:
            return new
        s = new
    return s


@inner
def crossing(c, w_lp, dw, log_w_lp):
    """Where in 0..1 v = ln(w_lp + dw s); the caller has seen a crossing."""
    low, high = 0.0, 1.0
    start = c[0] - (log_w_lp if dw == 0.0 else math.log(w_lp))
    s = 0.5
    for _ in range(60):
        load = w_lp + dw * s
        value = polynomial(c, s) - (log_w_lp if dw == 0.0 else math.log(load))
        if (value < 0.0) == (start < 0.0):
            low = s
        else:
            high = s
        slope = derivative(c, s) - dw / load
        new = s - value / slope if slope != 0.0 else 2.0
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) < 1e-14:
            return new
        s = new
    return s


@inner
def components(s, l):
    """Polynomials of x, v and psi over the lane's step."""
    return (
        coefficients(s[R.X + l], s[R.X_NEW + l], s[R.X_1 + l], s[R.X_2 + l], s[R.X_3 + l]),
        coefficients(s[R.V + l], s[R.V_NEW + l], s[R.V_1 + l], s[R.V_2 + l], s[R.V_3 + l]),
        coefficients(
            s[R.PSI + l], s[R.PSI_NEW + l], s[R.PSI_1 + l], s[R.PSI_2 + l], s[R.PSI_3 + l]
        ),
    )


@inner
def close_cycle(s, l, here, x_high):
    """Book the cycle that ends at this upward crossing; `here` is the time since s[T]."""
    if s[R.CROSS_LOW + l] < math.inf:
        at = (int(s[R.CYCLES + l]) % R.RING) * R.LANES + l
        s[R.HIGHS + at], s[R.LOWS + at] = x_high, s[R.X_LOW + l]
        s[R.SPANS + at] = (s[R.T + l] - s[R.CROSS_T + l]) + (here - s[R.CROSS_LOW + l])
        s[R.CYCLES + l] += 1.0
    s[R.CROSS_T + l], s[R.CROSS_LOW + l] = s[R.T + l], here


@inner
def change(s, l, cycles, p):
    """The largest change of a stress maximum or minimum, from the p returns before to the last."""
    most = 0.0
    for k in range(cycles - p, cycles):
        now, before = (k % R.RING) * R.LANES + l, ((k - p) % R.RING) * R.LANES + l
        most = max(most, abs(s[R.HIGHS + now] - s[R.HIGHS + before]))
        most = max(most, abs(s[R.LOWS + now] - s[R.LOWS + before]))
    return most


@inner
def last_period(s, l):
    """Amplitude and duration of the last period, and how many returns it has.

    More than one where the motion repeats after these, and hardly after fewer.  Where it is
    irregular there is no period: 0 returns, the amplitude of the later half of those that are
    known, and how long one of them takes.
    """
    cycles = int(s[R.CYCLES + l])
    if cycles == 0:
        return 0.0, math.inf, 0
    known = min(cycles, R.RING)
    last = ((cycles - 1) % R.RING) * R.LANES + l
    visible = VISIBLE * (s[R.HIGHS + last] - s[R.LOWS + last])
    returns, left = 1, change(s, l, cycles, 1) if cycles > 1 else 0.0
    for p in range(2, known // 2 + 1):
        if left > visible:
            by_p = change(s, l, cycles, p)
            if by_p < REPEATS * left:
                returns, left = p, by_p
    irregular = left > visible and is_irregular(s, l, cycles, visible)
    over = known // 2 if irregular else returns
    high, low, span = -math.inf, math.inf, 0.0
    for k in range(cycles - over, cycles):
        at = (k % R.RING) * R.LANES + l
        high, low = max(high, s[R.HIGHS + at]), min(low, s[R.LOWS + at])
        span += s[R.SPANS + at]
    return high - low, span / over if irregular else span, 0 if irregular else returns


@inner
def is_irregular(s, l, cycles, visible):
    """Whether stress maxima go up and down visibly, and lately not much less than before."""
    count, rise_before, earlier, later = 0, 0.0, 0.0, 0.0
    known = min(cycles, R.RING)
    for k in range(cycles - known + 1, cycles):
        now, last = (k % R.RING) * R.LANES + l, ((k - 1) % R.RING) * R.LANES + l
        rise = s[R.HIGHS + now] - s[R.HIGHS + last]
        if abs(rise) > visible:
            count += rise * rise_before < 0.0
            rise_before = rise
        if k < cycles - known // 2:
            earlier = max(earlier, abs(rise))
        else:
            later = max(later, abs(rise))
    return count >= REVERSALS and later > LASTING * earlier


@inner
def observe(s, l, law, cx, cv, cpsi):
    """Extremes of V, |g|, f and x + f inside the step; `commit` sees to its end.

    Returns where in the step V has one, or -1.
    """
    cf = combined(cv, s[R.BETA + l], cpsi)
    v_extremum, g_extremum, f_extremum, xf_extremum = extrema(s, l, law)
    at = -1.0
    if v_extremum:
        at = extreme(cv)
        v = polynomial(cv, at)
        s[R.V_HIGH + l] = max(s[R.V_HIGH + l], v)
        s[R.V_LOW + l] = min(s[R.V_LOW + l], v)
    if g_extremum:
        cg = combined(cx, -1.0, cf)
        s[R.G_HIGH + l] = max(s[R.G_HIGH + l], abs(polynomial(cg, extreme(cg))))
    if f_extremum:
        s[R.F_LOW + l] = min(s[R.F_LOW + l], polynomial(cf, extreme(cf)))
    if xf_extremum:
        cxf = combined(cx, 1.0, cf)
        s[R.XF_LOW + l] = min(s[R.XF_LOW + l], polynomial(cxf, extreme(cxf)))
    return at


@inner
def outrun(s, l, law):
    """End the case of a lane beyond its limit of speed, unless the motion will turn back.

    At speeds that saturate (exp.py) the slip law needs no other than slip itself, but the aging
    law does.
    """
    v, psi = s[R.V_NEW + l], s[R.PSI_NEW + l]
    if runs_away(law, v, psi, s[R.KAPPA + l], s[R.BETA + l]):
        s[R.STATUS + l] = RUNAWAY
    elif law == AGING and v > LIMIT:
        s[R.STATUS + l] = NOT_FINITE


@inner
def handle_events(s, l, law):
    """Everything of interest in the lane's accepted step, before it is committed."""
    cx, cv, cpsi = components(s, l)
    h, w_lp = s[R.H_USED + l], s[R.W_LP + l]
    dw = h * s[R.RAMP + l]
    if s[R.OBSERVE + l] > 0.0:
        observe(s, l, law, cx, cv, cpsi)
    rises = s[R.W_NEW + l] >= w_lp + dw
    if (s[R.W + l] < w_lp) == rises:
        at = crossing(cv, w_lp, dw, s[R.LOG_W_LP + l])
        if rises:
            close_cycle(s, l, s[R.T_LOW + l] + at * h, polynomial(cx, at))
        else:
            s[R.X_LOW + l] = polynomial(cx, at)
    if s[R.V_NEW + l] > s[R.V_LIMIT + l]:
        outrun(s, l, law)
