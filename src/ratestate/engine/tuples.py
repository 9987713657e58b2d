"""Arithmetic on tuples of numbers, of any length, and their way into the lane buffer and out of it.

The length of a tuple is known to the compiler, for which each of these is written out.  An index
that is computed has to be unsigned, or a loop over lanes does not vectorise.  (`load_rows`, of
arrays, is for no such loop.)
"""

import functools
import operator

import numpy as np  # noqa: F401  (in what is written out)

from .jit import inner, unrolled
from .tracing import traced


def _sum(terms):
    """From the left; 0 of none."""
    terms = tuple(terms)
    return functools.reduce(operator.add, terms) if terms else 0.0


@traced
def zeros(like):
    """As many zeros as a tuple has elements."""
    return (0.0,) * len(like)


@traced
def plus(y, a, k):
    """y + a k."""
    return tuple(y_i + a * k_i for y_i, k_i in zip(y, k, strict=True))


@traced
def times(a, k):
    """a k."""
    return tuple(a * k_i for k_i in k)


@traced
def product(x, y):
    """x_i y_i, as many as the shorter one has."""
    return tuple(x_i * y_i for x_i, y_i in zip(x, y, strict=False))


@traced
def product_each(rows, k):
    """The `product` of each of some tuples with k."""
    return tuple(product(row, k) for row in rows)


@traced
def dot(c, k):
    """sum_i c_i k_i, summed from the left."""
    return _sum(product(c, k))


@traced
def dot_onto(total, c, k):
    """total + sum_i c_i k_i, summed from the left."""
    return _sum((total, *product(c, k)))


@traced
def minus_dot(total, c, k):
    """total - sum_i c_i k_i, from the left."""
    return functools.reduce(operator.sub, product(c, k), total)


@traced
def dot_each(rows, k):
    """The product of a matrix, a tuple of rows, with k."""
    return tuple(dot(row, k) for row in rows)


@traced
def total(k):
    """sum_i k_i, from the left."""
    return _sum(k)


@traced
def sum_of_sizes(k):
    """sum_i |k_i|."""
    return _sum(map(abs, k))


@traced
def size_of(c, k):
    """sum_i |c_i k_i|."""
    return sum_of_sizes(product(c, k))


@traced
def plus_sum(y, c, k):
    """y + sum_i c_i k_i for tuples k_i, summed from the left; of as many c, or fewer k."""
    return functools.reduce(lambda y, one: plus(y, *one), zip(c, k, strict=False), y)


@traced
def sum_of(c, k):
    """sum_i c_i k_i for one tuple k_i or more."""
    return plus_sum(times(c[0], k[0]), c[1:], k[1:])


@traced
def grouped(values, like):
    """Numbers in tuples as long as another."""
    n = len(like)
    return tuple(values[k : k + n] for k in range(0, len(values), n))


@traced
def pairwise_sum(k):
    """sum_i k_i of pairs, and pairs of pairs, added to the first number last."""
    terms = k[1:]
    while len(terms) > 1:
        pairs = [a + b for a, b in zip(terms[::2], terms[1::2], strict=False)]
        terms = (*pairs, *terms[2 * len(pairs) :])
    return k[0] + terms[0]


@traced
def pairwise_sums(rows):
    """The `pairwise_sum` of each of some tuples."""
    return tuple(map(pairwise_sum, rows))


def _lines(line, like):
    """A line for each index # of a tuple, one at least."""
    return [line.replace("#", str(i)) for i in range(len(like))] or ["pass"]


def each(item, like):
    """Lines that return a tuple as long as another, of an item for each index #."""
    return ["return ()" if len(like) == 0 else f"return ({', '.join(_lines(item, like))},)"]


@unrolled
def largest(k):
    """max_i |k_i|; 0 of none."""
    return [f"return max(0.0, {', '.join(_lines('abs(k[#])', k))})" if len(k) else "return 0.0"]


@unrolled
def of_each(rows, i):
    """The i-th number of each of some tuples."""
    return each("rows[#][i]", rows)


@unrolled
def select(condition, x, y):
    """x where the condition is true, else y."""
    return each("x[#] if condition else y[#]", x)


@unrolled
def read_rows(s, rows, l):
    """What stands in these rows of lane l."""
    return each("s[np.uintp(rows[#] + l)]", rows)


@unrolled
def write_rows(s, rows, l, values):
    """Put values into these rows of lane l, or the first of them."""
    return _lines("s[np.uintp(rows[#] + l)] = values[#]", values)


@unrolled
def load_each(s, rows, l):
    """What stands in these tuples of rows of lane l."""
    return each("read_rows(s, rows[#], l)", rows)


@unrolled
def store_each(s, rows, l, values):
    """Put tuples into these tuples of rows of lane l."""
    return _lines("write_rows(s, rows[#], l, values[#])", rows)


@inner
def load_rows(s, rows, l, values):
    """Put the numbers of an array into these rows of lane l."""
    for k in range(len(rows)):
        s[rows[k] + l] = values[k]


@unrolled
def write(out, start, values):
    """Put the numbers of a tuple into an array, from an index on."""
    return _lines("out[start + #] = values[#]", values)
