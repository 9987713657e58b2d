"""An exponential that a plain loop over lanes can vectorise.

`math.exp` is a call into the C library: one number at a time.  These are branch-free arithmetic
(range reduction, a polynomial, the exponent bits), so LLVM turns them into SIMD code.  They are
accurate to 3 units in the last place between -600 and 600 and saturate outside: a speed of
1e-260 V0 is rest, and the time scales that go with it still fit into a double.  NaN stays NaN.
"""

import math
from typing import Any

import numpy as np
from numba import types
from numba.extending import intrinsic, overload

from ..friction.kinematics import LIMIT
from .jit import INLINED, inlined, recursive

_overload: Any = overload  # (its declared arguments lack jit_options)
_intrinsic: Any = intrinsic

LOG2_E = 1.4426950408889634
# ln 2 in two parts: n*LN2_HIGH is exact for every exponent n that a double can have.
LN2_HIGH = 6.93147180369123816490e-01
LN2_LOW = 1.90821492927058770002e-10
# Adding 1.5*2**52 rounds to an integer and leaves that integer in the low bits of the sum.
ROUND = 6755399441055744.0


def limited(x):
    """x between -LIMIT and LIMIT; NaN stays NaN."""
    return -LIMIT if x < -LIMIT else LIMIT if x > LIMIT else x


@_intrinsic
def _limited(typing_context, x):
    """As `limited`, without a branch, at which loops over lanes would end."""

    def generate(context, builder, signature, arguments):
        (x,) = arguments
        for limit, beyond in ((-LIMIT, "<"), (LIMIT, ">")):
            bound = context.get_constant(types.float64, limit)
            x = builder.select(builder.fcmp_ordered(beyond, x, bound), bound, x)
        return x

    return types.float64(types.float64), generate


@_overload(limited, jit_options=INLINED)
def _of_compiled(x):
    return lambda x: _limited(x)


@inlined
def parts(x):
    """x = n ln 2 + r: the bits of the integer n, and e**r as even and odd part.

    The polynomial is near-minimax of degree 11 (relative error 2e-17) and summed as a tree,
    since a lane waits for the longest chain of operations, not for their number.
    """
    x = limited(x)
    shifted = x * LOG2_E + ROUND
    n = shifted - ROUND
    r = (x - n * LN2_HIGH) - n * LN2_LOW
    r2 = r * r
    r4 = r2 * r2
    e0 = 1.0 + r2 * 0.5000000000000016
    e1 = 0.04166666666651273 + r2 * 0.001388888894606599
    e2 = 2.4801491875311523e-05 + r2 * 2.763037135492319e-07
    o0 = 1.0 + r2 * 0.16666666666666394
    o1 = 0.008333333333462088 + r2 * 0.00019841269604075593
    o2 = 2.7557490329049117e-06 + r2 * 2.5031360117621017e-08
    even = e0 + r4 * (e1 + r4 * e2)
    odd = r * (o0 + r4 * (o1 + r4 * o2))
    return np.float64(shifted).view(np.int64), even, odd


@inlined
def power_of_2(n):
    """2**n, from the bits of n + ROUND or of ROUND - n."""
    return np.int64((n + np.int64(1023)) << np.int64(52)).view(np.float64)


@inlined
def exp(x):
    """e**x for -600 <= x <= 600, saturating outside."""
    n, even, odd = parts(x)
    return (even + odd) * power_of_2(n)


@inlined
def exp_alone(x):
    """e**x like `exp`, by the C library, which is faster for one number at a time."""
    return math.exp(limited(x))


@recursive
def exp_each(x):
    """`exp` of each of a tuple of numbers."""
    if len(x) == 0:
        return ()
    return exp(x[0]), *exp_each(x[1:])


@recursive
def exp_each_alone(x):
    """`exp_alone` of each of a tuple of numbers."""
    if len(x) == 0:
        return ()
    return exp_alone(x[0]), *exp_each_alone(x[1:])


@inlined
def exp_and_inverse(x):
    """e**x and e**-x for -600 <= x <= 600, saturating outside; no division."""
    n, even, odd = parts(x)
    return (even + odd) * power_of_2(n), (even - odd) * power_of_2(-n)
