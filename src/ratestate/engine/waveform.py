"""The waveform of a return: how long it is slow, and Fourier integrals of its stress.

Steps are summed in loops over lanes, by Gauss-Legendre quadrature of their dense output.
"""

import functools

import numpy as np

from ..friction.functions import cosine, sine, where
from ..friction.tuples import plus, select, times
from . import rows as R
from .rows import read_rows, rows_of, write_rows

# V/V_lp below which a part of the cycle is slow (`slow_fraction` of `limit_cycle`).
SLOW_BELOW = 0.1
# Coefficients of a polynomial for each node: of a step of Rodas5P three.
TERMS_OF_NODE = 2

# Rows: of what is summed, and of the step.
SUMS = R.SLOW, R.MEAN, R.SQUARE, R.COSINE, R.SINE
STEP = R.OK, R.H_USED, R.GUESS, R.T, R.T_LOW, R.SLOW_PART


def find_slow(s, l, law):
    """Set SLOW_PART as the step ends, and CALL where that changes; before it is committed."""
    slow, slow_before = s[R.W_NEW + l] < SLOW_BELOW, s[R.W + l] < SLOW_BELOW
    s[R.SLOW_PART + l] = where(slow, 1.0, 0.0)
    changes = (slow ^ slow_before) & (s[R.GUESS + l] > 0.0) & (s[R.OK + l] > 0.0)
    s[R.CALL + l] = where(changes, 1.0, s[R.CALL + l])


def add_rodas5p(s, l, law):
    """Add the step of Rodas5P that has been committed, if it was, to the sums."""
    _add(s, l, rows_of(law).c[0][: R.OF_RODAS5P])


def add_taylor(s, l, law):
    """The same of a step of the Taylor method."""
    _add(s, l, rows_of(law).c[0])


def _add(s, l, rows):
    sums, c = read_rows(s, SUMS, l), read_rows(s, rows, l)
    accepted, h, period, t, t_low, slow = read_rows(s, STEP, l)
    more = plus(sums, times(h, (slow, *means(c, (t + (t_low - h)) / period, h / period))))
    write_rows(s, SUMS, l, select((accepted > 0.0) & (period > 0.0), more, sums))


@functools.cache
def gauss_legendre(n):
    """Nodes on 0..1, and their weights: n pairs."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    return tuple(zip((0.5 + 0.5 * nodes).tolist(), (0.5 * weights).tolist(), strict=True))


def means(c, start, h):
    """Means over a step of a polynomial x, of x^2, and of x cos and x sin of a phase.

    start, h : the phase as the step begins, and how much it grows, in periods
    """
    sums = [0.0] * 4
    for node, weight in gauss_legendre(len(c) // TERMS_OF_NODE + 1):
        x = c[-1]
        for one in c[-2::-1]:
            x = one + node * x
        phase, weighted = start + node * h, weight * x
        terms = weighted, weighted * x, weighted * cosine(phase), weighted * sine(phase)
        sums = [one + term for one, term in zip(sums, terms, strict=True)]
    return tuple(sums)
