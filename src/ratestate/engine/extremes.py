"""Where in a step, by its dense output, forces and speeds are extreme, and speeds cross.

Places are fractions of the step, 0 to 1, and c are the polynomials of x, v and psi.
"""

import math

from .dense_output import (
    CONVERGED,
    extreme,
    polynomial,
    polynomials,
    value_and_slope,
    values_and_slopes,
)
from .drift import UNITY
from .equations import speed_alone
from .jit import inlined, inner, recursive
from .tracing import traced
from .tuples import dot_onto, of_each, times

FORCE, SPEED, LEAD = (), (0.0,), (0.0, 0.0)
# Parts of x, the stress S that opposes motion, the strength N and friction R: `force_and_slope`.
INERTIAL_FORCE, FRICTION = (1.0, -1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
WITH_STRENGTH = (1.0, 0.0, 1.0, 0.0)


@inlined
def v_ahead(c, load, s):
    """How far the polynomial c of v is above the load point's at s, and its slope.

    load : as of `crossing`
    """
    w_lp, dw, log_w_lp = load
    value, slope = value_and_slope(c, s)
    if dw == 0.0:
        return value - log_w_lp, slope
    w = w_lp + dw * s
    return value - math.log(w), slope - dw / w


@inner
def crossing_of_v(c, load, low, high):
    """Where from low to high the polynomial c of v is ln(w_lp + dw s), of speeds > 0.

    load : as of `crossing`
    """
    (start, _), (end, _) = v_ahead(c, load, low), v_ahead(c, load, high)
    between = start / (start - end) if (start < 0.0) != (end < 0.0) else 0.5
    s = low + (high - low) * between
    for _ in range(60):
        value, slope = v_ahead(c, load, s)
        if (value < 0.0) == (start < 0.0):
            low = s
        else:
            high = s
        new = s - value / slope if slope != 0.0 else 2.0
        if not low < new < high:
            new = 0.5 * (low + high)
        elif abs(new - s) < CONVERGED:
            return new
        s = new
    return s


@inner
def force_and_slope(s, c, of, law, p):
    """A sum of parts of x, S, N and R at s on the polynomials c of (x, v, psi); its slope.

    of : the parts, and the length of the step
    """
    parts, h = of
    p = law.later(p, s * h)
    both = values_and_slopes(c, s)
    y, dy = of_each(both, 0), of_each(both, 1)
    w, e = speed_alone(y, law, p)
    by_x, d_omega, by_psi = slopes_along(dy, w, e, law, p)
    at = y[1], w, y[2:], e, p
    drift = times(h, law.strength_drift(y[1], w, y[2:], p))
    by_S = dot_onto(along(law.stress_slopes(*at), d_omega, by_psi), drift, UNITY)
    by_N = dot_onto(along(law.strength_slopes(*at), d_omega, by_psi), drift, UNITY)
    by_R = along(law.resistance_slopes(*at), d_omega, by_psi)
    force = parts[0] * y[0] + parts[1] * law.stress_in_v(y[1], w, y[2:], p)
    force += parts[2] * law.strength_in_v(y[1], w, y[2:], p)
    force += parts[3] * law.resistance_in_v(y[1], w, y[2:], p)
    return force, parts[0] * by_x + parts[1] * by_S + parts[2] * by_N + parts[3] * by_R


@traced
def along(slopes, d_omega, d_psi):
    """The change of what has these slopes."""
    return dot_onto(slopes[0] * d_omega, slopes[1], d_psi)


@inner
def speed_and_slope(s, c, _, law, p):
    """w at s on the polynomials c of (x, v, psi), and its slope."""
    both = values_and_slopes(c, s)
    y, dy = of_each(both, 0), of_each(both, 1)
    w, e = speed_alone(y, law, p)
    return w, law.speed_slope(w, e) * slopes_along(dy, w, e, law, p)[1]


@inlined
def slopes_along(dy, w, e, law, p):
    """Derivatives of x, omega (`kinematics`) and psi, a tuple, of those of x, v and psi."""
    shares = law.shares(e, 1.0 / law.speed_slope(w, e), p)
    return dy[0], dot_onto(dy[1], shares, dy[2:]), dy[2:]


@inner
def lead(s, c, load, law, p):
    """v at s on the polynomials c of (x, v, psi), and less that of the load point's speed there.

    load : its speed at the start of the step, and its change in the step
    """
    y = polynomials(c, s)
    return y[1], y[1] - law.v_at(load[0] + load[1] * s, y[2:], p)


@recursive
def of_step(what, s, c, of, law, p):
    """`force_and_slope`, `speed_and_slope` or `lead`: as there are 0, 1 or 2 of `what`.

    (A function that is passed on has an address, with which no kernel can be kept on disk.)
    """
    if len(what) == 0:
        return force_and_slope(s, c, of, law, p)
    if len(what) == 1:
        return speed_and_slope(s, c, of, law, p)
    return lead(s, c, of, law, p)


@inner
def root(what, c, of, law, p, low, high, enough):
    """Where from low to high the second of what `of_step` gives vanishes, and the first there.

    By regula falsi (Illinois).  Where it has one sign at both ends, the end where it is smaller in
    size.

    enough : the error that the first may have, of which the second is the slope; 0 if it is not
    """
    first, at_low = of_step(what, low, c, of, law, p)
    here, at_high = of_step(what, high, c, of, law, p)
    if (at_low < 0.0) == (at_high < 0.0):
        return (low, first) if abs(at_low) < abs(at_high) else (high, here)
    side, s, last = 0, high, 2.0
    for _ in range(100):
        s = (low * at_high - high * at_low) / (at_high - at_low)
        here, off = of_step(what, s, c, of, law, p)
        if off == 0.0 or abs(s - last) < 1e-14 or abs(off * (s - last)) < enough:
            break
        last = s
        if (off < 0.0) == (at_low < 0.0):
            low, at_low = s, off
            at_high = 0.5 * at_high if side == 1 else at_high
            side = 1
        else:
            high, at_high = s, off
            at_low = 0.5 * at_low if side == -1 else at_low
            side = -1
    return s, here


@inner
def extreme_value(c, parts, h, law, p, enough):
    """The value of a sum of parts where in 0..1 its slope vanishes, as of `root`.

    h : length of the step, at the start of which the coefficients are p
    """
    return root(FORCE, c, (parts, h), law, p, 0.0, 1.0, enough)[1]


@inner
def extreme_speed(c, law, p):
    """Where in 0..1 the speed is extreme on the polynomials c, and its `order_of_speed`."""
    return _extreme_speed(backward(c, law, p), c, law, p)


@inner
def crossing(c, load, law, p, low, high):
    """Where from low to high the speed is the load point's, which the caller has seen it cross.

    load : the load point's speed at the start of the step, its change in the step, and, if that is
        0, the logarithm of the speed
    """
    return _crossing(backward(c, law, p), c, load, law, p, low, high)


@inlined
def backward(c, law, p):
    """The law's `backward_exponent` at the start of the step: () where v alone tells the speed."""
    y = polynomials(c, 0.0)
    return law.backward_exponent(y[1], y[2:], p)


@recursive
def _extreme_speed(back, c, law, p):
    if len(back) == 0:
        at = extreme(c[1])
        return at, polynomial(c[1], at)
    return root(SPEED, c, (), law, p, 0.0, 1.0, 0.0)


@recursive
def _crossing(back, c, load, law, p, low, high):
    if len(back) == 0:
        return crossing_of_v(c[1], load, low, high)
    return root(LEAD, c, load[:2], law, p, low, high, 0.0)[0]
