"""The dense output of a step: polynomials in the fraction s of the step, and where they cross.

A polynomial is a tuple of 5 coefficients, the constant first.
"""

import math

from .exp import exp_alone
from .jit import inner, recursive
from .rows import rows_of
from .tuples import dot_onto, read_rows


@inner
def components(s, l, law):
    """The polynomials of x, v and each psi over the lane's step, a tuple."""
    rows = rows_of(law)
    y, y_new = read_rows(s, rows.y, l), read_rows(s, rows.y_new, l)
    return coefficients(
        y, y_new, read_rows(s, rows.y_1, l), read_rows(s, rows.y_2, l), read_rows(s, rows.y_3, l)
    )


@recursive
def coefficients(y0, y1, k1, k2, k3):
    """Dense output as polynomials.

    y0, y1 : the state at the ends of the step; k1, k2, k3 : K_1, K_2, K_3 (tableau.py)
    """
    if len(y0) == 0:
        return ()
    first = y0[0], (y1[0] - y0[0]) + k1[0], k2[0] - k1[0], k3[0] - k2[0], -k3[0]
    return first, *coefficients(y0[1:], y1[1:], k1[1:], k2[1:], k3[1:])


@recursive
def polynomials(c, s):
    """The values of polynomials c at s."""
    if len(c) == 0:
        return ()
    return polynomial(c[0], s), *polynomials(c[1:], s)


@recursive
def derivatives(c, s):
    """The derivatives of polynomials c with respect to s, at s."""
    if len(c) == 0:
        return ()
    return derivative(c[0], s), *derivatives(c[1:], s)


@inner
def polynomial(c, s):
    """The value of polynomial c at s."""
    return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4])))


@inner
def derivative(c, s):
    """The derivative of polynomial c with respect to s, at s."""
    return c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * 4.0 * c[4]))


@inner
def extreme(c):
    """Where in 0..1 the derivative of polynomial c vanishes (Newton inside a bracket).

    Where the derivative has one sign at both ends, the end (0.0 or 1.0) where it is smaller in
    size.
    """
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
    """Where in 0..1 the polynomial c of v is ln(w_lp + dw s), which the caller has seen it cross.

    w_lp, dw : speed at the start of the step, > 0 at any s, and its change in the step
    log_w_lp : ln(w_lp), used where dw = 0
    """
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
def force_and_slope(c, s, x_part, S_part, f_part, law, p):
    """x_part x + S_part S + f_part f at s on the polynomials c of (x, v, psi); its slope.

    S is the stress that opposes motion, f the friction.
    """
    y, slope = polynomials(c, s), derivatives(c, s)
    w = exp_alone(y[1])
    S_v, S_psi = law.stress_partials(y[1], w, y[2:], p)
    R_v, R_psi = law.resistance_partials(y[1], w, y[2:], p)
    force = x_part * y[0] + S_part * law.stress(y[1], w, y[2:], p)
    force += f_part * law.resistance(y[1], w, y[2:], p)
    by_S, by_f = (
        dot_onto(S_v * slope[1], S_psi, slope[2:]),
        dot_onto(R_v * slope[1], R_psi, slope[2:]),
    )
    return force, x_part * slope[0] + S_part * by_S + f_part * by_f


@inner
def extreme_force(c, x_part, S_part, f_part, law, p):
    """The value of `force_and_slope` where in 0..1 its slope vanishes (regula falsi, Illinois).

    Where the slope has one sign at both ends, that at the end where it is smaller in size.
    """
    low, high = 0.0, 1.0
    at_low, d_low = force_and_slope(c, low, x_part, S_part, f_part, law, p)
    force, d_high = force_and_slope(c, high, x_part, S_part, f_part, law, p)
    if (d_low < 0.0) == (d_high < 0.0):
        return at_low if abs(d_low) < abs(d_high) else force
    side, last = 0, 2.0
    for _ in range(100):
        s = (low * d_high - high * d_low) / (d_high - d_low)
        force, d = force_and_slope(c, s, x_part, S_part, f_part, law, p)
        if d == 0.0 or abs(s - last) < 1e-14:
            return force
        last = s
        if (d < 0.0) == (d_low < 0.0):
            low, d_low = s, d
            d_high = 0.5 * d_high if side == 1 else d_high
            side = 1
        else:
            high, d_high = s, d
            d_low = 0.5 * d_low if side == -1 else d_low
            side = -1
    return force
