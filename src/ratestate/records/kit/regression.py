"""Linear regression of correlated samples, and of estimates with known errors.

If estimates scatter more than their errors explain, with a probability below 0.1, the errors are
enlarged by the root of the reduced chi-square (Birge 1932 doi:10.1103/PhysRev.40.207).
"""

import math
from typing import NamedTuple

import numpy as np
import scipy

#: significance level of the test that scatter exceeds the errors
CHANCE = 0.1


class Line(NamedTuple):
    """The best line through points: y = mean + slope (x - centre)."""

    slope: float
    slope_error: float
    centre: float  # x at which the errors of `mean` and `slope` are uncorrelated
    mean: float
    mean_error: float
    scatter: float  # root of the reduced chi-square; NaN for two points

    def at(self, x):
        """Return the line and its standard error at these x."""
        away = np.asarray(x) - self.centre
        return self.mean + self.slope * away, np.hypot(self.mean_error, self.slope_error * away)


def generalized_least_squares(t, values, columns, noise):
    """Fit columns (n, k) to values (n,) at times t (n,) with this `Noise`.

    Return the coefficients (k,) and their covariance (k, k).  LinAlgError if columns are linearly
    dependent.
    """
    white, _ = noise.whiten(t, np.column_stack([values, columns]))
    q, r = np.linalg.qr(white[:, 1:])
    root = np.linalg.inv(r)
    return root @ (q.T @ white[:, 0]), root @ root.T


def fall_of_chi2(t, values, columns, last, noise):
    """Return the fall of chi-square if the last columns are added to the others.

    last : number of added columns; other arguments as for `generalized_least_squares`
    """
    white, _ = noise.whiten(t, np.column_stack([values, columns]))
    q, _ = np.linalg.qr(white[:, 1:])
    return float(np.sum((q[:, -last:].T @ white[:, 0]) ** 2))


def central_differences(function, point, steps):
    """Return the derivatives (..., k) of a function at a point (k,), with steps (k,)."""
    pairs = [(function(point + h), function(point - h)) for h in np.diag(steps)]
    return np.stack([high - low for high, low in pairs], axis=-1) / (2.0 * steps)


def weighted_mean(values, errors):
    """Return the mean of values (n,) weighted by their errors (n,), its error, and chi-square.

    n > 0.  The standard error of the mean supposes that the scatter is due to the errors alone.
    """
    weights = errors**-2.0
    total = float(weights.sum())
    mean = float(weights @ values) / total
    return mean, total**-0.5, float(weights @ (values - mean) ** 2)


def mean_with_scatter(values, errors):
    """Return the weighted mean of values (n,), its standard error and the scatter."""
    (mean, error, chi2), degrees = weighted_mean(values, errors), values.size - 1
    scatter = _scatter(chi2, degrees)
    return mean, _enlarged(error, scatter, degrees), scatter


def weighted_line(x, values, errors):
    """Return the `Line` through values (n,) at x (n,), weighted by their errors (n,)."""
    centre, degrees, weights = weighted_mean(x, errors)[0], x.size - 2, 1.0 / errors
    line, covariance = np.polyfit(x - centre, values, 1, w=weights, cov="unscaled")
    rest = weights * (values - np.polyval(line, x - centre))
    scatter = _scatter(float(rest @ rest), degrees)
    slope_error, mean_error = (
        _enlarged(float(error), scatter, degrees) for error in np.sqrt(np.diag(covariance))
    )
    return Line(float(line[0]), slope_error, centre, float(line[1]), mean_error, scatter)


def _scatter(chi2, degrees):
    """Return the root of the reduced chi-square; NaN without a degree of freedom."""
    return math.sqrt(chi2 / degrees) if degrees > 0 else math.nan


def _enlarged(error, scatter, degrees):
    """Return an error, enlarged if values scatter significantly more than their errors."""
    if degrees < 1 or scipy.special.chdtrc(degrees, degrees * scatter**2) > CHANCE:
        return error
    return error * scatter
