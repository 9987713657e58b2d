"""The functions of friction/functions.py in compiled code, which loops over lanes can vectorise."""

from typing import Any

from numba.extending import overload

from ..friction import functions
from ..friction.functions import logistic, softplus
from .exp import exp
from .jit import INLINED, inlined

_overload: Any = overload  # (its declared arguments lack jit_options)

SQRT2, LN_SQRT2 = 1.4142135623730951, 0.34657359027997264


@inlined
def log1p_of_part(t):
    """ln(1 + t) for 0 <= t <= 1, to 2e-16 of 1: ln(sqrt 2) + 2 artanh z."""
    z = ((1.0 + t) - SQRT2) / ((1.0 + t) + SQRT2)
    z2 = z * z
    z4 = z2 * z2
    z8 = z4 * z4
    low = (1.0 + z2 * (1.0 / 3.0)) + z4 * (1.0 / 5.0 + z2 * (1.0 / 7.0))
    middle = (1.0 / 9.0 + z2 * (1.0 / 11.0)) + z4 * (1.0 / 13.0 + z2 * (1.0 / 15.0))
    high = (1.0 / 17.0 + z2 * (1.0 / 19.0)) + z4 * (1.0 / 21.0)
    return LN_SQRT2 + 2.0 * z * (low + z8 * (middle + z8 * high))


@_overload(softplus, jit_options=INLINED)
def _softplus(x):
    def of_number(x):
        return (x if x > 0.0 else 0.0) + log1p_of_part(exp(-abs(x)))

    return of_number


@_overload(logistic, jit_options=INLINED)
def _logistic(x):
    def of_number(x):
        small = exp(-abs(x))
        return (1.0 if x > 0.0 else small) / (1.0 + small)

    return of_number


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
_of_each(functions.bent_each, "y", "y[{k}] * (1.0 - y[{k}])")
_of_each(functions.weighted, "weights, y", "weights[{k}] * y[{k}]")
_of_each(functions.zeros_for, "y", "0.0 * y[{k}]")


@_overload(functions.weighted_sum, jit_options=INLINED)
def _weighted_sum(weights, y):
    terms = " + ".join(f"weights[{k}] * y[{k}]" for k in range(len(y)))
    return eval(f"lambda weights, y: {terms}")


@_overload(functions.diagonal, jit_options=INLINED)
def _diagonal(y):
    n = range(len(y))
    rows = (", ".join(f"y[{k}]" if j == k else "0.0" for j in n) for k in n)
    return eval("lambda y: (" + "".join(f"({row},), " for row in rows) + ")")
