"""Arithmetic on tuples of numbers, of any length, and their way into the lane buffer and out of it.

The length of a tuple is known to the compiler, for which each of these is written out.  An index
that is computed has to be unsigned, or a loop over lanes does not vectorise.  (`load_rows`, of
arrays, is for no such loop.)
"""

import numpy as np  # noqa: F401  (in what is written out)

from .jit import inlined, inner, unrolled


def _lines(line, like):
    """A line for each index # of a tuple, one at least."""
    return [line.replace("#", str(i)) for i in range(len(like))] or ["pass"]


def _each(item, like):
    """Lines that return a tuple as long as another, of an item for each index #."""
    return ["return ()" if len(like) == 0 else f"return ({', '.join(_lines(item, like))},)"]


def _sum(term, like):
    """Lines that return a sum of a term for each index #, from the left; 0 of none."""
    return ["return 0.0" if len(like) == 0 else "return " + " + ".join(_lines(term, like))]


def _onto(first, term, like):
    """Lines that return a number, and a signed term for each index #, from the left."""
    return [f"return {first}" + "".join(_lines(term, like) if len(like) > 0 else ())]


@unrolled
def full(like, value):
    """The value, as many times as a tuple has elements."""
    return _each("value", like)


@inlined
def zeros(like):
    """As many zeros as a tuple has elements."""
    return full(like, 0.0)


@unrolled
def plus(y, a, k):
    """y + a k."""
    return _each("y[#] + a * k[#]", y)


@unrolled
def times(a, k):
    """a k."""
    return _each("a * k[#]", k)


@unrolled
def product(x, y):
    """x_i y_i."""
    return _each("x[#] * y[#]", x)


@unrolled
def dot(c, k):
    """sum_i c_i k_i, summed from the left."""
    return _sum("c[#] * k[#]", c)


@unrolled
def dot_onto(total, c, k):
    """total + sum_i c_i k_i, summed from the left."""
    return _onto("total", " + c[#] * k[#]", c)


@unrolled
def minus_dot(total, c, k):
    """total - sum_i c_i k_i, from the left."""
    return _onto("total", " - c[#] * k[#]", c)


@unrolled
def total(k):
    """sum_i k_i, from the left."""
    return _sum("k[#]", k)


@unrolled
def sum_of_sizes(k):
    """sum_i |k_i|."""
    return _sum("abs(k[#])", k)


@unrolled
def size_of(c, k):
    """sum_i |c_i k_i|."""
    return _sum("abs(c[#] * k[#])", c)


@unrolled
def largest(k):
    """max_i |k_i|; 0 of none."""
    return [f"return max(0.0, {', '.join(_lines('abs(k[#])', k))})" if len(k) else "return 0.0"]


@unrolled
def plus_sum(y, c, k):
    """y + sum_i c_i k_i for tuples k_i, as many as there are, summed from the left."""
    names = [line for i in range(len(k)) for line in (f"c_{i} = c[{i}]", f"k_{i} = k[{i}]")]
    return names + _each("y[#]" + "".join(f" + c_{i} * k_{i}[#]" for i in range(len(k))), y)


@inlined
def sum_of(c, k):
    """sum_i c_i k_i for one tuple k_i or more."""
    return plus_sum(times(c[0], k[0]), c[1:], k[1:])


@unrolled
def dot_each(rows, k):
    """The product of a matrix, a tuple of rows, with k."""
    return _each("dot(rows[#], k)", rows)


@unrolled
def product_each(rows, k):
    """The `product` of each of some tuples with k."""
    return _each("product(rows[#], k)", rows)


@unrolled
def pairwise_sum(k):
    """sum_i k_i of a tuple, of pairs and pairs of pairs, added to the first last."""
    terms = [f"k[{i}]" for i in range(1, len(k))]
    while len(terms) > 1:
        pairs = [f"({a} + {b})" for a, b in zip(terms[::2], terms[1::2], strict=False)]
        terms = pairs + terms[2 * len(pairs) :]
    return [f"return {' + '.join(['k[0]', *terms])}"]


@unrolled
def pairwise_sums(rows):
    """The `pairwise_sum` of each of some tuples."""
    return _each("pairwise_sum(rows[#])", rows)


@unrolled
def of_each(rows, i):
    """The i-th number of each of some tuples."""
    return _each("rows[#][i]", rows)


@unrolled
def select(condition, x, y):
    """x where the condition is true, else y."""
    return _each("x[#] if condition else y[#]", x)


@unrolled
def read_rows(s, rows, l):
    """What stands in these rows of lane l."""
    return _each("s[np.uintp(rows[#] + l)]", rows)


@unrolled
def write_rows(s, rows, l, values):
    """Put values into these rows of lane l, or the first of them."""
    return _lines("s[np.uintp(rows[#] + l)] = values[#]", values)


@unrolled
def load_each(s, rows, l):
    """What stands in these tuples of rows of lane l."""
    return _each("read_rows(s, rows[#], l)", rows)


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
