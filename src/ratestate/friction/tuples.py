"""Arithmetic on tuples of numbers of any kind (functions.py), of any length."""

import functools
import operator

from .functions import larger, where


def total(terms):
    """The sum, from the left; 0 of none."""
    terms = tuple(terms)
    return functools.reduce(operator.add, terms) if terms else 0.0


def plus(x, y):
    """x_i + y_i."""
    return tuple(x_i + y_i for x_i, y_i in zip(x, y, strict=True))


def times(a, k):
    """a k_i."""
    return tuple(a * k_i for k_i in k)


def product(x, y):
    """x_i y_i, as many as the shorter one has."""
    return tuple(x_i * y_i for x_i, y_i in zip(x, y, strict=False))


def dot(c, k):
    """sum_i c_i k_i, summed from the left."""
    return total(product(c, k))


def dot_onto(start, c, k):
    """start + sum_i c_i k_i, summed from the left."""
    return total((start, *product(c, k)))


def minus_dot(start, c, k):
    """start - sum_i c_i k_i, from the left."""
    return functools.reduce(operator.sub, product(c, k), start)


def plus_sum(y, c, k):
    """y + sum_i c_i k_i for tuples k_i, summed from the left; of as many c, or fewer k."""
    return functools.reduce(plus, map(times, c, k), y)


def sum_of(c, k):
    """sum_i c_i k_i for one tuple k_i or more."""
    return functools.reduce(plus, map(times, c, k))


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


def largest(k):
    """max_i |k_i|; 0 of none."""
    return functools.reduce(larger, map(abs, k), 0.0)


def select(condition, x, y):
    """x where the condition is true, else y."""
    return tuple(where(condition, x_i, y_i) for x_i, y_i in zip(x, y, strict=True))
