"""Derivatives of expressions: one rule a function, of terms that do not cancel each other."""

from .elementary import OfExpressions, cosh, sinh, where
from .expressions import exp, power, softplus

#: function -> its derivative, an expression, from its argument x and its value y
DERIVATIVES = {
    "exp": lambda x, y: y,
    "log": lambda x, y: 1.0 / x,
    "softplus": lambda x, y: OfExpressions.logistic(x),
    "logistic": lambda x, y: y * OfExpressions.logistic(-x),
    "asinh_of_exp": lambda x, y: exp(-0.5 * softplus(-2.0 * x)),
    "sinh": lambda x, y: cosh(x),
    "cosh": lambda x, y: sinh(x),
    "tanh": lambda x, y: 4.0 * OfExpressions.logistic(2.0 * x) * OfExpressions.logistic(-2.0 * x),
    "asinh": lambda x, y: power(1.0 + x * x, -0.5),
    "expm1": lambda x, y: exp(x),
    "log1p": lambda x, y: 1.0 / (1.0 + x),
    "abs": lambda x, y: where(x < 0.0, -1.0, 1.0),
}


class Derivative:
    """The derivative of expressions of one graph by a symbol.

    changes : dict symbol -> its derivative, an expression; of other symbols it is 0
    """

    def __init__(self, graph, changes):
        self.graph, self.found = graph, dict(changes)

    def __call__(self, x):
        if x not in self.found:
            self.found[x] = self.graph.number(0.0) if x.is_constant else self._of(x)
        return self.found[x]

    def _of(self, x):
        total = self.graph.number(0.0)
        if x.kind == "sum":
            for one, factor in x.parts:
                total = total + factor * self(one)
        elif x.kind == "product":
            for base, exponent in x.parts:
                rest = self.graph.product(1.0, {**dict(x.parts), base: exponent - 1.0})
                total = total + exponent * rest * self(base)
        elif x.kind == "where":
            condition, one, other = x.parts
            return where(condition, self(one), self(other))
        elif x.kind in DERIVATIVES:
            (argument,) = x.parts
            return DERIVATIVES[x.kind](argument, x) * self(argument)
        return total
