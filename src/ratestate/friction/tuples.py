"""Arithmetic on tuples of numbers of any kind (functions.py), of any length."""

import functools
import operator

from .functions import larger, where


def _sum(terms):
    """From the left; 0 of none."""
    terms = tuple(terms)
    return functools.reduce(operator.add, terms) if terms else 0.0


def zeros(like):
    """As many zeros as a tuple has elements."""
    return (0.0,) * len(like)


def plus(y, a, k):
    """y + a k."""
    return tuple(y_i + a * k_i for y_i, k_i in zip(y, k, strict=True))


def added(x, y):
    """x_i + y_i."""
    return tuple(x_i + y_i for x_i, y_i in zip(x, y, strict=True))


def times(a, k):
    """a k."""
    return tuple(a * k_i for k_i in k)


def product(x, y):
    """x_i y_i, as many as the shorter one has."""
    return tuple(x_i * y_i for x_i, y_i in zip(x, y, strict=False))


def product_each(rows, k):
    """The `product` of each of some tuples with k."""
    return tuple(product(row, k) for row in rows)


def dot(c, k):
    """sum_i c_i k_i, summed from the left."""
    return _sum(product(c, k))


def dot_onto(total, c, k):
    """total + sum_i c_i k_i, summed from the left."""
    return _sum((total, *product(c, k)))


def minus_dot(total, c, k):
    """total - sum_i c_i k_i, from the left."""
    return functools.reduce(operator.sub, product(c, k), total)


def dot_each(rows, k):
    """The product of a matrix, a tuple of rows, with k."""
    return tuple(dot(row, k) for row in rows)


def total(k):
    """sum_i k_i, from the left."""
    return _sum(k)


def sum_of_sizes(k):
    """sum_i |k_i|."""
    return _sum(map(abs, k))


def size_of(c, k):
    """sum_i |c_i k_i|."""
    return sum_of_sizes(product(c, k))


def plus_sum(y, c, k):
    """y + sum_i c_i k_i for tuples k_i, summed from the left; of as many c, or fewer k."""
    return functools.reduce(lambda y, one: plus(y, *one), zip(c, k, strict=False), y)


def sum_of(c, k):
    """sum_i c_i k_i for one tuple k_i or more."""
    return plus_sum(times(c[0], k[0]), c[1:], k[1:])


def grouped(values, like):
    """Numbers in tuples as long as another."""
    n = len(like)
    return tuple(values[k : k + n] for k in range(0, len(values), n))


def pairwise_sum(k):
    """sum_i k_i of pairs, and pairs of pairs, added to the first number last."""
    terms = k[1:]
    while len(terms) > 1:
        pairs = [a + b for a, b in zip(terms[::2], terms[1::2], strict=False)]
        terms = (*pairs, *terms[2 * len(pairs) :])
    return k[0] + terms[0]


def pairwise_sums(rows):
    """The `pairwise_sum` of each of some tuples."""
    return tuple(map(pairwise_sum, rows))


def largest(k):
    """max_i |k_i|; 0 of none."""
    return functools.reduce(larger, map(abs, k), 0.0)


def of_each(rows, i):
    """The i-th number of each of some tuples."""
    return tuple(row[i] for row in rows)


def select(condition, x, y):
    """x where the condition is true, else y."""
    return tuple(where(condition, x_i, y_i) for x_i, y_i in zip(x, y, strict=True))
