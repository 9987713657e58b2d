"""Values of expressions, in numbers of any kind: floats, NumPy arrays, code that is being written.

What a kind of number means by exp, log and so on is a class of functions; `Real` is that of floats
and arrays.
"""

from typing import Any

import numpy as np

from .expressions import LIMIT, ordered


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
    def bounded_exp(x):
        """e**x, of x between -LIMIT and LIMIT at most."""
        return np.exp(np.clip(x, -LIMIT, LIMIT))

    @staticmethod
    def exp_and_inverse(x):
        """`bounded_exp` of x and of -x."""
        return Real.bounded_exp(x), Real.bounded_exp(-x)

    @staticmethod
    def rough_log2(x):
        """log2 x, less up to 0.09, of x > 0: between powers of 2 linear in x."""
        fraction, exponent = np.frexp(x)
        return exponent - 2.0 + 2.0 * fraction

    @staticmethod
    def cosine(x):
        """cos(2 pi x)."""
        return np.cos(2.0 * np.pi * (x - np.round(x)))

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


def function_of(roots, symbols):
    """A Python function that computes some expressions: of a class of functions, and of values.

    symbols : expressions, whose values it takes in this order
    """
    lines: list[str] = []
    known = {one: _Text(lines, f"x{k}") for k, one in enumerate(symbols)}
    found = ", ".join(map(str, evaluate(roots, known, _Functions(lines))))
    arguments = ", ".join(["functions", *map(str, known.values())])
    scope: dict[str, Any] = {}
    exec("\n    ".join([f"def value({arguments}):", *lines, f"return [{found}]"]), scope)
    return scope["value"]


class _Text:
    """A number as a name in Python text, which arithmetic goes on to write."""

    def __init__(self, lines, name):
        self.lines, self.name = lines, name

    def __str__(self):
        return self.name

    def let(self, text):
        """The name of what a line of text gives."""
        self.lines.append(f"t{len(self.lines)} = {text}")
        return _Text(self.lines, f"t{len(self.lines) - 1}")

    def __neg__(self):
        return self.let(f"-{self}")


def _operator(sign, is_from_the_right=False):
    def applied(self, other):
        pair = (other, self) if is_from_the_right else (self, other)
        return self.let(f" {sign} ".join(map(str, pair)))

    return applied


for _name, _sign in {"add": "+", "sub": "-", "mul": "*", "truediv": "/"}.items():
    setattr(_Text, f"__{_name}__", _operator(_sign))
    setattr(_Text, f"__r{_name}__", _operator(_sign, is_from_the_right=True))
for _name, _sign in {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "and": "&", "or": "|"}.items():
    setattr(_Text, f"__{_name}__", _operator(_sign))


class _Functions:
    """Functions of `_Text`, of which the text is a call."""

    def __init__(self, lines):
        self.lines = lines

    def __getattr__(self, name):
        def call(*arguments):
            given = ", ".join(map(str, arguments))
            return _Text(self.lines, "").let(f"functions.{name}({given})")

        return call


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
    if x.kind == "both":
        return arguments[0] & arguments[1]
    if x.kind == "either":
        return arguments[0] | arguments[1]
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
