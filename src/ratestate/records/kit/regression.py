"""Linear regression of correlated samples, of estimates with known errors, and in windows.

If estimates scatter more than their errors explain, with a probability below 0.1, the errors are
enlarged by the root of the reduced chi-square (Birge 1932 doi:10.1103/PhysRev.40.207).

A window grows until two more orders of a polynomial would fit significantly better, and the next
smaller window is used.  An estimate with the tested order would be biased by the terms that the
test cannot detect.  So the polynomial that is used has a higher order (robust bias correction:
Calonico, Cattaneo & Farrell 2018 doi:10.1080/01621459.2017.1285776).
"""

import math
from typing import NamedTuple

import numpy as np
import scipy
from numpy.polynomial import Legendre
from numpy.polynomial.legendre import legvander

#: significance level of the test that scatter exceeds the errors
CHANCE = 0.1
#: fall of chi-square by two more coefficients that 1 of 1000 windows exceeds by chance; and 1 of
#: 10,000, for the smallest window, which is indispensable
SIGNIFICANT, CERTAIN = 13.82, 18.42
#: ratio of a window to the next smaller one
GROWTH = 1.4
#: central fraction of a window in which a maximum must lie
INSIDE = 0.9


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


class Polynomial(NamedTuple):
    """A polynomial fitted to rows of a record, with the covariance of its coefficients."""

    curve: Legendre
    covariance: np.ndarray

    def at(self, x):
        """Return the value at a number x, and its standard error."""
        low, high = self.curve.domain
        row = basis(x, low, high, self.curve.degree())[0]
        return float(self.curve(x)), float(np.sqrt(row @ self.covariance @ row))

    @property
    def peak(self):
        """Return abscissa, value and standard error of the maximum; None if it is at an end.

        Noise raises the maximum of a fit on average, by half the variance of the slope divided by
        the curvature.  The value is corrected for this bias.
        """
        slope, (low, high) = self.curve.deriv(), self.curve.domain
        turns = slope.roots()
        x = np.array([low, high, *turns[(turns.imag == 0.0) & (turns.real > low)].real])
        x = x[x <= high]
        at = float(x[np.argmax(self.curve(x))])
        edge = 0.5 * (1.0 - INSIDE) * (high - low)
        if not low + edge < at < high - edge:
            return None
        parts = [Legendre.basis(j, self.curve.domain) for j in range(self.curve.coef.size)]
        row = np.array([part.deriv()(at) for part in parts])
        value, error = self.at(at)
        return at, value + float(0.5 * (row @ self.covariance @ row) / slope.deriv()(at)), error


def basis(x, low, high, order):
    """Return Legendre polynomials (n, order + 1) at x (n,) of the interval from low to high."""
    return legvander((np.atleast_1d(x) - low) * (2.0 / (high - low)) - 1.0, order)


def fitted_polynomial(t, x, y, rows, order, noise):
    """Fit a `Polynomial` in x to these rows of y, by generalized least squares.

    t, x, y : (n,) columns of a record with this `Noise` along t
    """
    ends = float(x[rows[0]]), float(x[rows[-1]])
    columns = basis(x[rows], *ends, order)
    coefficients, covariance = generalized_least_squares(t[rows], y[rows], columns, noise)
    return Polynomial(Legendre(coefficients, ends), covariance)


def windows_that_pass(fewest, most, passes, failures):
    """Return the sizes of growing windows that pass, until several fail in succession.

    passes : function of a number of samples, and of the numbers that have passed before
    """
    passed: list[int] = []
    size, failed = float(fewest), 0
    while failed < failures:
        if passes(min(int(size), most), passed):
            passed.append(min(int(size), most))
            failed = 0
        else:
            failed += 1
        if size >= most:
            break
        size *= GROWTH
    return passed


def curvature(t, x, y, rows, order, noise):
    """Return the fall of chi-square if two orders are added to a polynomial in x.

    A window needs order + 3 samples.
    """
    columns = basis(x[rows], x[rows[0]], x[rows[-1]], order + 2)
    return fall_of_chi2(t[rows], y[rows], columns, 2, noise)
