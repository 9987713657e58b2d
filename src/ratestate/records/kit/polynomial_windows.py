"""Polynomials in windows of a record, as far as its noise can show that friction follows them.

A window grows until two more orders of the polynomial would fit significantly better; the next
smaller one is taken.  Where the orders of the test are higher than those that are then used the
estimate is biased; so that it is not, the polynomial used is the larger one (robust bias
correction: Calonico, Cattaneo & Farrell 2018 doi:10.1080/01621459.2017.1285776).
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from .regression import fall_of_chi2, generalized_least_squares

#: chi-square of two more coefficients that 1 in 1000 windows exceed by chance; and 1 in 10,000, for
#: the smallest window, without which there is no answer
SIGNIFICANT, CERTAIN = 13.82, 18.42
#: a window over the next smaller one
GROWTH = 1.4
#: a maximum is within this part of a window about its middle; points at which it is sought
INSIDE, POINTS = 0.9, 801


class Polynomial(NamedTuple):
    """A polynomial in an abscissa, from ``low`` to ``high``, fitted to rows of a record."""

    low: float
    high: float
    coefficients: np.ndarray  # (order + 1,) of Legendre polynomials
    covariance: np.ndarray

    def basis(self, x, derivative=0):
        """(n, order + 1) Legendre polynomials at x (n,), or their derivatives by it."""
        return basis(x, self.low, self.high, self.coefficients.size - 1, derivative)

    def at(self, x):
        """Value at a number x, and its standard error."""
        row = self.basis(x)[0]
        return float(row @ self.coefficients), float(np.sqrt(row @ self.covariance @ row))

    def derivative(self, x, order):
        """Derivative of this order at a number x."""
        return float(self.basis(x, order)[0] @ self.coefficients)

    @property
    def maximum(self):
        """Abscissa of the maximum; None if that is at an end of the window, or if there is none."""
        edge = 0.5 * (1.0 - INSIDE) * (self.high - self.low)
        x = np.linspace(self.low, self.high, POINTS)
        at = x[int(np.argmax(self.basis(x) @ self.coefficients))]
        if not self.low + edge < at < self.high - edge:
            return None
        # (one step of Newton's method is enough: the points are so close)
        slope, curvature = (self.derivative(at, k) for k in (1, 2))
        return float(at - slope / curvature) if curvature < 0.0 else None


def basis(x, low, high, order, derivative=0):
    """(n, order + 1) Legendre polynomials at x (n,), -1 at low and 1 at high, or derivatives."""
    scale = 2.0 / (high - low)
    u = (np.atleast_1d(x) - low) * scale - 1.0
    if not derivative:
        return legendre.legvander(u, order)
    coefficients = legendre.legder(np.eye(order + 1), derivative)
    return legendre.legval(u, coefficients).T * scale**derivative


def fitted_polynomial(t, x, y, rows, order, noise):
    """The `Polynomial` in x fitted to these rows of y, by generalized least squares.

    t, x, y : (n,) of a record with this `Noise` along t
    """
    low, high = float(x[rows[0]]), float(x[rows[-1]])
    fit = generalized_least_squares(t[rows], y[rows], basis(x[rows], low, high, order), noise)
    return Polynomial(low, high, fit.coefficients, fit.covariance)


def fewest_samples(order):
    """Fewest samples of a window with a polynomial of this order: `curvature` is of two more."""
    return order + 3


def window_sizes(fewest, most):
    """Numbers of samples of growing windows; the last one is `most`."""
    size = float(fewest)
    while size < most:
        yield int(size)
        size *= GROWTH
    yield most


def curvature(t, x, y, rows, order, noise):
    """Fall of chi-square by a polynomial of order + 2 in x in place of one of this order."""
    columns = basis(x[rows], x[rows[0]], x[rows[-1]], order + 2)
    return fall_of_chi2(t[rows], y[rows], columns, 2, noise)
