"""The dense output of a step: polynomials in the fraction s of the step, and where they cross.

A polynomial is a tuple of 5 coefficients, the constant first.
"""

import math

from . import rows as R
from .jit import inner


@inner
def coefficients(y0, y1, k1, k2, k3):
    """Dense output of one component as a polynomial.

    y0, y1 : its values at the ends of the step; k1, k2, k3 : its K_1, K_2, K_3 (tableau.py)
    """
    return y0, (y1 - y0) + k1, k2 - k1, k3 - k2, -k3


@inner
def components(s, l):
    """The three polynomials of x, v and psi over the lane's step."""
    return (
        coefficients(s[R.X + l], s[R.X_NEW + l], s[R.X_1 + l], s[R.X_2 + l], s[R.X_3 + l]),
        coefficients(s[R.V + l], s[R.V_NEW + l], s[R.V_1 + l], s[R.V_2 + l], s[R.V_3 + l]),
        coefficients(
            s[R.PSI + l], s[R.PSI_NEW + l], s[R.PSI_1 + l], s[R.PSI_2 + l], s[R.PSI_3 + l]
        ),
    )


@inner
def polynomial(c, s):
    """The value of polynomial c at s."""
    return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4])))


@inner
def derivative(c, s):
    """The derivative of polynomial c with respect to s, at s."""
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
