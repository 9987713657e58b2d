"""The dense output of a step: polynomials in the fraction s of the step.

A polynomial is a view of its coefficients, the constant first, in the lane buffer: of degree 4 for
a step of Rodas5P, of `recurrences.ORDER` for one of the Taylor method.
"""

from . import rows as R
from .jit import inlined, inner, unrolled
from .rows import rows_of
from .tuples import each

#: the last step of Newton's method, in fractions of a step: its square is below rounding
CONVERGED = 1e-9


@inner
def components(s, l, law):
    """The polynomials of x, v and each psi over the lane's step, a tuple."""
    rows = rows_of(law).c
    n = len(rows[0]) if s[R.TAYLOR + l] > 0.0 else R.OF_RODAS5P
    return views(s, rows, l, n * R.LANES)


@unrolled
def views(s, rows, l, length):
    """Of each of some tuples of rows, those of lane l, of this length in the buffer."""
    return each("s[rows[#][0] + l : rows[#][0] + l + length : R.LANES]", rows)


@unrolled
def polynomials(c, s):
    """The values of polynomials c at s."""
    return each("polynomial(c[#], s)", c)


@unrolled
def values_and_slopes(c, s):
    """The values of polynomials c at s, and their derivatives by s there: a pair for each."""
    return each("value_and_slope(c[#], s)", c)


@inlined
def polynomial(c, s):
    """The value of polynomial c at s."""
    value = c[c.size - 1]
    for k in range(c.size - 2, -1, -1):
        value = c[k] + s * value
    return value


@inlined
def value_and_slope(c, s):
    """`polynomial` and `derivative`, which go side by side."""
    value, slope = c[c.size - 1], 0.0
    for k in range(c.size - 2, -1, -1):
        slope = value + s * slope
        value = c[k] + s * value
    return value, slope


@inlined
def derivative(c, s):
    """The derivative of polynomial c with respect to s, at s."""
    n = c.size - 1
    value = n * c[n]
    for k in range(n - 1, 0, -1):
        value = k * c[k] + s * value
    return value


@inlined
def curvature(c, s):
    """The second derivative of polynomial c with respect to s, at s."""
    n = c.size - 1
    value = n * (n - 1) * c[n]
    for k in range(n - 1, 1, -1):
        value = k * (k - 1) * c[k] + s * value
    return value


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
        bend = curvature(c, s)
        step = d / bend if bend != 0.0 else 2.0
        new = s - step
        if abs(step) < CONVERGED:
            return new
        s = new if low < new < high else 0.5 * (low + high)
    return s
