"""Arithmetic on tuples of numbers, of any length, and their way into the lane buffer and out of it.

The length of a tuple is known to the compiler, which leaves out what does not apply: so each of
these is straight-line code in the end.  An index that is computed has to be unsigned, or a loop
over lanes does not vectorise.  (`load_rows`, of arrays, is for no such loop.)
"""

import numpy as np

from .jit import inlined, inner, recursive


@recursive
def full(like, value):
    """The value, as many times as a tuple has elements."""
    if len(like) == 0:
        return ()
    return value, *full(like[1:], value)


@inlined
def zeros(like):
    """As many zeros as a tuple has elements."""
    return full(like, 0.0)


@recursive
def plus(y, a, k):
    """y + a k."""
    if len(y) == 0:
        return ()
    return y[0] + a * k[0], *plus(y[1:], a, k[1:])


@recursive
def times(a, k):
    """a k."""
    if len(k) == 0:
        return ()
    return a * k[0], *times(a, k[1:])


@inlined
def dot(c, k):
    """sum_i c_i k_i, summed from the left."""
    if len(c) == 0:
        return 0.0
    return dot_onto(c[0] * k[0], c[1:], k[1:])


@recursive
def dot_onto(total, c, k):
    """total + sum_i c_i k_i, summed from the left."""
    if len(c) == 0:
        return total
    return dot_onto(total + c[0] * k[0], c[1:], k[1:])


@recursive
def total(k):
    """sum_i k_i, from the left."""
    if len(k) == 0:
        return 0.0
    if len(k) == 1:
        return k[0]
    return total(k[:-1]) + k[-1]


@recursive
def largest(k):
    """max_i |k_i|; 0 of none."""
    if len(k) == 0:
        return 0.0
    if len(k) == 1:
        return abs(k[0])
    return max(abs(k[0]), largest(k[1:]))


@recursive
def size_of(c, k):
    """sum_i |c_i k_i|."""
    if len(c) == 0:
        return 0.0
    return abs(c[0] * k[0]) + size_of(c[1:], k[1:])


@recursive
def sum_of_sizes(k):
    """sum_i |k_i|."""
    if len(k) == 0:
        return 0.0
    return abs(k[0]) + sum_of_sizes(k[1:])


@recursive
def plus_sum(y, c, k):
    """y + sum_i c_i k_i for tuples k_i, as many as there are, summed from the left."""
    if len(k) == 0:
        return y
    return plus_sum(plus(y, c[0], k[0]), c[1:], k[1:])


@inlined
def sum_of(c, k):
    """sum_i c_i k_i for one tuple k_i or more."""
    return plus_sum(times(c[0], k[0]), c[1:], k[1:])


@recursive
def select(condition, x, y):
    """x where the condition is true, else y."""
    if len(x) == 0:
        return ()
    first = x[0] if condition else y[0]
    return first, *select(condition, x[1:], y[1:])


@recursive
def read_rows(s, rows, l):
    """What stands in these rows of lane l."""
    if len(rows) == 0:
        return ()
    return s[np.uintp(rows[0] + l)], *read_rows(s, rows[1:], l)


@recursive
def write_rows(s, rows, l, values):
    """Put values into these rows of lane l."""
    if len(rows) > 0:
        s[np.uintp(rows[0] + l)] = values[0]
        write_rows(s, rows[1:], l, values[1:])


@recursive
def load_each(s, rows, l):
    """What stands in these tuples of rows of lane l."""
    if len(rows) == 0:
        return ()
    return read_rows(s, rows[0], l), *load_each(s, rows[1:], l)


@recursive
def store_each(s, rows, l, values):
    """Put tuples into these tuples of rows of lane l."""
    if len(rows) > 0:
        write_rows(s, rows[0], l, values[0])
        store_each(s, rows[1:], l, values[1:])


@inner
def load_rows(s, rows, l, values):
    """Put the numbers of an array into these rows of lane l."""
    for k in range(len(rows)):
        s[rows[k] + l] = values[k]


@recursive
def minus_dot(total, c, k):
    """total - sum_i c_i k_i, from the left."""
    if len(c) == 0:
        return total
    return minus_dot(total - c[0] * k[0], c[1:], k[1:])


@recursive
def product(x, y):
    """x_i y_i."""
    if len(x) == 0:
        return ()
    return x[0] * y[0], *product(x[1:], y[1:])


@recursive
def dot_each(rows, k):
    """The product of a matrix, a tuple of rows, with k."""
    if len(rows) == 0:
        return ()
    return dot(rows[0], k), *dot_each(rows[1:], k)


@recursive
def of_each(rows, i):
    """The i-th number of each of some tuples."""
    if len(rows) == 0:
        return ()
    return rows[0][i], *of_each(rows[1:], i)


@recursive
def write(out, start, values):
    """Put the numbers of a tuple into an array, from an index on."""
    if len(values) > 0:
        out[start] = values[0]
        write(out, start + 1, values[1:])
