"""The dense output of a step: polynomials in the fraction of the step that is over, 0 to 1.

Their coefficients, the constant first, stand in rows of the lane buffer: of degree 4 after a step
of Rodas5P, of `recurrences.ORDER` after one of the Taylor method.
"""

from . import rows as R
from .jit import inlined, inner, unrolled
from .rows import rows_of
from .tracing import traced
from .tuples import each, load_each, read_rows

#: the last step of Newton's method, in fractions of a step: its square is below rounding
CONVERGED = 1e-9


@inner
def state(s, l, law, at):
    """x, v and each psi at a place in the lane's step."""
    rows = rows_of(law).c
    if by_taylor(s, l, rows[0]):
        return values(load_each(s, rows, l), at)
    return values(load_each(s, first_terms(rows), l), at)


@inner
def state_and_slopes(s, l, law, at):
    """`state`, and its derivatives by the fraction of the step: two tuples."""
    rows = rows_of(law).c
    if by_taylor(s, l, rows[0]):
        return values_and_slopes(load_each(s, rows, l), at)
    return values_and_slopes(load_each(s, first_terms(rows), l), at)


@inlined
def component(s, l, rows, at):
    """One number of `state`; rows : of its coefficients."""
    if by_taylor(s, l, rows):
        return value(read_rows(s, rows, l), at)
    return value(read_rows(s, rows[: R.OF_RODAS5P], l), at)


@inlined
def component_and_slope(s, l, rows, at):
    """`component`, and its derivative."""
    if by_taylor(s, l, rows):
        return value_and_slope(read_rows(s, rows, l), at)
    return value_and_slope(read_rows(s, rows[: R.OF_RODAS5P], l), at)


@inlined
def slope_and_bend(s, l, rows, at):
    """The first and second derivative of `component`."""
    if by_taylor(s, l, rows):
        return two_derivatives(read_rows(s, rows, l), at)
    return two_derivatives(read_rows(s, rows[: R.OF_RODAS5P], l), at)


@inlined
def by_taylor(s, l, rows):
    """Whether the lane's step is of the Taylor method; rows : of the coefficients of a number."""
    return len(rows) > R.OF_RODAS5P and s[R.TAYLOR + l] > 0.0


@unrolled
def first_terms(rows):
    """The rows of the coefficients that a step of Rodas5P has, of each of some tuples."""
    return each("rows[#][: R.OF_RODAS5P]", rows)


@traced
def value(c, at):
    """The value of the polynomial of these coefficients, by Horner's rule."""
    result = c[-1]
    for one in c[-2::-1]:
        result = one + at * result
    return result


@traced
def value_and_slope(c, at):
    """`value`, and its derivative."""
    result, slope = c[-2] + at * c[-1], c[-1]
    for one in c[-3::-1]:
        slope = result + at * slope
        result = one + at * result
    return result, slope


@traced
def two_derivatives(c, at):
    """The first and second derivative of the polynomial of these coefficients."""
    return value_and_slope(tuple(k * one for k, one in enumerate(c) if k > 0), at)


@traced
def values(polynomials, at):
    """The `value` of each."""
    return tuple(value(c, at) for c in polynomials)


@traced
def values_and_slopes(polynomials, at):
    """The values of all, and their derivatives."""
    return tuple(zip(*(value_and_slope(c, at) for c in polynomials), strict=True))


@inner
def extreme(s, l, rows):
    """Where in 0..1 the derivative of a `component` vanishes (Newton inside a bracket).

    Where the derivative has one sign at both ends, the end (0.0 or 1.0) where it is smaller in
    size.
    """
    low, high = 0.0, 1.0
    (d_low, _), (d_high, _) = slope_and_bend(s, l, rows, low), slope_and_bend(s, l, rows, high)
    if (d_low < 0.0) == (d_high < 0.0):
        return 0.0 if abs(d_low) < abs(d_high) else 1.0
    at = d_low / (d_low - d_high)
    for _ in range(60):
        d, bend = slope_and_bend(s, l, rows, at)
        if (d < 0.0) == (d_low < 0.0):
            low = at
        else:
            high = at
        step = d / bend if bend != 0.0 else 2.0
        new = at - step
        if abs(step) < CONVERGED:
            return new
        at = new if low < new < high else 0.5 * (low + high)
    return at
