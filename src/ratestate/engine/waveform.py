"""The waveform of a return: how long it is slow, and Fourier integrals of its stress.

Steps are summed in loops over lanes, by Gauss-Legendre quadrature of their dense output.
"""

import functools

import numpy as np

from . import rows as R
from .extremes import crossing
from .functions import cosine_of_periods
from .jit import inlined, inner, lanewise
from .rows import OF_RODAS5P, rows_of
from .tracing import traced
from .tuples import plus, read_rows, select, write_rows

# V/V_lp below which a part of the cycle is slow (`slow_fraction` of `limit_cycle`), and its ln.
SLOW_BELOW, LOG_SLOW_BELOW = 0.1, -2.302585092994046
# Coefficients of a polynomial for each node: of a step of Rodas5P three.
TERMS_OF_NODE = 2

# Rows: of what is summed, and of the step.
SUMS = R.SLOW, R.MEAN, R.SQUARE, R.COSINE, R.SINE
STEP = R.OK, R.H_USED, R.GUESS, R.T, R.T_LOW, R.SLOW_PART


@inlined
def find_slow(s, l):
    """Set SLOW_PART as the step ends, and CALL where that changes; before it is committed."""
    slow, slow_before = s[R.W_NEW + l] < SLOW_BELOW, s[R.W + l] < SLOW_BELOW
    s[R.SLOW_PART + l] = 1.0 if slow else 0.0
    changes = (slow != slow_before) & (s[R.GUESS + l] > 0.0) & (s[R.OK + l] > 0.0)
    s[R.CALL + l] = 1.0 if changes else s[R.CALL + l]


@inner
def split(s, l, law):
    """Set SLOW_PART, where it is wanted, if the step crosses the speed that is slow."""
    slow = s[R.W_NEW + l] < SLOW_BELOW
    if s[R.GUESS + l] > 0.0 and slow != (s[R.W + l] < SLOW_BELOW):
        at = crossing(s, l, law, (SLOW_BELOW, 0.0, LOG_SLOW_BELOW), 0.0, 1.0)
        s[R.SLOW_PART + l] = 1.0 - at if slow else at


@inlined
def add_step(s, l, rows):
    """Add the step that has been committed, if it was, to the sums.

    rows : of the coefficients of x
    """
    sums, c = read_rows(s, SUMS, l), read_rows(s, rows, l)
    accepted, h, period, t, t_low, slow = read_rows(s, STEP, l)
    more = plus(sums, h, (slow, *means(c, (t + (t_low - h)) / period, h / period)))
    write_rows(s, SUMS, l, select(accepted > 0.0, more, sums))


@functools.cache
def gauss_legendre(n):
    """Nodes on 0..1, and their weights: n pairs."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    return tuple(zip((0.5 + 0.5 * nodes).tolist(), (0.5 * weights).tolist(), strict=True))


@traced
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
        cosine, sine = cosine_of_periods(phase), cosine_of_periods(phase - 0.25)
        terms = weighted, weighted * x, weighted * cosine, weighted * sine
        sums = [one + term for one, term in zip(sums, terms, strict=True)]
    return tuple(sums)


@lanewise
def find_slow_lanes(s, n):
    """`find_slow` in the first n vectors of lanes."""
    for l in range(R.WIDTH * n):
        find_slow(s, l)


@lanewise
def add_rodas5p(s, law, n):
    """`add_step` of Rodas5P in the first n vectors of lanes."""
    for l in range(R.WIDTH * n):
        add_step(s, l, rows_of(law).c[0][:OF_RODAS5P])


@lanewise
def add_taylor(s, law, n):
    """`add_step` of the Taylor method in the first n vectors of lanes."""
    for l in range(R.WIDTH * n):
        add_step(s, l, rows_of(law).c[0])
