"""Where in a step, by its dense output, forces and speeds are extreme, and speeds cross.

Places are fractions of the step, 0 to 1.
"""

import math

from . import rows as R
from .dense_output import (
    CONVERGED,
    component,
    component_and_slope,
    extreme,
    state,
    state_and_slopes,
)
from .drift import UNITY
from .equations import speed_alone
from .jit import inlined, inner, recursive
from .rows import rows_of
from .tracing import traced
from .tuples import dot_onto, read_rows, times

FORCE, SPEED, LEAD = (), (0.0,), (0.0, 0.0)
# Parts of x, the stress S that opposes motion, the strength N and friction R: `force_and_slope`.
INERTIAL_FORCE, FRICTION = (1.0, -1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
WITH_STRENGTH = (1.0, 0.0, 1.0, 0.0)


@inlined
def v_ahead(s, l, rows, load, at):
    """How far v is above the load point's, and its slope.

    rows : of the coefficients of v; load : as of `crossing`
    """
    w_lp, dw, log_w_lp = load
    v, slope = component_and_slope(s, l, rows, at)
    if dw == 0.0:
        return v - log_w_lp, slope
    w = w_lp + dw * at
    return v - math.log(w), slope - dw / w


@inner
def crossing_of_v(s, l, rows, load, low, high):
    """Where from low to high v is ln(w_lp + dw at), of speeds > 0.

    rows, load : as of `v_ahead`
    """
    (start, _), (end, _) = v_ahead(s, l, rows, load, low), v_ahead(s, l, rows, load, high)
    between = start / (start - end) if (start < 0.0) != (end < 0.0) else 0.5
    at = low + (high - low) * between
    for _ in range(60):
        ahead, slope = v_ahead(s, l, rows, load, at)
        if (ahead < 0.0) == (start < 0.0):
            low = at
        else:
            high = at
        new = at - ahead / slope if slope != 0.0 else 2.0
        if not low < new < high:
            new = 0.5 * (low + high)
        elif abs(new - at) < CONVERGED:
            return new
        at = new
    return at


@inner
def force_and_slope(s, l, law, at, parts):
    """A sum of parts of x, S, N and R at a place in the lane's step; its slope."""
    h = s[R.H_USED + l]
    p = law.later(read_rows(s, rows_of(law).p, l), at * h)
    y, dy = state_and_slopes(s, l, law, at)
    w, e = speed_alone(y, law, p)
    by_x, d_omega, by_psi = slopes_along(dy, w, e, law, p)
    here = y[1], w, y[2:], e, p
    drift = times(h, law.strength_drift(y[1], w, y[2:], p))
    by_S = dot_onto(along(law.stress_slopes(*here), d_omega, by_psi), drift, UNITY)
    by_N = dot_onto(along(law.strength_slopes(*here), d_omega, by_psi), drift, UNITY)
    by_R = along(law.resistance_slopes(*here), d_omega, by_psi)
    force = parts[0] * y[0] + parts[1] * law.stress_in_v(y[1], w, y[2:], p)
    force += parts[2] * law.strength_in_v(y[1], w, y[2:], p)
    force += parts[3] * law.resistance_in_v(y[1], w, y[2:], p)
    return force, parts[0] * by_x + parts[1] * by_S + parts[2] * by_N + parts[3] * by_R


@traced
def along(slopes, d_omega, d_psi):
    """The change of what has these slopes."""
    return dot_onto(slopes[0] * d_omega, slopes[1], d_psi)


@inner
def speed_and_slope(s, l, law, at):
    """w at a place in the lane's step, and its slope."""
    y, dy = state_and_slopes(s, l, law, at)
    p = read_rows(s, rows_of(law).p, l)
    w, e = speed_alone(y, law, p)
    return w, law.speed_slope(w, e) * slopes_along(dy, w, e, law, p)[1]


@inlined
def slopes_along(dy, w, e, law, p):
    """Derivatives of x, omega (`kinematics`) and psi, a tuple, of those of x, v and psi."""
    shares = law.shares(w, 1.0 / law.speed_slope(w, e), p)
    return dy[0], dot_onto(dy[1], shares, dy[2:]), dy[2:]


@inner
def lead(s, l, law, at, load):
    """v at a place in the lane's step, and less that of the load point's speed there.

    load : its speed at the start of the step, and its change in the step
    """
    y = state(s, l, law, at)
    p = read_rows(s, rows_of(law).p, l)
    return y[1], y[1] - law.v_at(load[0] + load[1] * at, y[2:], p)


@recursive
def of_step(what, s, l, law, at, of):
    """`force_and_slope`, `speed_and_slope` or `lead`: as there are 0, 1 or 2 of `what`.

    (A function that is passed on has an address, with which no kernel can be kept on disk.)
    """
    if len(what) == 0:
        return force_and_slope(s, l, law, at, of)
    if len(what) == 1:
        return speed_and_slope(s, l, law, at)
    return lead(s, l, law, at, of)


@inner
def root(what, s, l, law, of, low, high, enough):
    """Where from low to high the second of what `of_step` gives vanishes, and the first there.

    By regula falsi (Illinois).  Where it has one sign at both ends, the end where it is smaller in
    size.

    enough : the error that the first may have, of which the second is the slope; 0 if it is not
    """
    first, at_low = of_step(what, s, l, law, low, of)
    here, at_high = of_step(what, s, l, law, high, of)
    if (at_low < 0.0) == (at_high < 0.0):
        return (low, first) if abs(at_low) < abs(at_high) else (high, here)
    side, at, last = 0, high, 2.0
    for _ in range(100):
        at = (low * at_high - high * at_low) / (at_high - at_low)
        here, off = of_step(what, s, l, law, at, of)
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


@inner
def extreme_value(s, l, law, parts, enough):
    """The value of a sum of parts where in the lane's step its slope vanishes, as of `root`."""
    return root(FORCE, s, l, law, parts, 0.0, 1.0, enough)[1]


@inner
def extreme_speed(s, l, law):
    """Where in the lane's step the speed is extreme, and its `order_of_speed`."""
    return _extreme_speed(backward(s, l, law), s, l, law)


@inner
def crossing(s, l, law, load, low, high):
    """Where from low to high the speed is the load point's, which the caller has seen it cross.

    load : the load point's speed at the start of the step, its change in the step, and, if that is
        0, the logarithm of the speed
    """
    return _crossing(backward(s, l, law), s, l, law, load, low, high)


@inlined
def backward(s, l, law):
    """The law's `jump_exponents` at the start of the step: () if v alone gives the speed."""
    y = read_rows(s, rows_of(law).y, l)
    return law.jump_exponents(y[1], y[2:], read_rows(s, rows_of(law).p, l))


@recursive
def _extreme_speed(back, s, l, law):
    if len(back) == 0:
        rows = rows_of(law).c[1]
        at = extreme(s, l, rows)
        return at, component(s, l, rows, at)
    return root(SPEED, s, l, law, (), 0.0, 1.0, 0.0)


@recursive
def _crossing(back, s, l, law, load, low, high):
    if len(back) == 0:
        return crossing_of_v(s, l, rows_of(law).c[1], load, low, high)
    return root(LEAD, s, l, law, load[:2], low, high, 0.0)[0]
