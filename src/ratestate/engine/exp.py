"""An exponential that a plain loop over lanes can vectorise.

`math.exp` is a call into the C library: one number at a time.  This one is branch-free
arithmetic (range reduction, a polynomial, the exponent bits), so LLVM turns it into SIMD code.
It is accurate to about 1 unit in the last place between -708 and 709 and saturates outside,
where e**x has left the range of normal doubles.  NaN stays NaN.
"""

import numpy as np
from numba import njit

LOG2_E = 1.4426950408889634
# ln 2 in two parts: n*LN2_HIGH is exact for every exponent n that a double can have.
LN2_HIGH = 6.93147180369123816490e-01
LN2_LOW = 1.90821492927058770002e-10
# Adding 1.5*2**52 rounds to an integer and leaves that integer in the low bits of the sum.
ROUND = 6755399441055744.0


@njit(forceinline=True, fastmath={"contract"})
def exp(x):
    """e**x for -708 <= x <= 709, saturating outside."""
    x = -708.0 if x < -708.0 else x
    x = 709.0 if x > 709.0 else x
    shifted = x * LOG2_E + ROUND
    n = shifted - ROUND
    r = (x - n * LN2_HIGH) - n * LN2_LOW
    # Taylor to r**13; |r| <= ln(2)/2 leaves a relative error of 4e-18.
    p = 1.6059043836821613e-10
    p = p * r + 2.08767569878681e-09
    p = p * r + 2.505210838544172e-08
    p = p * r + 2.755731922398589e-07
    p = p * r + 2.7557319223985893e-06
    p = p * r + 2.48015873015873e-05
    p = p * r + 0.0001984126984126984
    p = p * r + 0.001388888888888889
    p = p * r + 0.008333333333333333
    p = p * r + 0.041666666666666664
    p = p * r + 0.16666666666666666
    p = p * r + 0.5
    p = p * r + 1.0
    p = p * r + 1.0
    bits = (np.float64(shifted).view(np.int64) + np.int64(1023)) << np.int64(52)
    return p * np.int64(bits).view(np.float64)
