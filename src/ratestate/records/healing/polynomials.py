"""Polynomials in windows of a record.

A window grows until two more orders of a polynomial would fit significantly better, and the next
smaller window is used.  An estimate with the tested order would be biased by the terms that the
test cannot detect.  So the polynomial that is used has a higher order (robust bias correction:
Calonico, Cattaneo & Farrell 2018 doi:10.1080/01621459.2017.1285776).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Legendre
from numpy.polynomial.legendre import legvander

from ..kit.regression import fall_of_chi2, generalized_least_squares

#: orders that are added in a test; fall of chi-square that 1 of 1000 windows exceeds by chance
ADDED, SIGNIFICANT = 2, 13.82
#: ratio of a window to the next smaller one; successive windows that must fail, because noise may
#: make a single one fail
GROWTH, FAILED = 1.4, 2
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


def windows_that_pass(fewest, most, passes):
    """Return the sizes of growing windows that pass, until `FAILED` of them fail in succession."""
    passed: list[int] = []
    size, failed = float(fewest), 0
    while failed < FAILED and size < GROWTH * most:
        rows = min(int(size), most)
        failed = 0 if passes(rows) else failed + 1
        passed += [] if failed else [rows]
        size *= GROWTH
    return passed


def largest_fits(columns, window, most, tested, used, noise):
    """Fit a `Polynomial` to the largest window that it describes, and to the window before.

    columns : t, x and y (n,) of a record with this `Noise` along t; y is a polynomial in x
    window : function of a number of samples, at most `most`, that returns the rows of a window
    tested, used : orders

    Return the polynomials (list, the largest window first), and the factor by which the noise was
    enlarged.  If even the smallest window is too large, its misfit enlarges the noise.
    """
    t, x, y = columns

    def legendre(rows, order):
        return basis(x[rows], x[rows[0]], x[rows[-1]], order)

    def misfit(size, order):
        rows = window(size)
        return fall_of_chi2(t[rows], y[rows], legendre(rows, order + ADDED), ADDED, noise)

    fewest, factor = used + ADDED + 1, 1.0
    sizes = windows_that_pass(
        fewest, most, lambda size: size == fewest or misfit(size, tested) <= SIGNIFICANT
    )
    if len(sizes) == 1:
        factor = max(math.sqrt(misfit(fewest, used) / ADDED), 1.0)
    fits = []
    for rows in map(window, sizes[:-3:-1]):
        fit = generalized_least_squares(t[rows], y[rows], legendre(rows, used), noise.times(factor))
        fits.append(Polynomial(Legendre(fit[0], x[rows[[0, -1]]]), fit[1]))
    return fits, factor
