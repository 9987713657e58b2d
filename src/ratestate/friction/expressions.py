"""Formulas as graphs of expressions, from running a formula once.

An `Expression` is a number, a symbol, a sum of multiples, a product of powers, a function of other
expressions, or a choice between two.  A `Graph` has each of its expressions only once.

The exponentials in a product are merged into one, and the logarithm of a product of positive
factors is the sum of their logarithms (functions.py).  So a positive quantity such as
V = V_ref exp(v) carries its logarithm, and V theta/Dc is exp(v + psi) in any units: products and
powers of V and theta do not overflow on the way to a finite result.
"""

import functools
import math
import numbers
import operator
import threading
from typing import Any

#: held while the expressions of a law are made, so that all threads share them
EXPRESSION_LOCK = threading.RLock()
#: functions with positive values
POSITIVE_FUNCTIONS = ("exp", "softplus", "logistic", "asinh_of_exp", "cosh")
#: conditions, the nodes that are not numbers -> their operator
CONDITIONS = {"less": "<", "less_equal": "<=", "both": "&", "either": "|"}
#: the engine's exponentials saturate beyond +-LIMIT: a speed of 1e-260 V_ref counts as rest
LIMIT = 600.0
#: larger powers of positive quantities are computed from the logarithm
LARGEST_POWER = 16
#: names of NumPy's functions that are operators -> the operator
OPERATORS = {
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
    "power": operator.pow,
    "less": operator.lt,
    "less_equal": operator.le,
    "greater": operator.gt,
    "greater_equal": operator.ge,
}
#: NumPy's name -> name in `ratestate.laws`, if they differ
NUMPY_NAMES = {"arcsinh": "asinh", "absolute": "abs"}


class FormulaError(TypeError):
    """A formula cannot be run with expressions: the problem, and the remedy.

    method : the law's method at fault, if the traceback does not show it
    """

    def __init__(self, text, method=""):
        super().__init__(text)
        self.method = method


class Graph:
    """The expressions of some formulas, each only once.

    merges : whether the exponentials in a product become one.  Derivatives are taken without
        merging, so that they reuse the exponentials of the formula.
    """

    def __init__(self, merges=True):
        self.merges, self._nodes = merges, {}
        self.programs = {}  # of `rewriting.values_of`
        self.one = self.number(1.0)

    def number(self, x):
        """Return a number as an expression, and an expression unchanged."""
        if isinstance(x, Expression):
            if x.kind in CONDITIONS:
                raise FormulaError(
                    "a condition is not a number. Use ratestate.laws.where(condition, x, y)."
                )
            return x
        if not (isinstance(x, numbers.Real) and math.isfinite(x)):
            raise FormulaError(
                f"{x!r} is not a finite number. Write formulas with numbers, V, theta and p."
            )
        return self._node("number", (float(x),), is_constant=True)

    def symbol(self, name, is_constant=True, is_positive=False):
        """Return the expression of a quantity with this name."""
        return self._node("positive" if is_positive else "symbol", (name,), is_constant)

    def sum(self, terms):
        """Return a sum of multiples; terms : dict expression -> factor, a float."""
        terms = {term: factor for term, factor in terms.items() if factor != 0.0}
        if not terms:
            return self.number(0.0)
        if len(terms) == 1:
            ((term, factor),) = terms.items()
            if term is self.one:
                return self.number(factor)
            if factor == 1.0:
                return term
        parts = tuple(terms.items())
        return self._node("sum", parts, key=frozenset(parts))

    def product(self, factor, powers):
        """Return a product; factor : float; powers : dict expression -> exponent."""
        exponent, factors = self.number(0.0), {}
        for base, power in powers.items():
            if base.kind == "exp" and self.merges:
                exponent = exponent + power * base.parts[0]
            elif base.kind == "number":
                factor *= base.parts[0] ** power
            elif power != 0.0:
                factors[base] = power
        if exponent.kind == "number":
            factor *= math.exp(exponent.parts[0])
        else:
            factors[self.call("exp", exponent)] = 1.0
        if factor == 0.0 or not factors:
            return self.number(factor)
        if [*factors.values()] == [1.0]:
            (product,) = factors
        else:
            parts = tuple(factors.items())
            product = self._node("product", parts, key=frozenset(parts))
        return self.sum({term: factor * n for term, n in product.terms.items()})

    def call(self, name, *arguments):
        """Return a function of expressions, without simplification."""
        return self._node(name, arguments)

    def _node(self, kind, parts, is_constant=None, key=None):
        key = kind, key or parts
        if key not in self._nodes:
            self._nodes.setdefault(key, Expression(self, kind, parts, is_constant))
        return self._nodes[key]


def _operators(function):
    """Return an operator of expressions and numbers, and its reflected version."""

    def applied(self, other):
        return function(*map(self.graph.number, (self, other)))

    def reflected(self, other):
        return function(*map(self.graph.number, (other, self)))

    return applied, reflected


def _sum(x, y):
    terms = x.terms
    for term, factor in y.terms.items():
        terms[term] = terms.get(term, 0.0) + factor
    return x.graph.sum(terms)


def _product(x, y):
    (a, powers), (b, others) = x.powers, y.powers
    for base, exponent in others.items():
        powers[base] = powers.get(base, 0.0) + exponent
    return x.graph.product(a * b, powers)


def _power(x, exponent):
    """Return x**exponent, for x > 0 unless the exponent is an integer."""
    graph, functions = x.graph, x.functions
    is_negative = exponent.kind == "number" and exponent.parts[0] < 0.0
    if x.kind == "where" and not is_negative:  # a side may be 0, which has no logarithm
        condition, *sides = x.parts
        return graph.call("where", condition, *(side**exponent for side in sides))
    if exponent.kind != "number":
        return functions.exp(exponent * functions.log(x))
    exponent = exponent.parts[0]
    if graph.merges and x.is_positive and not x.is_constant and _needs_logarithm(x, exponent):
        return functions.exp(exponent * functions.log(x))
    factor, powers = x.powers
    is_integer = exponent == int(exponent)
    if not (is_integer or (factor > 0.0 and all(base.is_positive for base in powers))):
        return graph.product(1.0, {x: exponent})
    if len(powers) == 1 and factor == 1.0:
        return graph.product(1.0, {base: exponent * n for base, n in powers.items()})
    factors = (base ** (exponent * n) for base, n in powers.items())
    return functools.reduce(operator.mul, factors, graph.number(factor**exponent))


def _needs_logarithm(x, exponent):
    """Return whether a power of x > 0 may overflow on the way to a finite result."""
    if abs(exponent) > LARGEST_POWER:
        return True
    return x.kind in ("sum", "cosh") and (exponent < 0.0 or exponent != int(exponent))


class Expression:
    """A node of a graph, immutable.

    kind : "number", "symbol" or "positive" (a symbol), "sum", "product", "where", or a name in
        `CONDITIONS` or `functions.DERIVATIVES`
    parts : its arguments; for sums and products pairs, with factors or exponents
    """

    __slots__ = ("graph", "is_constant", "kind", "parts")
    functions: Any  # functions.py sets this

    def __init__(self, graph, kind, parts, is_constant=None):
        self.graph, self.kind, self.parts = graph, kind, parts
        if is_constant is None:
            is_constant = all(operand.is_constant for operand in self.operands)
        self.is_constant = is_constant

    @property
    def operands(self):
        """Return the expressions in `parts`, a tuple."""
        if self.kind in ("number", "symbol", "positive"):
            return ()
        if self.kind in ("sum", "product"):
            return tuple(operand for operand, _ in self.parts)
        return self.parts

    @property
    def terms(self):
        """Return the expression as a sum: dict expression -> factor."""
        if self.kind == "sum":
            return dict(self.parts)
        return {self.graph.one: self.parts[0]} if self.kind == "number" else {self: 1.0}

    @property
    def powers(self):
        """Return the expression as a product: a factor, and dict expression -> exponent."""
        if self.kind == "number":
            return self.parts[0], {}
        if self.kind == "product":
            return 1.0, dict(self.parts)
        if self.kind == "sum" and len(self.parts) == 1:
            ((term, factor),) = self.parts
            return factor, term.powers[1]
        return 1.0, {self: 1.0}

    @property
    def is_positive(self):
        """Return whether the expression is certainly positive."""
        if self.kind == "number":
            return self.parts[0] > 0.0
        if self.kind == "sum" and any(factor < 0.0 for _, factor in self.parts):
            return False
        if self.kind in ("sum", "product"):
            return all(operand.is_positive for operand in self.operands)
        if self.kind == "where":
            return self.parts[1].is_positive and self.parts[2].is_positive
        return self.kind == "positive" or self.kind in POSITIVE_FUNCTIONS

    __add__, __radd__ = _operators(_sum)
    __sub__, __rsub__ = _operators(lambda x, y: _sum(x, -y))
    __mul__, __rmul__ = _operators(_product)
    __truediv__, __rtruediv__ = _operators(lambda x, y: _product(x, y**-1.0))
    __pow__, __rpow__ = _operators(_power)
    __lt__, __gt__ = _operators(lambda x, y: x.graph.call("less", x, y))
    __le__, __ge__ = _operators(lambda x, y: x.graph.call("less_equal", x, y))

    def __neg__(self):
        return -1.0 * self

    def __abs__(self):
        return self if self.is_positive else self.graph.call("abs", self)

    def __and__(self, other):
        return self._combined("both", other)

    def __or__(self, other):
        return self._combined("either", other)

    def _combined(self, kind, other):
        if not all(getattr(x, "kind", "") in CONDITIONS for x in (self, other)):
            raise FormulaError("& and | join comparisons of V, theta or p, and nothing else.")
        return self.graph.call(kind, self, other)

    def select(self, x, y):
        """Return x if this condition holds, else y."""
        if self.kind not in CONDITIONS:
            raise FormulaError(
                "the condition of where is a number. Give a comparison, such as V > p.V0."
            )
        x, y = self.graph.number(x), self.graph.number(y)
        return x if x is y else self.graph.call("where", self, x, y)

    def __eq__(self, other):
        raise FormulaError("V, theta or p is compared by == or !=. Compare by < or >.")

    __hash__ = object.__hash__

    def __bool__(self):
        raise FormulaError(
            "if, and, or, not, min or max depends on V, theta or p. Use ratestate.laws: "
            "where(condition, x, y), minimum and maximum, and & and | between conditions."
        )

    def __float__(self):
        raise FormulaError(
            "a function that takes plain numbers, such as math.exp, is given V, theta or p. Use "
            "the function of this name in ratestate.laws."
        )

    def __array_ufunc__(self, function, method, *inputs, **others):
        """Apply an operator to expressions and NumPy numbers."""
        name = function.__name__
        if name not in OPERATORS or method != "__call__":
            self.__array_function__(function, (), inputs, others)
        x, y = (x if isinstance(x, Expression) else float(x) for x in inputs)
        return OPERATORS[name](x, y)

    def __array_function__(self, function, types, inputs, others):
        """Reject other functions of NumPy."""
        name = function.__name__
        our_name = NUMPY_NAMES.get(name, name)
        raise FormulaError(f"numpy.{name} is given V, theta or p. Use ratestate.laws.{our_name}.")


def topological_order(roots):
    """Return the roots and all expressions in them, operands first, a list."""
    order, waiting = {}, list(reversed(list(roots)))
    while waiting:
        missing = [operand for operand in waiting[-1].operands if operand not in order]
        if missing:
            waiting += reversed(missing)
        else:
            order[waiting.pop()] = True
    return list(order)
