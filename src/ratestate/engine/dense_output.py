"""The dense output of a step: polynomials in the fraction s of the step.

A polynomial is a tuple of coefficients, the constant first: 5 of a step of Rodas5P.
"""

from . import rows as R
from .jit import inlined, inner, recursive
from .rows import rows_of
from .tuples import load_each, read_rows


@inner
def components(s, l, law):
    """The polynomials of x, v and each psi over the lane's step, a tuple."""
    return by_kind(rows_of(law).c, s, l, components_of_rodas(s, l, law))


@inner
def components_of_rodas(s, l, law):
    """`components`, of a step of Rodas5P."""
    rows = rows_of(law)
    y, y_new = read_rows(s, rows.y, l), read_rows(s, rows.y_new, l)
    return coefficients(
        y, y_new, read_rows(s, rows.y_1, l), read_rows(s, rows.y_2, l), read_rows(s, rows.y_3, l)
    )


@recursive
def by_kind(rows, s, l, by_rodas):
    """The polynomials, of as high a degree for both kinds of steps."""
    if len(rows) == 0:
        return by_rodas
    if s[R.TAYLOR + l] > 0.0:
        return scaled_each(load_each(s, rows, l), s[R.H_USED + l])
    return padded_each(by_rodas, rows)


@recursive
def scaled_each(c, h):
    """Polynomials in the fraction of a step h, of those in T."""
    if len(c) == 0:
        return ()
    return scaled(c[0], h, 1.0), *scaled_each(c[1:], h)


@recursive
def scaled(c, h, power):
    """c_k h**k for each k; power : of h, of the first."""
    if len(c) == 0:
        return ()
    return c[0] * power, *scaled(c[1:], h, power * h)


@recursive
def padded_each(c, rows):
    """`padded`, of each."""
    if len(c) == 0:
        return ()
    return padded(c[0], rows[0]), *padded_each(c[1:], rows[1:])


@recursive
def padded(c, rows):
    """c, and zeros, as many numbers as rows."""
    if len(rows) == 0:
        return ()
    if len(c) == 0:
        return 0.0, *padded(c, rows[1:])
    return c[0], *padded(c[1:], rows[1:])


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


@recursive
def polynomial(c, s):
    """The value of polynomial c at s."""
    if len(c) == 1:
        return c[0]
    return c[0] + s * polynomial(c[1:], s)


@inlined
def derivative(c, s):
    """The derivative of polynomial c with respect to s, at s."""
    return slope_from(c[1:], s, 1.0)


@recursive
def slope_from(c, s, k):
    """The derivative over s**(k - 1), of the terms from degree k on."""
    if len(c) == 1:
        return k * c[0]
    return k * c[0] + s * slope_from(c[1:], s, k + 1.0)


@recursive
def curvature_from(c, s, k):
    """The second derivative over s**(k - 2), of the terms from degree k on."""
    if len(c) == 1:
        return k * (k - 1.0) * c[0]
    return k * (k - 1.0) * c[0] + s * curvature_from(c[1:], s, k + 1.0)


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
        curvature = curvature_from(c[2:], s, 2.0)
        step = d / curvature if curvature != 0.0 else 2.0
        new = s - step
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) < 1e-14:
            return new
        s = new
    return s
