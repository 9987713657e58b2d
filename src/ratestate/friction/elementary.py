"""Elementary functions for formulas, beside those of expressions.py: of numbers and expressions."""

import math

from .expressions import Expression, log, power, softplus


def asinh(x):
    """The inverse of sinh; of a positive product from its logarithm."""
    if not isinstance(x, Expression):
        return math.asinh(x)
    return x.graph.call("asinh_of_exp", log(x)) if x.is_positive else x.graph.call("asinh", x)


def log1p(x):
    """ln(1 + x)."""
    if not isinstance(x, Expression):
        return math.log1p(x)
    return softplus(log(x)) if x.is_positive else x.graph.call("log1p", x)


def _function(name):
    def function(x):
        return x.graph.call(name, x) if isinstance(x, Expression) else getattr(math, name)(x)

    function.__name__ = name
    function.__doc__ = f"{name} x."
    return function


sinh, cosh, tanh, expm1 = map(_function, ("sinh", "cosh", "tanh", "expm1"))


def sqrt(x):
    """The root of x, x >= 0."""
    return power(x, 0.5)


def where(condition, x, y):
    """x where a condition holds, else y."""
    if not isinstance(condition, Expression):
        return x if condition else y
    graph = condition.graph
    return graph.call("where", condition, graph.number(x), graph.number(y))


def maximum(x, y):
    """The larger of both."""
    return where(x < y, y, x)


def minimum(x, y):
    """The smaller of both."""
    return where(y < x, y, x)
