"""One step of the Taylor method: its coefficients by recurrences, and the step that they allow.

The polynomial of the step is its dense output too.  The step follows from the last two coefficients
(Jorba & Zou 2005 doi:10.1080/10586458.2005.10128904), and is never rejected.
"""

import math

from ..friction.functions import exp, functions_of, larger, where
from ..friction.tuples import largest, pairwise_sum, product
from . import recurrences
from .recurrences import ORDER

#: part of the tolerance that the last terms of a step may reach
PART = 0.1
#: least size of a coefficient, where a step is at its longest
LEAST = 1e-300
LN2 = math.log(2.0)
#: integrals of the powers of s from 0 to 1
OF_INTEGRAL = tuple(1.0 / (k + 1.0) for k in range(ORDER))


def coefficients(law, y, w, e, w_lp, ramp, kappa, eta0, p):
    """`recurrences.coefficients`, as tuples of tuples."""
    found = recurrences.coefficients(law, y, w, e, w_lp, ramp, kappa, eta0, p)
    return tuple(map(_numbers, found))


def variational_coefficients(law, y, w, e, z, kappa, eta0, p):
    """`recurrences.variational_coefficients`, as tuples of tuples."""
    c, c_z, trace = recurrences.variational_coefficients(law, y, w, e, z, kappa, eta0, p)
    return _numbers(c), _numbers(c_z), _numbers([trace])[0]


def _numbers(polynomials):
    """As tuples, 0.0 for a coefficient that is always that."""
    return tuple(tuple(0.0 if c is None else c for c in one) for one in polynomials)


def longest(last, before, tolerance):
    """The step that the sizes of the last two coefficients allow, to 1 %.

    last, before : of order `ORDER`, and one less; `LEAST` at least
    """
    allowed = rough_log2(PART * tolerance)
    by_last = (allowed - rough_log2(last)) * (1.0 / ORDER)
    by_before = (allowed - rough_log2(before)) * (1.0 / (ORDER - 1))
    return exp(LN2 * where(by_last < by_before, by_last, by_before))


def rough_log2(x):
    """log2 x, less up to 0.09, of a normal x > 0: between powers of 2 its bits are linear in x."""
    return functions_of(x).rough_log2(x)


def size(y, momentum):
    """The largest size of x, v and each psi; `LEAST` at least.

    momentum : how many times larger an error of v becomes one of x, if that is more than once:
        sqrt(kappa eta0) w, the amplitude in x of a free vibration of this speed
    """
    weight = where(momentum > 1.0, momentum, 1.0)
    return larger(larger(abs(y[0]), weight * abs(y[1])), larger(largest(y[2:]), LEAST))


def powers(h):
    """h**k for k from 0 to `ORDER`."""
    found = [1.0, h]
    for k in range(2, ORDER + 1):
        found.append(found[k // 2] * found[k - k // 2])
    return tuple(found)


def integrals(c, h):
    """The integrals of polynomials over a step, over its length; h : its `powers`."""
    weights = product(OF_INTEGRAL, h)
    return tuple(pairwise_sum(product(one, weights)) for one in c)
