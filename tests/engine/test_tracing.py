"""Functions that compiled code gets by running them once as Python."""

import math
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba import njit

from ratestate.engine import tuples, waveform
from ratestate.engine.tracing import traced

X, Y = (0.3, -1.7, 2.9), (-0.4, 5.1, 0.7)


class Pair(NamedTuple):
    first: float
    rest: tuple


@traced
def mixed(pair, k):
    """All operations, of numbers and with constants, on either side; and a tuple with a name."""
    x = 2.0 + pair.first * 3.0 - 1.0 / (pair.rest[0] / 4.0)
    y = -(5.0 - abs(k[1])) + k[0] / 2.0
    return Pair(x, (y - 1.0, 7.0)), ()


@njit
def compiled(pair, k):
    return mixed(pair, k)


@njit
def of_tuples(x, y):
    rows = (x, y)
    return (
        (tuples.dot(x, y), tuples.minus_dot(0.5, x, y), tuples.dot_onto(0.5, x, y)),
        (tuples.total(x), tuples.sum_of_sizes(x), tuples.size_of(x, y), tuples.largest(x)),
        (tuples.plus(x, 0.3, y), tuples.times(0.3, x), tuples.product(x, y), tuples.zeros(x)),
        (tuples.plus_sum(x, y, (x, y, x)), tuples.sum_of(y, (x, y, x))),
        (tuples.dot_each(rows, x), tuples.product_each(rows, x), tuples.pairwise_sums(rows)),
        tuples.grouped((*x, *y), x),
    )


def test_compiled_code_does_what_python_does():
    pair = Pair(0.25, (0.5, 9.0))
    found, none = compiled(pair, (3.0, -8.0))
    assert found == mixed(pair, (3.0, -8.0))[0] == Pair(2.75 - 8.0, (3.0 + 1.5 - 1.0, 7.0))
    assert type(found) is Pair
    assert none == ()


def test_arithmetic_on_tuples():
    x, y = np.array(X), np.array(Y)
    many = of_tuples(X, Y)
    exact = (
        (x @ y, 0.5 - x @ y, 0.5 + x @ y),
        (x.sum(), abs(x).sum(), abs(x * y).sum(), abs(x).max()),
        (x + 0.3 * y, 0.3 * x, x * y, 0 * x),
        (x + y[0] * x + y[1] * y + y[2] * x, y[0] * x + y[1] * y + y[2] * x),
        (np.array([x @ x, y @ x]), np.array([x * x, y * x]), np.array([x.sum(), y.sum()])),
        np.array([x, y]),
    )
    for found, expected in zip(many[:-1], exact[:-1], strict=True):
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-15)
    np.testing.assert_array_equal(many[-1], exact[-1])
    assert of_tuples.py_func(X, Y)[-1] == many[-1]


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="the compiler is off")
@pytest.mark.parametrize(
    "condition", [lambda x: x if x > 0.0 else -x, lambda x: max(x, 0.0), lambda x: x == 1.0]
)
def test_a_condition_is_refused(condition):
    """It would be taken once, for all numbers."""
    function = traced(lambda x: condition(x))
    with pytest.raises(Exception, match="a condition on a number of code that is only being"):
        njit(lambda x: function(x))(1.0)


@njit
def means(c, start, h):
    return waveform.means(c, start, h)


@pytest.mark.parametrize("terms", [5, 13])
@pytest.mark.parametrize(("start", "h"), [(0.1, 0.02), (3.7, 0.15)])
def test_means_of_a_waveform(terms, start, h):
    """Against a sum over 2,000 parts of the step."""
    c = tuple(np.random.default_rng(terms).normal(size=terms) / np.arange(1, terms + 1) ** 2)
    s = (np.arange(2000) + 0.5) / 2000
    x, phase = np.polynomial.polynomial.polyval(s, c), 2 * math.pi * (start + h * s)
    exact = [one.mean() for one in (x, x * x, x * np.cos(phase), x * np.sin(phase))]
    near = 2e-3 if terms == 5 else 1e-6
    np.testing.assert_allclose(means(c, start, h), exact, atol=near)
    np.testing.assert_allclose(means(c, start, h)[0], exact[0], atol=1e-6)
