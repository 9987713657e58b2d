"""Arithmetic on tuples, and means of polynomials over a step."""

import math

import numpy as np
import pytest

from ratestate.engine import waveform
from ratestate.friction import tuples

X, Y = (0.3, -1.7, 2.9), (-0.4, 5.1, 0.7)


def test_arithmetic_on_tuples():
    x, y = np.array(X), np.array(Y)
    pairs = [
        (tuples.dot(X, Y), x @ y),
        (tuples.dot_onto(0.5, X, Y), 0.5 + x @ y),
        (tuples.minus_dot(0.5, X, Y), 0.5 - x @ y),
        (tuples.total(X), x.sum()),
        (tuples.pairwise_sum(X), x.sum()),
        (tuples.size_of(X, Y), abs(x * y).sum()),
        (tuples.largest(X), abs(x).max()),
        (tuples.plus(X, Y), x + y),
        (tuples.times(0.3, X), 0.3 * x),
        (tuples.product(X, Y), x * y),
        (tuples.plus_sum(X, Y, (X, Y, X)), x + y[0] * x + y[1] * y + y[2] * x),
        (tuples.sum_of(Y, (X, Y, X)), y[0] * x + y[1] * y + y[2] * x),
        (tuples.grouped((*X, *Y), X), [x, y]),
    ]
    for found, expected in pairs:
        np.testing.assert_allclose(found, expected, rtol=1e-15)


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
