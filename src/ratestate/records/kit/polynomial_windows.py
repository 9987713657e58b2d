"""Polynomials in windows of a record, as far as its noise can show that friction follows them.

A window grows until two more orders of the polynomial would fit significantly better; the next
smaller one is taken.  Where the orders of the test are higher than those that are then used the
estimate is biased; so that it is not, the polynomial used is the larger one (robust bias
correction: Calonico, Cattaneo & Farrell 2018 doi:10.1080/01621459.2017.1285776).
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import Legendre
from numpy.polynomial.legendre import legvander

from .regression import fall_of_chi2, generalized_least_squares

#: chi-square of two more coefficients that 1 in 1000 windows exceed by chance; and 1 in 10,000, for
#: the smallest window, without which there is no answer
SIGNIFICANT, CERTAIN = 13.82, 18.42
#: a window over the next smaller one
GROWTH = 1.4
#: a maximum is within this part of a window about its middle
INSIDE = 0.9


class Polynomial(NamedTuple):
    """A polynomial fitted to rows of a record, with the covariance of its coefficients."""

    curve: Legendre
    covariance: np.ndarray

    def at(self, x):
        """Value at a number x, and its standard error."""
        low, high = self.curve.domain
        row = basis(x, low, high, self.curve.degree())[0]
        return float(self.curve(x)), float(np.sqrt(row @ self.covariance @ row))

    @property
    def peak(self):
        """Abscissa of the maximum, its value and standard error; None if it is at an end.

        Noise moves the maximum of a fit up on average, by half the variance of the slope divided by
        the curvature.  The value is without that.
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
    """(n, order + 1) Legendre polynomials at x (n,), which are -1 or 1 at low and 1 at high."""
    return legvander((np.atleast_1d(x) - low) * (2.0 / (high - low)) - 1.0, order)


def fitted_polynomial(t, x, y, rows, order, noise):
    """The `Polynomial` in x fitted to these rows of y, by generalized least squares.

    t, x, y : (n,) of a record with this `Noise` along t
    """
    ends = float(x[rows[0]]), float(x[rows[-1]])
    fit = generalized_least_squares(t[rows], y[rows], basis(x[rows], *ends, order), noise)
    return Polynomial(Legendre(fit.coefficients, ends), fit.covariance)


def fewest_samples(order):
    """Fewest samples of a window with a polynomial of this order: `curvature` is of two more."""
    return order + 3


def windows_that_pass(fewest, most, passes, failures):
    """Numbers of samples of growing windows that pass, until so many in turn do not.

    passes : function of a number of samples, and of those that have passed so far
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
    """Fall of chi-square by a polynomial of order + 2 in x in place of one of this order."""
    columns = basis(x[rows], x[rows[0]], x[rows[-1]], order + 2)
    return fall_of_chi2(t[rows], y[rows], columns, 2, noise)
