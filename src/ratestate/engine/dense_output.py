"""The dense output of a step: polynomials in the fraction s of the step.

A polynomial is a tuple of 5 coefficients, the constant first.
"""

from .jit import inner, recursive
from .rows import rows_of
from .tuples import read_rows


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
