"""Arithmetic on tuples, and means of polynomials over a step."""

import math

import numpy as np
import pytest

from ratestate.engine import waveform
from ratestate.friction import tuples

X, Y = (0.3, -1.7, 2.9), (-0.4, 5.1, 0.7)


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


@pytest.mark.parametrize("terms", [5, 13])
@pytest.mark.parametrize(("start", "h"), [(0.1, 0.02), (3.7, 0.15)])
def test_means_of_a_waveform(terms, start, h):
    """Against a sum over 2,000 parts of the step."""
    c = tuple(np.random.default_rng(terms).normal(size=terms) / np.arange(1, terms + 1) ** 2)
    s = (np.arange(2000) + 0.5) / 2000
    x, phase = np.polynomial.polynomial.polyval(s, c), 2 * math.pi * (start + h * s)
    exact = [one.mean() for one in (x, x * x, x * np.cos(phase), x * np.sin(phase))]
    near = 2e-3 if terms == 5 else 1e-6
    np.testing.assert_allclose(waveform.means(c, start, h), exact, atol=near)
    np.testing.assert_allclose(waveform.means(c, start, h)[0], exact[0], atol=1e-6)
