"""exp, log and other functions for arrays, expressions, and code.

Laws, forms and the engine call these functions.  A number that is not a float or a NumPy array has
an attribute `functions`, the object that implements them for its type.  `DERIVATIVES` has their
derivatives, from which series follow too (taylor.py).
"""

import functools
import math
import operator
import struct

from .expressions import LIMIT, Expression


def _function(name, text):
    def function(x):
        return getattr(getattr(x, "functions", ARRAYS), name)(x)

    function.__name__ = function.__qualname__ = name
    function.__doc__ = text
    return function


exp = _function("exp", "Return e**x.")
bounded_exp = _function(
    "bounded_exp", "Return e**x with x limited to +-`expressions.LIMIT`: rest is e**-600."
)
exp_and_inverse = _function("exp_and_inverse", "Return `bounded_exp` of x and of -x.")
expm1 = _function("expm1", "Return e**x - 1.")
log = _function("log", "Return ln x, for x > 0.")
log1p = _function("log1p", "Return ln(1 + x).")
rough_log2 = _function(
    "rough_log2", "Return log2 x minus up to 0.09: linear between powers of 2; x > 0, normal."
)
sinh = _function("sinh", "Return sinh x.")
cosh = _function("cosh", "Return cosh x.")
tanh = _function("tanh", "Return tanh x.")
asinh = _function("asinh", "Return the inverse hyperbolic sine of x.")
sqrt = _function("sqrt", "Return the square root of x.")
softplus = _function("softplus", "Return ln(1 + e**x).")
logistic = _function("logistic", "Return 1/(1 + e**-x), the derivative of `softplus`.")
asinh_of_exp = _function("asinh_of_exp", "Return asinh(e**x), which is x + ln 2 for large x.")
cosine = _function("cosine", "Return cos(2 pi x).")


def where(condition, x, y):
    """Return x if the condition holds, else y."""
    if condition is True or condition is False:
        return x if condition else y
    if hasattr(condition, "select"):
        return condition.select(x, y)
    return ARRAYS.where(condition, x, y)[()]


def larger(x, y):
    """Return the larger of x and y; x if one of them is NaN."""
    return where(y > x, y, x)


def smaller(x, y):
    """Return the smaller of x and y; x if one of them is NaN."""
    return where(y < x, y, x)


def sine(x):
    """Return sin(2 pi x)."""
    return cosine(x - 0.25)


def asinh_of_product(w, x):
    """Return asinh(w e**x/2)."""
    size = asinh_of_exp(log(larger(abs(w), 1e-300)) + x - math.log(2.0))
    return where(abs(w) > 0.0, where(w < 0.0, -size, size), 0.0)


# -------------------------------------------------------------------------------------- derivatives

#: function that may be a node of a graph -> its derivative, from its argument x and its value y;
#: the terms of these derivatives do not cancel
DERIVATIVES = {
    "exp": lambda x, y: y,
    "log": lambda x, y: 1.0 / x,
    "softplus": lambda x, y: logistic(x),
    "logistic": lambda x, y: y * logistic(-x),
    "asinh_of_exp": lambda x, y: exp(-0.5 * softplus(-2.0 * x)),
    "sinh": lambda x, y: cosh(x),
    "cosh": lambda x, y: sinh(x),
    "tanh": lambda x, y: 4.0 * logistic(2.0 * x) * logistic(-2.0 * x),
    "asinh": lambda x, y: (1.0 + x * x) ** -0.5,
    "expm1": lambda x, y: exp(x),
    "log1p": lambda x, y: 1.0 / (1.0 + x),
    "abs": lambda x, y: where(x < 0.0, -1.0, 1.0),
}


class _ExpressionFunctions:
    """Functions of expressions: nodes, unless logarithms and exponentials cancel."""

    def __getattr__(self, name):
        if name not in DERIVATIVES:
            raise AttributeError(name)
        return lambda x: x.graph.call(name, x)

    def exp(self, x):
        """Return e**x; a logarithm in x becomes a power of its argument."""
        product, others = x.graph.one, {}
        for term, factor in x.terms.items():
            if term.kind == "log":
                product = product * term.parts[0] ** factor
            else:
                others[term] = factor
        exponent = x.graph.sum(others)
        if exponent.kind == "number":
            return math.exp(exponent.parts[0]) * product
        return product * x.graph.call("exp", exponent)

    def log(self, x):
        """Return ln x, by factors of a positive product, and by `softplus` for a sum."""
        factor, powers = x.powers
        if len(powers) > 1 or list(powers.values()) != [1.0] or factor != 1.0:
            others = [(base.kind, n) for base, n in powers.items() if not base.is_positive]
            if factor > 0.0 and others in ([], [("sinh", 1.0)]):
                logs = (n * log(base) for base, n in powers.items())
                return functools.reduce(operator.add, logs, x.graph.number(math.log(factor)))
        elif x.kind == "exp":
            return x.parts[0]
        elif x.kind == "cosh":  # ln 2 cosh x = softplus(2 x) - x
            return softplus(2.0 * x.parts[0]) - x.parts[0] - math.log(2.0)
        elif x.kind == "sinh":  # the logarithm exists for positive arguments only
            return x.parts[0] + log(1.0 - exp(-2.0 * x.parts[0])) - math.log(2.0)
        elif x.kind == "sum" and x.is_positive:
            constants_first = sorted(x.parts, key=lambda part: not part[0].is_constant)
            terms = [log(term) + math.log(factor) for term, factor in constants_first]
            return functools.reduce(lambda a, b: a + softplus(b - a), terms)
        return x.graph.call("log", x)

    def log1p(self, x):
        return softplus(log(x)) if x.is_positive else x.graph.call("log1p", x)

    def asinh(self, x):
        return asinh_of_exp(log(x)) if x.is_positive else x.graph.call("asinh", x)

    def sqrt(self, x):
        return x**0.5


Expression.functions = _ExpressionFunctions()


# ------------------------------------------------------------------------------------------- arrays


class _ArrayFunctions:
    """Functions of floats and NumPy arrays, from NumPy or written here."""

    def __getattr__(self, name):
        import numpy as np  # slow to import

        setattr(self, name, getattr(np, name))
        return getattr(np, name)

    def asinh(self, x):
        return self.arcsinh(x)

    def bounded_exp(self, x):
        return self.exp(self.clip(x, -LIMIT, LIMIT))

    def exp_and_inverse(self, x):
        return self.bounded_exp(x), self.bounded_exp(-x)

    def rough_log2(self, x):
        fraction, exponent = self.frexp(x)
        return exponent - 2.0 + 2.0 * fraction

    def cosine(self, x):
        return self.cos(2.0 * math.pi * (x - self.round(x)))

    def softplus(self, x):
        return self.logaddexp(0.0, x)

    def logistic(self, x):
        small = self.exp(-abs(x))
        return self.where(x < 0.0, small, 1.0) / (1.0 + small)

    def asinh_of_exp(self, x):
        below, above = self.minimum(x, 0.0), self.maximum(x, 0.0)
        far = above + self.log1p(self.sqrt(1.0 + self.exp(-2.0 * above)))
        return self.where(x > 0.0, far, self.arcsinh(self.exp(below)))


ARRAYS = _ArrayFunctions()


# --------------------------------------------------------------------------------------------- code


def _bits(x):
    return struct.unpack("<q", struct.pack("<d", x))[0]


LOG2_E, SQRT2 = 1.4426950408889634, 1.4142135623730951
# ln 2 in two parts: n*LN2_HIGH is exact for every exponent n that a double can have.
LN2_HIGH, LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
LN2, LN_SQRT2 = math.log(2.0), 0.5 * math.log(2.0)
# Adding 1.5*2**52 rounds to an integer and leaves that integer in the low bits of the sum.
ROUND = 6755399441055744.0
HALF_BITS, ROUND_BITS, MANTISSA = _bits(math.sqrt(0.5)), _bits(ROUND), (1 << 52) - 1
#: a number below which x*x + 1 does not overflow
HUGE = 1e150
#: Taylor coefficients of sin(2 pi q) for odd powers of q: to 1e-17 if |q| <= 1/4
SINE = tuple(
    (-1) ** k * (2.0 * math.pi) ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(12)
)


def _reduce_argument(x):
    """Split x into n ln 2 + r: the bits of the integer n, cosh r - 1 and sinh r.

    The polynomials are near-minimax of degree 11 (relative error 2e-17).  They are summed as trees,
    because the longest chain of operations takes the time, not their number.
    """
    x = where(x > LIMIT, LIMIT, where(x < -LIMIT, -LIMIT, x))
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
    """Return 2**n, from the bits of n + ROUND."""
    return ((n + 1023) << 52).number()


def _artanh(z):
    """Return artanh z by its series, to 1e-16 relative, for |z| <= 0.172."""
    z2 = z * z
    z4 = z2 * z2
    z8 = z4 * z4
    low = (1.0 + z2 * (1.0 / 3.0)) + z4 * (1.0 / 5.0 + z2 * (1.0 / 7.0))
    middle = (1.0 / 9.0 + z2 * (1.0 / 11.0)) + z4 * (1.0 / 13.0 + z2 * (1.0 / 15.0))
    high = (1.0 / 17.0 + z2 * (1.0 / 19.0)) + z4 * (1.0 / 21.0)
    return z * (low + z8 * (middle + z8 * high))


class _CodeFunctions:
    """Functions of numbers that write code, from arithmetic alone.

    `exp` is accurate to 3 units in the last place between -LIMIT and LIMIT and saturates outside: a
    speed of 1e-260 V_ref counts as rest, and the time scales at that speed still fit into a double.
    NaN stays NaN.
    """

    def sqrt(self, x):
        return x.code.call("sqrt", x)

    def exp(self, x):
        n, even, odd = _reduce_argument(x)
        return (1.0 + even + odd) * _power_of_2(n)

    bounded_exp = exp

    def exp_and_inverse(self, x):  # without a division
        n, even, odd = _reduce_argument(x)
        power, inverse = _power_of_2(n), _power_of_2(0 - n)
        return (1.0 + even + odd) * power, (1.0 + even - odd) * inverse

    def expm1(self, x):  # nearly to the last digit if x is small
        n, even, odd = _reduce_argument(x)
        power = _power_of_2(n)
        return (even + odd) * power + (power - 1.0)

    def log(self, x):  # x = 2**n m, sqrt(1/2) <= m < sqrt 2, from the bits of a normal x > 0
        bits = x.bits() - HALF_BITS
        m = ((bits & MANTISSA) + HALF_BITS).number()
        n = ((bits >> 52) + ROUND_BITS).number() - ROUND
        result = n * LN2_HIGH + (n * LN2_LOW + 2.0 * _artanh((m - 1.0) / (m + 1.0)))
        return where(x > 0.0, result, (x - x) / (x - x))

    def rough_log2(self, x):
        return ((((x.bits() >> 12) + ROUND_BITS).number()) - ROUND) * 2.0**-40 - 1023.0

    def cosine(self, x):  # error: about 1e-16, and 2 pi times the rounding of x
        q = 0.25 - abs(x - ((x + ROUND) - ROUND))
        z = q * q
        z2 = z * z
        z4 = z2 * z2
        low = (SINE[0] + z * SINE[1]) + z2 * (SINE[2] + z * SINE[3])
        middle = (SINE[4] + z * SINE[5]) + z2 * (SINE[6] + z * SINE[7])
        high = (SINE[8] + z * SINE[9]) + z2 * (SINE[10] + z * SINE[11])
        return q * (low + z4 * (middle + z4 * high))

    def log1p(self, x):  # adds the part of x that rounding of 1 + x loses
        rounded = 1.0 + x
        return log(rounded) + (x - (rounded - 1.0)) / rounded

    def softplus(self, x):
        t = exp(-abs(x))
        is_small = t < 0.4  # ln(1 + t) from t itself, else from its ratio to sqrt(2)
        above = where(is_small, t, t + (1.0 - SQRT2))
        below = where(is_small, t, t + (SQRT2 - 1.0))
        rest = where(is_small, 0.0, LN_SQRT2) + 2.0 * _artanh(above / (2.0 + below))
        return 0.5 * (x + abs(x)) + rest

    def logistic(self, x):
        return 1.0 / (1.0 + exp(-x))

    def sinh(self, x):
        t = expm1(abs(x))
        size = 0.5 * (t + t / (t + 1.0))
        return where(x < 0.0, -size, size)

    def cosh(self, x):
        t = exp(abs(x))
        return 0.5 * (t + 1.0 / t)

    def tanh(self, x):
        t = expm1(-2.0 * abs(x))
        size = -t / (2.0 + t)
        return where(x < 0.0, -size, size)

    def asinh(self, x):
        size = abs(x)
        inside = where(size < HUGE, size, HUGE)
        root = sqrt(1.0 + inside * inside)
        small = log1p(inside + inside * (inside / (1.0 + root)))
        result = where(size < HUGE, small, log(size) + LN2)
        return where(x < 0.0, -result, result)

    def asinh_of_exp(self, x):
        far = x + log1p(sqrt(1.0 + exp(-2.0 * abs(x))))
        return where(x > 0.0, far, asinh(exp(x)))


CODE = _CodeFunctions()
