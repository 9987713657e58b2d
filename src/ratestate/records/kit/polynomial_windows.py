"""Fit polynomials in the largest windows of a record in which they fit.

A window grows until two more orders of the polynomial would fit significantly better, and the next
smaller window is used.  An estimate with the tested order would be biased by the terms that the
test cannot detect.  So the polynomial that is used has a higher order (robust bias correction:
Calonico, Cattaneo & Farrell 2018 doi:10.1080/01621459.2017.1285776).
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import Legendre
from numpy.polynomial.legendre import legvander

from .regression import fall_of_chi2, generalized_least_squares

#: fall of chi-square by two more coefficients that 1 of 1000 windows exceeds by chance; and 1 of
#: 10,000, for the smallest window, which is indispensable
SIGNIFICANT, CERTAIN = 13.82, 18.42
#: ratio of a window to the next smaller one
GROWTH = 1.4
#: central fraction of a window in which a maximum must lie
INSIDE = 0.9


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
    fit = generalized_least_squares(t[rows], y[rows], basis(x[rows], *ends, order), noise)
    return Polynomial(Legendre(fit.coefficients, ends), fit.covariance)


def fewest_samples(order):
    """Return the fewest samples of a window for `curvature`, which fits two more orders."""
    return order + 3


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
    """Return the fall of chi-square if two orders are added to a polynomial in x."""
    columns = basis(x[rows], x[rows[0]], x[rows[-1]], order + 2)
    return fall_of_chi2(t[rows], y[rows], columns, 2, noise)
