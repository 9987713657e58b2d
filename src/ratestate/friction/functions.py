"""Functions of numbers of any kind, with which laws, forms and the engine are written.

Floats and NumPy arrays, and numbers of code that is being written (engine/code.py): each kind of
number has its own in a class, `Real` or what the attribute `functions` of a number is.
"""

import math


def functions_of(*numbers):
    """The class of functions for these kinds of numbers or conditions."""
    for x in numbers:
        if (found := getattr(x, "functions", None)) is not None:
            return found
    from .evaluation import Real  # NumPy is slow to import

    return Real


def _function(name, text):
    def function(x):
        return getattr(functions_of(x), name)(x)

    function.__name__ = function.__qualname__ = name
    function.__doc__ = text
    return function


exp = _function("exp", "e**x.")
bounded_exp = _function(
    "bounded_exp", "e**x, of x cut off at -`expressions.LIMIT` and at that: rest is e**-600."
)
expm1 = _function("expm1", "e**x - 1.")
log = _function("log", "ln x, of x > 0.")
log1p = _function("log1p", "ln(1 + x).")
sinh = _function("sinh", "sinh x.")
cosh = _function("cosh", "cosh x.")
sqrt = _function("sqrt", "The root of x.")
tanh = _function("tanh", "tanh x.")
asinh = _function("asinh", "The inverse of sinh.")
softplus = _function("softplus", "ln(1 + e**x).")
logistic = _function("logistic", "1/(1 + e**-x), the derivative of `softplus`.")
cosine = _function("cosine", "cos(2 pi x).")


def where(condition, x, y):
    """x where a condition holds, else y."""
    if condition is True or condition is False:
        return x if condition else y
    return functions_of(condition).where(condition, x, y)


def larger(x, y):
    """The larger of both; x if that is not to be said."""
    return where(y > x, y, x)


def smaller(x, y):
    """The smaller of both; x if that is not to be said."""
    return where(y < x, y, x)


def sine(x):
    """sin(2 pi x)."""
    return cosine(x - 0.25)


def asinh_of_exp(x):
    """asinh(e**x/2), which is x for large x."""
    return functions_of(x).asinh_of_exp(x - math.log(2.0))


def asinh_of(w, x):
    """asinh(w e**x/2)."""
    size = asinh_of_exp(log(larger(abs(w), 1e-300)) + x)
    return where(abs(w) > 0.0, where(w < 0.0, -size, size), 0.0)
