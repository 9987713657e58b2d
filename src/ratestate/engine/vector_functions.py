"""Elementary functions of numbers of code that is being written (code.py): arithmetic alone.

`exp` is accurate to 3 units in the last place between -600 and 600 and saturates outside: a speed
of 1e-260 V_ref is rest, and the time scales that go with it still fit into a double.  NaN stays
NaN.
"""

import math
import struct

from ..friction.expressions import LIMIT
from .code import where as select

LOG2_E, SQRT2 = 1.4426950408889634, 1.4142135623730951
# ln 2 in two parts: n*LN2_HIGH is exact for every exponent n that a double can have.
LN2_HIGH, LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
LN2, LN_SQRT2 = math.log(2.0), 0.5 * math.log(2.0)
# Adding 1.5*2**52 rounds to an integer and leaves that integer in the low bits of the sum.
ROUND = 6755399441055744.0


def _bits(x):
    return struct.unpack("<q", struct.pack("<d", x))[0]


HALF_BITS, ROUND_BITS, MANTISSA = _bits(math.sqrt(0.5)), _bits(ROUND), (1 << 52) - 1
#: numbers beyond which x*x + 1 is no double
HUGE = 1e150
#: Taylor coefficients of sin(2 pi q), of odd powers of q: to 1e-17 where |q| <= 1/4
SINE = tuple(
    (-1) ** k * (2.0 * math.pi) ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(12)
)


def _parts(x):
    """x = n ln 2 + r: the bits of the integer n; cosh r - 1 and sinh r.

    The polynomials are near-minimax of degree 11 (relative error 2e-17) and summed as trees,
    since a lane waits for the longest chain of operations, not for their number.
    """
    x = select(x > LIMIT, LIMIT, select(x < -LIMIT, -LIMIT, x))
    shifted = x * LOG2_E + ROUND
    n = shifted - ROUND
    r = (x - n * LN2_HIGH) - n * LN2_LOW
    r2 = r * r
    r4 = r2 * r2
    e1 = 0.04166666666651273 + r2 * 0.001388888894606599
    e2 = 2.4801491875311523e-05 + r2 * 2.763037135492319e-07
    o0 = 1.0 + r2 * 0.16666666666666394
    o1 = 0.008333333333462088 + r2 * 0.00019841269604075593
    o2 = 2.7557490329049117e-06 + r2 * 2.5031360117621017e-08
    even = r2 * 0.5000000000000016 + r4 * (e1 + r4 * e2)
    return shifted.bits(), even, r * (o0 + r4 * (o1 + r4 * o2))


def _power_of_2(n):
    """2**n, from the bits of n + ROUND."""
    return ((n + 1023) << 52).number()


def _artanh(z):
    """artanh z for |z| <= 0.172, to 1e-16 of itself, by its series."""
    z2 = z * z
    z4 = z2 * z2
    z8 = z4 * z4
    low = (1.0 + z2 * (1.0 / 3.0)) + z4 * (1.0 / 5.0 + z2 * (1.0 / 7.0))
    middle = (1.0 / 9.0 + z2 * (1.0 / 11.0)) + z4 * (1.0 / 13.0 + z2 * (1.0 / 15.0))
    high = (1.0 / 17.0 + z2 * (1.0 / 19.0)) + z4 * (1.0 / 21.0)
    return z * (low + z8 * (middle + z8 * high))


class Vectorised:
    """The functions of `Number`s, for `evaluate`."""

    where = staticmethod(select)
    abs = staticmethod(abs)

    @staticmethod
    def sqrt(x):
        """The root of x."""
        return x.code.call("sqrt", x)

    @staticmethod
    def exp(x):
        """e**x."""
        n, even, odd = _parts(x)
        return (1.0 + even + odd) * _power_of_2(n)

    bounded_exp = exp

    @staticmethod
    def exp_and_inverse(x):
        """e**x and e**-x; no division."""
        n, even, odd = _parts(x)
        power, inverse = _power_of_2(n), _power_of_2(0 - n)
        return (1.0 + even + odd) * power, (1.0 + even - odd) * inverse

    @staticmethod
    def expm1(x):
        """e**x - 1, nearly to its last digit where x is small."""
        n, even, odd = _parts(x)
        power = _power_of_2(n)
        return (even + odd) * power + (power - 1.0)

    @staticmethod
    def log(x):
        """ln x, by x = 2**n m, sqrt(1/2) <= m < sqrt 2, from the bits of a normal x > 0."""
        bits = x.bits() - HALF_BITS
        m = ((bits & MANTISSA) + HALF_BITS).number()
        n = ((bits >> 52) + ROUND_BITS).number() - ROUND
        found = n * LN2_HIGH + (n * LN2_LOW + 2.0 * _artanh((m - 1.0) / (m + 1.0)))
        return select(x > 0.0, found, (x - x) / (x - x))

    @staticmethod
    def rough_log2(x):
        """log2 x, less up to 0.09, of a normal x > 0: between powers of 2 its bits are linear."""
        return ((((x.bits() >> 12) + ROUND_BITS).number()) - ROUND) * 2.0**-40 - 1023.0

    @staticmethod
    def cosine(x):
        """cos(2 pi x), off by some 1e-16 and by what 2 pi times the rounding of x makes."""
        q = 0.25 - abs(x - ((x + ROUND) - ROUND))
        z = q * q
        z2 = z * z
        z4 = z2 * z2
        low = (SINE[0] + z * SINE[1]) + z2 * (SINE[2] + z * SINE[3])
        middle = (SINE[4] + z * SINE[5]) + z2 * (SINE[6] + z * SINE[7])
        high = (SINE[8] + z * SINE[9]) + z2 * (SINE[10] + z * SINE[11])
        return q * (low + z4 * (middle + z4 * high))

    @staticmethod
    def log1p(x):
        """ln(1 + x); what 1 + x loses of a small x is added."""
        whole = 1.0 + x
        return Vectorised.log(whole) + (x - (whole - 1.0)) / whole

    @staticmethod
    def softplus(x):
        """ln(1 + e**x)."""
        t = Vectorised.exp(-abs(x))
        is_small = t < 0.4  # ln(1 + t) from t itself, else from its ratio to sqrt(2)
        above, below = (
            select(is_small, t, t + (1.0 - SQRT2)),
            select(is_small, t, t + (SQRT2 - 1.0)),
        )
        rest = select(is_small, 0.0, LN_SQRT2) + 2.0 * _artanh(above / (2.0 + below))
        return 0.5 * (x + abs(x)) + rest

    @staticmethod
    def logistic(x):
        """1/(1 + e**-x)."""
        return 1.0 / (1.0 + Vectorised.exp(-x))

    @staticmethod
    def sinh(x):
        """(e**x - e**-x)/2."""
        t = Vectorised.expm1(abs(x))
        size = 0.5 * (t + t / (t + 1.0))
        return select(x < 0.0, -size, size)

    @staticmethod
    def cosh(x):
        """(e**x + e**-x)/2."""
        t = Vectorised.exp(abs(x))
        return 0.5 * (t + 1.0 / t)

    @staticmethod
    def tanh(x):
        """1 - 2/(e**(2 x) + 1)."""
        t = Vectorised.expm1(-2.0 * abs(x))
        size = -t / (2.0 + t)
        return select(x < 0.0, -size, size)

    @staticmethod
    def asinh(x):
        """ln(x + sqrt(x**2 + 1))."""
        size = abs(x)
        inside = select(size < HUGE, size, HUGE)
        root = Vectorised.sqrt(1.0 + inside * inside)
        small = Vectorised.log1p(inside + inside * (inside / (1.0 + root)))
        found = select(size < HUGE, small, Vectorised.log(size) + LN2)
        return select(x < 0.0, -found, found)

    @staticmethod
    def asinh_of_exp(x):
        """asinh(e**x), which is x + ln 2 for large x."""
        far = x + Vectorised.log1p(Vectorised.sqrt(1.0 + Vectorised.exp(-2.0 * abs(x))))
        return select(x > 0.0, far, Vectorised.asinh(Vectorised.exp(x)))
