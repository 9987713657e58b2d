"""Values of expressions, in numbers of any kind: floats, NumPy arrays, code that is being written.

What a kind of number means by exp, log and so on is a class of functions; `Real` is that of floats
and arrays.
"""

import numpy as np

from .expressions import ordered


class Real:
    """The functions of floats and NumPy arrays."""

    exp, log, expm1, log1p = np.exp, np.log, np.expm1, np.log1p
    sinh, cosh, tanh, asinh = np.sinh, np.cosh, np.tanh, np.arcsinh
    sqrt, abs = np.sqrt, np.abs

    @staticmethod
    def where(condition, x, y):
        """x where a condition holds, else y."""
        return np.where(condition, x, y)[()]

    @staticmethod
    def softplus(x):
        """ln(1 + e**x)."""
        return np.maximum(x, 0.0) + np.log1p(np.exp(-np.abs(x)))

    @staticmethod
    def logistic(x):
        """1/(1 + e**-x)."""
        small = np.exp(-np.abs(x))
        return np.where(x < 0.0, small, 1.0) / (1.0 + small)

    @staticmethod
    def asinh_of_exp(x):
        """asinh(e**x), which is x + ln 2 for large x."""
        small = np.exp(-2.0 * np.maximum(x, 0.0))
        above = x + np.log1p(np.sqrt(1.0 + small))
        return np.where(x > 0.0, above, np.arcsinh(np.exp(np.minimum(x, 0.0))))


def evaluate(roots, known, functions=Real):
    """Values of some expressions, a list.

    known : dict expression -> value, of all symbols in them and of what else is known
    """
    values = dict(known)
    with np.errstate(all="ignore"):  # the side of a choice that is not taken may be no number
        for one in ordered(roots):
            if one not in values:
                values[one] = _value(one, values, functions)
    return [values[one] for one in roots]


def _value(x, values, functions):
    if x.kind == "number":
        return x.parts[0]
    if x.kind == "sum":
        return _sum(x, values, functions)
    if x.kind == "product":
        return _product(x, values, functions)
    arguments = [values[one] for one in x.parts]
    if x.kind == "less":
        return arguments[0] < arguments[1]
    if x.kind == "less_equal":
        return arguments[0] <= arguments[1]
    return getattr(functions, x.kind)(*arguments)


def _sum(x, values, functions):
    if len(x.parts) == 2:
        (one, factor), (other, its) = sorted(x.parts, key=lambda part: part[0].kind != "number")
        if one.kind == "number" and other.kind == "exp" and its == -factor:
            return its * functions.expm1(values[other.parts[0]])
    total = None
    for one, factor in x.parts:
        value = values[one]
        if one.kind == "number":
            value, factor = factor, 1.0
        if total is None:
            total = value if factor == 1.0 else -value if factor == -1.0 else factor * value
        elif factor in (1.0, -1.0):
            total = total + value if factor > 0.0 else total - value
        else:
            total = total + factor * value
    return total


def _product(x, values, functions):
    whole = over = None
    for base, exponent in x.parts:
        value = _power(values[base], abs(exponent), functions)
        if exponent > 0.0:
            whole = value if whole is None else whole * value
        else:
            over = value if over is None else over * value
    if over is None:
        return whole
    return (1.0 if whole is None else whole) / over


def _power(x, exponent, functions):
    """x**exponent, exponent > 0."""
    whole = int(exponent)
    if exponent - whole == 0.5:
        root = functions.sqrt(x)
        return root if whole == 0 else root * _power(x, whole, functions)
    if exponent != whole:
        return functions.exp(exponent * functions.log(x))
    half = None if whole == 1 else _power(x, whole // 2, functions)
    if half is None:
        return x
    return half * half if whole % 2 == 0 else half * half * x
