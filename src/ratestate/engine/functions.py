"""The functions of friction/functions.py in compiled code, which loops over lanes can vectorise.

They have no branches, at which such a loop would end.
"""

import math
from typing import Any

import numpy as np
from numba.extending import overload

from ..friction import functions
from ..friction.functions import asinh_of, larger, log, logistic, softplus
from .exp import LN2_HIGH, LN2_LOW, ROUND, exp, parts, power_of_2
from .jit import INLINED, inlined
from .tracing import traced

_overload: Any = overload  # (its declared arguments lack jit_options)

SQRT2, LN_SQRT2 = 1.4142135623730951, 0.34657359027997264
# Bits: of sqrt(1/2), but for its last ones; of a mantissa; of `exp.ROUND`.
HALF_BITS = np.float64(math.sqrt(0.5)).view(np.int64)
MANTISSA = np.int64((1 << 52) - 1)
ROUND_BITS = np.float64(ROUND).view(np.int64)


@inlined
def artanh(z):
    """artanh z for |z| <= 0.172, to 1e-16 of itself, by its series."""
    z2 = z * z
    z4 = z2 * z2
    z8 = z4 * z4
    low = (1.0 + z2 * (1.0 / 3.0)) + z4 * (1.0 / 5.0 + z2 * (1.0 / 7.0))
    middle = (1.0 / 9.0 + z2 * (1.0 / 11.0)) + z4 * (1.0 / 13.0 + z2 * (1.0 / 15.0))
    high = (1.0 / 17.0 + z2 * (1.0 / 19.0)) + z4 * (1.0 / 21.0)
    return z * (low + z8 * (middle + z8 * high))


@inlined
def log1p_of_part(t):
    """ln(1 + t) for 0 <= t <= 1, to 2e-16 of 1."""
    return LN_SQRT2 + 2.0 * artanh(((1.0 + t) - SQRT2) / ((1.0 + t) + SQRT2))


@_overload(log, jit_options=INLINED)
def _log(x):
    def of_number(x):
        """By x = 2**n m, sqrt(1/2) <= m < sqrt 2, from the bits of a normal x > 0."""
        bits = np.float64(x).view(np.int64) - HALF_BITS
        m = np.int64((bits & MANTISSA) + HALF_BITS).view(np.float64)
        rest = 2.0 * artanh((m - 1.0) / (m + 1.0))
        # (an integer in the low bits of a number of this size; AVX-512 alone would convert it)
        n = np.int64((bits >> np.int64(52)) + ROUND_BITS).view(np.float64) - ROUND
        return n * LN2_HIGH + (n * LN2_LOW + rest)

    return of_number


@_overload(larger, jit_options=INLINED)
def _larger(x, y):
    return lambda x, y: x if x > y else y


@_overload(functions.tanh, jit_options=INLINED)
def _tanh(x):
    def of_number(x):
        """From the odd part of e**x, in which nothing cancels where x is small."""
        n, even, odd = parts(x)
        up, down = power_of_2(n), power_of_2(-n)
        both, difference = up + down, up - down
        return (both * odd + difference * even) / (both * even + difference * odd)

    return of_number


@_overload(asinh_of, jit_options=INLINED)
def _asinh_of(w, x):
    def of_number(w, x):
        """Of one number at a time, by the C library."""
        if w == 0.0:
            return 0.0
        log_size = math.log(abs(w)) + x
        size = math.asinh(0.5 * math.exp(log_size)) if log_size < 20.0 else log_size
        return math.copysign(size, w)

    return of_number


@_overload(softplus, jit_options=INLINED)
def _softplus(x):
    def of_number(x):
        return 0.5 * (x + abs(x)) + log1p_of_part(exp(-abs(x)))

    return of_number


@_overload(logistic, jit_options=INLINED)
def _logistic(x):
    def of_number(x):
        return 1.0 / (1.0 + exp(-x))

    return of_number


@_overload(functions.flash, jit_options=INLINED)
def _flash(x):
    return lambda x: exp(-0.125 * softplus(8.0 * x))


@_overload(functions.log_2_sinh, jit_options=INLINED)
def _log_2_sinh(x):
    return lambda x: x + log(1.0 - exp(-2.0 * x))


@_overload(functions.coth, jit_options=INLINED)
def _coth(x):
    return lambda x: 2.0 / (1.0 - exp(-2.0 * x)) - 1.0


# Taylor coefficients of sin(2 pi q), of odd powers of q: to 1e-17 where |q| <= 1/4.
SINE = tuple(
    (-1) ** k * (2.0 * math.pi) ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(12)
)


@traced
def cosine_of_periods(x):
    """cos(2 pi x), off by some 1e-16 and by what 2 pi times the rounding of x makes."""
    q = 0.25 - abs(x - ((x + ROUND) - ROUND))
    z = q * q
    z2 = z * z
    z4 = z2 * z2
    low = (SINE[0] + z * SINE[1]) + z2 * (SINE[2] + z * SINE[3])
    middle = (SINE[4] + z * SINE[5]) + z2 * (SINE[6] + z * SINE[7])
    high = (SINE[8] + z * SINE[9]) + z2 * (SINE[10] + z * SINE[11])
    return q * (low + z4 * (middle + z4 * high))


@_overload(functions.cosine, jit_options=INLINED)
def _cosine(x):
    return lambda x: cosine_of_periods(x)


@_overload(functions.sine, jit_options=INLINED)
def _sine(x):
    return lambda x: cosine_of_periods(x - 0.25)


def _of_each(function, arguments, item):
    """Compile a function of tuples, of the last argument's length, from an item's formula in k."""

    def of_types(*types):
        n = len(types[-1])
        whole = "".join(f"{item.format(k=k)}, " for k in range(n))
        return eval(f"lambda {arguments}: ({whole})", {"softplus": softplus, "logistic": logistic})

    names = [name.strip() for name in arguments.split(",")]
    # (numba compares the names of the arguments)
    typed = eval(f"lambda {arguments}: of_types({', '.join(names)})", {"of_types": of_types})
    _overload(function, jit_options=INLINED)(typed)


_of_each(functions.softplus_each, "x, y", "softplus(x + y[{k}])")
_of_each(functions.logistic_each, "x, y", "logistic(x + y[{k}])")
# What is arithmetic on tuples alone is compiled from the very functions that Python calls.
for _arithmetic in (
    *(functions.bent_each, functions.scaled, functions.added, functions.weighted),
    *(functions.weighted_sum, functions.zeros_for, functions.diagonal),
):
    traced(_arithmetic)
