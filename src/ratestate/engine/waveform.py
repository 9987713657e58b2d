"""The shape of one cycle: the fraction of slow sliding, and Fourier integrals of stress.

Steps are summed in loops over lanes, by Gauss-Legendre quadrature of the dense output.
"""

import functools

import numpy as np

from ..friction.functions import cosine, sine, where
from ..friction.tuples import plus, select, times
from . import rows as R
from .rows import read_rows, rows_of, write_rows

# V/V_lp below which a part of the cycle counts as slow (`slow_fraction` of `limit_cycle`).
SLOW_BELOW = 0.1
# Polynomial coefficients for each node of the quadrature: Rodas5P has three nodes.
TERMS_OF_NODE = 2

# Rows of the sums and of the step.
SUMS = R.SLOW, R.MEAN, R.SQUARE, R.COSINE, R.SINE
STEP = R.OK, R.H_USED, R.PERIOD_GUESS, R.T, R.T_LOW, R.SLOW_PART


def set_slow_part(s, l, law):
    """Set SLOW_PART from the end of the step; set CALL if V crosses the slow limit."""
    slow, slow_before = s[R.W_NEW + l] < SLOW_BELOW, s[R.W + l] < SLOW_BELOW
    s[R.SLOW_PART + l] = where(slow, 1.0, 0.0)
    changes = (slow ^ slow_before) & (s[R.PERIOD_GUESS + l] > 0.0) & (s[R.OK + l] > 0.0)
    s[R.CALL + l] = where(changes, 1.0, s[R.CALL + l])


def add_rodas5p(s, l, law):
    """Add the last step of Rodas5P to the sums, if it was accepted."""
    _add(s, l, rows_of(law).c[0][: R.RODAS5P_TERMS])


def add_taylor(s, l, law):
    """Add the last Taylor step to the sums."""
    _add(s, l, rows_of(law).c[0])


def _add(s, l, rows):
    sums, c = read_rows(s, SUMS, l), read_rows(s, rows, l)
    accepted, h, period, t, t_low, slow = read_rows(s, STEP, l)
    next_sums = plus(sums, times(h, (slow, *means(c, (t + (t_low - h)) / period, h / period))))
    write_rows(s, SUMS, l, select((accepted > 0.0) & (period > 0.0), next_sums, sums))


@functools.cache
def gauss_legendre(n):
    """Return n pairs of nodes and weights on 0..1."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    return tuple(zip((0.5 + 0.5 * nodes).tolist(), (0.5 * weights).tolist(), strict=True))


def means(c, start, h):
    """Return the means over a step of polynomial x, x^2, x cos phase and x sin phase.

    start, h : the phase at the start of the step, and its growth in the step [periods]
    """
    sums = [0.0] * 4
    for node, weight in gauss_legendre(len(c) // TERMS_OF_NODE + 1):
        x = c[-1]
        for coefficient in c[-2::-1]:
            x = coefficient + node * x
        phase, weighted = start + node * h, weight * x
        terms = weighted, weighted * x, weighted * cosine(phase), weighted * sine(phase)
        sums = [partial + term for partial, term in zip(sums, terms, strict=True)]
    return tuple(sums)
