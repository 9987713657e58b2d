"""The test whether one set of parameters serves all steps: its rate of errors."""

import numpy as np
import pytest
from scipy.stats import chi2

from ratestate.records.fitting.steps.shared import Shared, denominator

#: degrees of freedom of the noise of steps, as where it is slow in some
FEW = np.where(np.arange(10) % 3 == 0, 7.0, 60.0)


def p_values(degrees, k, number, scatter=0.0):
    """Return p-values of random experiments by F, and by chi-square.

    degrees : degrees of freedom with which the noise of each step is known.  Estimates have errors
        of 1, and the variances of the estimates are known with these degrees of freedom.

    Chi-square uses the mean inflation of all steps.
    """
    rng = np.random.default_rng(2)
    n = len(degrees)
    estimated = rng.chisquare(degrees, (number, n)) / degrees
    points = np.sqrt(1.0 + scatter**2) * rng.normal(size=(number, n, k))
    factors, spreads = degrees / (degrees - 2.0), 2.0 / (degrees - 4.0)

    def deviance(weights):
        parts = weights / weights.sum(axis=1, keepdims=True)
        means = np.einsum("en,enk->ek", parts, points)
        squares = np.sum((points - means[:, None]) ** 2, axis=2)
        return np.sum(weights * squares, axis=1), parts

    free, (larger, parts) = k * (n - 1), deviance(1.0 / (estimated * factors))
    by_f = [
        Shared((), np.empty(0), np.empty(0), one, free, denominator(k, part, spreads)).p_value
        for one, part in zip(larger, parts, strict=True)
    ]
    return np.array(by_f), chi2.sf(deviance(1.0 / estimated)[0] / factors.mean(), free)


@pytest.mark.parametrize("k", [1, 3])
def test_significance_level_if_some_noise_is_uncertain(k):
    """With the mean inflation of all steps, 2 of 100 p-values are below 0.01."""
    by_f, by_mean = p_values(FEW, k, 20_000)
    assert 0.004 < np.mean(by_f < 0.01) < 0.011
    assert 0.03 < np.mean(by_f < 0.05) < 0.055
    assert 0.15 < np.mean(by_f < 0.2) < 0.22
    assert np.mean(by_mean < 0.01) > 0.015


def test_with_known_noise_the_test_is_chi_square():
    degrees = np.full(5, 1e9)
    by_f, by_chi2 = p_values(degrees, 2, 200)
    np.testing.assert_allclose(by_f, by_chi2, rtol=1e-5)
    assert denominator(2, np.full(5, 0.2), np.zeros(5)) > 1e9


def test_a_scatter_between_steps_is_found():
    assert np.mean(p_values(FEW, 3, 1000, scatter=1.5)[0] < 0.05) > 0.9
