"""Sums and products of tuples of numbers, arrays or expressions."""

import functools
import operator

from .functions import larger, where


def total(terms):
    """Return the sum, from the left; 0 of an empty tuple."""
    terms = tuple(terms)
    return functools.reduce(operator.add, terms) if terms else 0.0


def plus(x, y):
    return tuple(x_i + y_i for x_i, y_i in zip(x, y, strict=True))


def times(a, k):
    """Return a k_i."""
    return tuple(a * k_i for k_i in k)


def product(x, y):
    """Return x_i y_i, up to the length of the shorter tuple."""
    return tuple(x_i * y_i for x_i, y_i in zip(x, y, strict=False))


def dot(c, k):
    """Return sum_i c_i k_i, summed from the left."""
    return total(product(c, k))


def dot_onto(start, c, k):
    """Return start + sum_i c_i k_i, summed from the left."""
    return total((start, *product(c, k)))


def minus_dot(start, c, k):
    """Return start - sum_i c_i k_i, from the left."""
    return functools.reduce(operator.sub, product(c, k), start)


def plus_sum(y, c, k):
    """Return y + sum_i c_i k_i, from the left; the shorter of c and k is used up."""
    return functools.reduce(plus, map(times, c, k), y)


def sum_of(c, k):
    """Return sum_i c_i k_i for one tuple k_i or more."""
    return functools.reduce(plus, map(times, c, k))


def grouped(values, like):
    """Split numbers into tuples of the length of `like`."""
    n = len(like)
    return tuple(values[k : k + n] for k in range(0, len(values), n))


def pairwise_sum(k):
    """Return sum_i k_i, by pairs, pairs of pairs and so on, the first number last."""
    terms = k[1:]
    while len(terms) > 1:
        pairs = [a + b for a, b in zip(terms[::2], terms[1::2], strict=False)]
        terms = (*pairs, *terms[2 * len(pairs) :])
    return k[0] + terms[0]


def largest(k):
    """Return max_i |k_i|; 0 of an empty tuple."""
    return functools.reduce(larger, map(abs, k), 0.0)


def select(condition, x, y):
    return tuple(where(condition, x_i, y_i) for x_i, y_i in zip(x, y, strict=True))
