"""One step of the Taylor method: its coefficients by recurrences, and the step that they allow.

The polynomial of the step is its dense output too.  The step follows from the last two coefficients
(Jorba & Zou 2005 doi:10.1080/10586458.2005.10128904), and is never rejected.
"""

import functools
import math
from typing import Any

import numpy as np
from numba.extending import overload

from .exp import ROUND, exp
from .functions import ROUND_BITS
from .jit import INLINED, inlined, recursive
from .recurrences import ORDER, source
from .tuples import largest, of_each, product, times

_overload: Any = overload  # (its declared arguments lack jit_options)

#: part of the tolerance that the last terms of a step may reach
PART = 0.1
#: least size of a coefficient, where a step is at its longest
LEAST = 1e-300
LN2 = math.log(2.0)
#: integrals of the powers of s from 0 to 1
OF_INTEGRAL = tuple(1.0 / (k + 1.0) for k in range(ORDER))


@functools.cache
def function_of(law):
    """`coefficients` under a law."""
    names: dict[str, Any] = {}
    head = "def of_law(law, y, w, e, w_lp, ramp, kappa, eta0, p):"
    exec("\n    ".join([head, *source(law)]), names)
    return names["of_law"]


def coefficients(law, y, w, e, w_lp, ramp, kappa, eta0, p):
    """Taylor coefficients in T of x, v and each psi, and of the powers of `works`: tuples.

    The latter have one term less.  Arguments as of `rodas5p.step`.
    """
    return function_of(law)(law, y, w, e, w_lp, ramp, kappa, eta0, p)


@_overload(coefficients, jit_options=INLINED)
def _coefficients(law, y, w, e, w_lp, ramp, kappa, eta0, p):
    return function_of(law.law)


@inlined
def longest(c, tolerance, momentum):
    """The step that the last two of coefficients allow, to 1 %.

    momentum : how many times larger an error of v becomes one of x, if that is more than once:
        sqrt(kappa eta0) w, the amplitude in x of a free vibration of this speed
    """
    allowed = rough_log2(PART * tolerance)
    weight = momentum if momentum > 1.0 else 1.0
    by_last = (allowed - rough_log2(largest_of(c, ORDER, weight))) * (1.0 / ORDER)
    by_before = (allowed - rough_log2(largest_of(c, ORDER - 1, weight))) * (1.0 / (ORDER - 1))
    return exp(LN2 * (by_last if by_last < by_before else by_before))


@inlined
def rough_log2(x):
    """log2 x, less up to 0.09, of a normal x > 0: between powers of 2 its bits are linear in x."""
    bits = np.int64((np.float64(x).view(np.int64) >> np.int64(12)) + ROUND_BITS)
    return (bits.view(np.float64) - ROUND) * 2.0**-40 - 1023.0


@inlined
def largest_of(c, i, weight):
    """The largest size of the i-th coefficients, that of v times a weight; `LEAST` at least."""
    return max(max(abs(c[0][i]), weight * abs(c[1][i])), max(largest(of_each(c[2:], i)), LEAST))


@recursive
def powers(known, next_one):
    """Powers of h from 0 to `ORDER`, or beyond.

    known : the first 2**n of them; next_one : h**(2**n)
    """
    if len(known) > ORDER:
        return known
    return powers((*known, *times(next_one, known)), next_one * next_one)


@recursive
def ends(c, h):
    """The values of polynomials at the end of a step, c_0 added last; h : its `powers`."""
    if len(c) == 0:
        return ()
    return c[0][0] + dot_in_two(0.0, 0.0, c[0][1:], h[1:]), *ends(c[1:], h)


@inlined
def integrals(c, h):
    """The integrals of polynomials over a step, over its length; h : its `powers`."""
    return dots(c, product(OF_INTEGRAL, h))


@recursive
def dots(c, weights):
    """The sum of each of tuples, weighed."""
    if len(c) == 0:
        return ()
    return dot_in_two(0.0, 0.0, c[0], weights), *dots(c[1:], weights)


@recursive
def dot_in_two(even, odd, c, k):
    """even + odd + sum_i c_i k_i for at least as many k as c, in two chains of half the length."""
    if len(c) == 0:
        return even + odd
    if len(c) == 1:
        return (even + c[0] * k[0]) + odd
    return dot_in_two(even + c[0] * k[0], odd + c[1] * k[1], c[2:], k[2:])
