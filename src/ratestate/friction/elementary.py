"""Elementary functions for formulas, beside those of expressions.py: of numbers and expressions."""

import math

from .expressions import CONDITIONS, Expression, FormulaError, exp, log, power, softplus


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
    if condition.kind not in CONDITIONS:
        raise FormulaError(
            "the condition of where is a number. Give a comparison, such as V > p.V0."
        )
    graph = condition.graph
    x, y = graph.number(x), graph.number(y)
    return x if x is y else graph.call("where", condition, x, y)


class OfExpressions:
    """The functions of expressions, of which functions.py chooses."""

    exp, expm1, log, log1p, sqrt = map(staticmethod, (exp, expm1, log, log1p, sqrt))
    sinh, cosh, tanh, asinh, where = map(staticmethod, (sinh, cosh, tanh, asinh, where))
    softplus, abs = staticmethod(softplus), staticmethod(abs)

    @staticmethod
    def logistic(x):
        """1/(1 + e**-x)."""
        return x.graph.call("logistic", x)

    @staticmethod
    def asinh_of_exp(x):
        """asinh(e**x)."""
        return x.graph.call("asinh_of_exp", x)


Expression.functions = OfExpressions
