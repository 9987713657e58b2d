"""Linear regression: of correlated samples, and of estimates whose errors are known.

Where estimates scatter more than their errors explain, but for 1 of 10 by chance, these are
enlarged by the root of the reduced chi-square (Birge 1932 doi:10.1103/PhysRev.40.207).
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

#: probability of calling a scatter larger than errors explain where it is not
CHANCE = 0.1


class Linear(NamedTuple):
    """Best coefficients (k,) of some columns, their covariance (k, k), and the misfit."""

    coefficients: np.ndarray
    covariance: np.ndarray
    chi2: float


class Line(NamedTuple):
    """The best line through points: y = mean + slope (x - centre)."""

    slope: float
    slope_error: float
    centre: float  # of x, where `mean` and `slope` are uncorrelated
    mean: float
    mean_error: float
    scatter: float  # root of the reduced chi-square; NaN of as many points as a line needs

    def at(self, x):
        """The line and its standard error at these x."""
        away = np.asarray(x) - self.centre
        return self.mean + self.slope * away, np.hypot(self.mean_error, self.slope_error * away)


def generalized_least_squares(t, values, columns, noise):
    """`Linear` of values (n,) at times t (n,) by columns (n, k), with this `Noise`.

    LinAlgError where the columns depend on each other.
    """
    white, _ = noise.whiten(t, np.column_stack([values, columns]))
    q, r = np.linalg.qr(white[:, 1:])
    root = np.linalg.inv(r)
    projected = q.T @ white[:, 0]
    chi2 = float(white[:, 0] @ white[:, 0] - projected @ projected)
    return Linear(root @ projected, root @ root.T, max(chi2, 0.0))


def weighted_mean(values, errors):
    """Mean of values (n,) weighted by their errors (n,), its standard error and the scatter."""
    weights = errors**-2.0
    mean = float(np.average(values, weights=weights))
    scatter = _scatter((values - mean) / errors, 1)
    return mean, _enlarged(float(weights.sum() ** -0.5), scatter, values.size - 1), scatter


def weighted_line(x, values, errors):
    """The `Line` through values (n,) at x (n,), not all the same, weighted by their errors (n,)."""
    weights = errors**-2.0
    centre, mean = (float(np.average(each, weights=weights)) for each in (x, values))
    away = x - centre
    spread = float(weights @ away**2)
    slope = float(weights @ (away * values)) / spread
    scatter = _scatter((values - mean - slope * away) / errors, 2)
    slope_error, mean_error = (
        _enlarged(s**-0.5, scatter, x.size - 2) for s in (spread, float(weights.sum()))
    )
    return Line(slope, slope_error, centre, mean, mean_error, scatter)


def _scatter(residual, parameters):
    """Root of the reduced chi-square of residuals over their errors (n,)."""
    degrees = residual.size - parameters
    return math.sqrt(float(residual @ residual) / degrees) if degrees > 0 else math.nan


def _enlarged(error, scatter, degrees):
    """An error, enlarged where values scatter significantly more than theirs explain."""
    if degrees < 1 or chdtrc(degrees, degrees * scatter**2) > CHANCE:
        return error
    return error * scatter
