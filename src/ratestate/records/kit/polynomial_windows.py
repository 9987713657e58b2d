"""Windows of a record in which friction is a polynomial, as far as its noise can show.

A window grows until two more orders of the polynomial would fit significantly better; the next
smaller one is taken.  Where the orders of the test are higher than those that are then used the
estimate is biased; so that it is not, the polynomial used is the larger one (robust bias
correction: Calonico, Cattaneo & Farrell 2018 doi:10.1080/01621459.2017.1285776).
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from .regression import generalized_least_squares

#: chi-square of two more coefficients that 1 in 1000 windows exceed by chance; and 1 in 10,000, for
#: the smallest window, without which there is no answer
SIGNIFICANT, CERTAIN = 13.82, 18.42
#: a window over the next smaller one
GROWTH = 1.4


class Window(NamedTuple):
    """Rows of a record, and a polynomial of an order in an abscissa."""

    rows: np.ndarray
    low: float  # of the abscissa, where u = -1
    high: float
    order: int

    def basis(self, x, derivative=0):
        """(n, order + 1) Legendre polynomials at x, or their derivatives by it."""
        scale = 2.0 / (self.high - self.low)
        u = (np.atleast_1d(x) - self.low) * scale - 1.0
        coefficients = legendre.legder(np.eye(self.order + 1), derivative) if derivative else None
        if coefficients is None:
            return legendre.legvander(u, self.order)
        return legendre.legval(u, coefficients).T * scale**derivative


def window_of(x, rows, order):
    """The `Window` of these rows of an abscissa x."""
    return Window(rows, float(x[rows[0]]), float(x[rows[-1]]), order)


def fewest_samples(order):
    """Fewest samples of a window with a polynomial of this order: `curvature` is of two more."""
    return order + 3


def curvature(t, x, y, rows, order, noise):
    """Fall of chi-square by a polynomial of order + 2 in x in place of one of this order."""
    basis = window_of(x, rows, order + 2).basis(x[rows])
    small, large = (
        generalized_least_squares(t[rows], y[rows], basis[:, :columns], noise).chi2
        for columns in (order + 1, order + 3)
    )
    return small - large


def largest_straight(t, x, y, windows, order, noise):
    """The largest of windows (arrays of rows, growing) none of which before it is curved.

    None if the first one is.
    """
    best = None
    for rows in windows:
        if curvature(t, x, y, rows, order, noise) > SIGNIFICANT:
            break
        best = rows
    return best
