"""Taylor series in time of expressions, by recurrences.

For each sum, product, quotient and function a rule gives the coefficient of order k in time from
coefficients of lower order (Moore 1966; Jorba & Zou 2005 doi:10.1080/10586458.2005.10128904).
`expand` applies these rules order by order, to numbers of any kind.
"""

import functools
import operator

from .functions import DERIVATIVES
from .rewriting import values_of


class NoSeries(TypeError):
    """An expression, such as a choice, has no rule for its coefficients."""


def expand(derivatives, integrands, order, start):
    """Return lists of Taylor coefficients of unknowns and of integrands.

    Integrands have one order less than unknowns.  A coefficient that is always 0 is the float 0.0.

    derivatives : dict unknown symbol -> its derivative in time, an expression
    integrands : expressions
    start : dict expression -> value at the start, for each symbol and perhaps other expressions; a
        pair of value and rate for a symbol that changes at a constant rate
    """
    expansion = _Expansion(start)
    nodes = expansion.topological_order([*derivatives, *derivatives.values(), *integrands])
    for k in range(order):
        for node in nodes:
            expansion.add(node, k)
        for unknown, derivative in derivatives.items():
            expansion.slopes[unknown, k + 1] = slope = expansion.at(derivative, k)
            expansion.c[unknown, k + 1] = times(slope, 1.0 / (k + 1))
    unknowns = [[expansion.at(x, k) for k in range(order + 1)] for x in derivatives]
    return unknowns, [[expansion.at(x, k) for k in range(order)] for x in integrands]


class _Expansion:
    """The coefficients of expressions that are known so far.

    Each order waits for the order before.  So the terms that are known last are added last, in few
    operations: a sum takes the slopes of the unknowns instead of their coefficients.
    """

    def __init__(self, start):
        self.start = start
        self.rules = {}  # expression -> its `_rule`
        self.c = {}  # (expression, order) -> coefficient
        self.slopes = {}  # (expression, j) -> j times the coefficient of order j
        self.terms = {}  # expression -> its `_linear_terms`
        self.quotients = {}  # quotient -> terms of its dividend divided by the divisor; 1/divisor

    def topological_order(self, roots):
        """Return the roots and all that their rules need, operands first, a list."""
        nodes, waiting = {}, list(roots)

        def visit(node):
            if node in nodes:
                return
            rule, *operands = self.rules.setdefault(node, _rule(node))
            if rule == "function":  # the rule needs only lower orders of `inner`
                waiting.append(operands.pop())
            for operand in operands:
                visit(operand)
            nodes[node] = True

        while waiting:
            visit(waiting.pop(0))
        return list(nodes)

    def at(self, node, k):
        """Return the coefficient of order k; 0 if the expression has none."""
        return self.c.get((node, k), 0.0)

    def add(self, node, k):
        """Compute the coefficient of order k; lower orders and operands come first."""
        rule, *operands = self.rules[node]
        if rule != "known":
            self.c[node, k] = getattr(self, f"_{rule}")(k, node, *operands)
        elif k < 2 and isinstance(self.start.get(node), tuple):
            self.c[node, k] = self.start[node][k]
        elif k == 0:
            self.c[node, 0] = self._value_at_start(node)

    def _value_at_start(self, node):
        """Return the coefficient of order 0, from the operands unless it is given."""
        if (node, 0) in self.c:
            return self.c[node, 0]
        if node in self.start:
            return self.start[node]
        return values_of([node], {x: self._value_at_start(x) for x in node.operands})[0]

    def _linear_terms(self, node):
        """Return the expression as a sum: pairs of a constant factor and an expression."""
        if node not in self.terms:
            rule, *operands = self.rules[node]
            self.terms[node] = [(1.0, node)]
            if rule == "sum":
                parts = ((factor, self._linear_terms(part)) for part, factor in node.parts)
                self.terms[node] = [(a * factor, x) for factor, terms in parts for a, x in terms]
            elif rule == "multiple":
                factor, x = operands
                self.terms[node] = _scaled(self._linear_terms(x), self.at(factor, 0))
        return self.terms[node]

    def _slope(self, node, j):
        if (node, j) not in self.slopes:
            terms = self._linear_terms(node)
            if terms[0][1] is node:
                self.slopes[node, j] = times(self.at(node, j), float(j))
            else:
                self.slopes[node, j] = total(times(a, self._slope(x, j)) for a, x in terms)
        return self.slopes[node, j]

    def _combination(self, terms, k):
        """Return the coefficient of order k of a sum of such terms."""
        by_value = [times(a, self.at(x, k)) for a, x in terms if (x, k) not in self.slopes]
        by_slope = [(times(a, 1.0 / k), x) for a, x in terms if (x, k) in self.slopes]
        return total([*by_value, *(times(a, self.slopes[x, k]) for a, x in by_slope)])

    def _sum(self, k, node, *_):
        return self._combination(self._linear_terms(node), k)

    _multiple = _sum

    def _product(self, k, node, x, y):
        return convolution({j: (self.at(x, j), self.at(y, k - j)) for j in range(k + 1)}, k)

    def _quotient(self, k, node, x, y):
        if k == 0:
            inverse = 1.0 / self.at(y, 0)
            self.quotients[node] = _scaled(self._linear_terms(x), inverse), inverse
            return self._combination(self.quotients[node][0], 0)
        # x = q y: q_k = (x_k - sum_(j<k) q_j y_(k-j))/y_0
        terms, inverse = self.quotients[node]
        pairs = {j: (self.at(node, j), self.at(y, k - j)) for j in range(1, k)}
        products = times(convolution(pairs, k), inverse)
        last_term = times(times(self.at(node, 0), inverse), self.at(y, k))
        return total([-products, self._combination(terms, k), -last_term])

    def _function(self, k, node, x, inner):
        """Apply f' = inner x': k f_k = sum_j j x_j inner_(k-j)."""
        if k == 0:
            return self._value_at_start(node)
        pairs = {j: (self._slope(x, j), self.at(inner, k - j)) for j in range(1, k)}
        last_term = times(times(self.at(inner, 0), 1.0 / k), self._slope(x, k))
        return total([times(convolution(pairs, k), 1.0 / k), last_term])


def _rule(node):
    """Return the rule for an expression's coefficients, and its operands, a tuple."""
    if node.is_constant or node.kind == "symbol":
        return ("known",)
    if node.kind == "sum":
        return "sum", *node.operands
    if node.kind == "product":
        return _rule_of_product(node.graph, dict(node.parts), node)
    if node.kind not in DERIVATIVES or node.kind == "abs":
        raise NoSeries(node.kind)
    (x,) = node.parts
    return "function", x, DERIVATIVES[node.kind](x, node)


def _rule_of_product(graph, parts, node):
    def product(condition):
        return graph.product(1.0, {base: n for base, n in parts.items() if condition(base, n)})

    if any(base.is_constant for base in parts):
        varies = product(lambda base, n: not base.is_constant)
        return "multiple", product(lambda base, n: base.is_constant), varies
    if any(n < 0.0 for n in parts.values()):
        return "quotient", product(lambda base, n: n > 0.0), 1.0 / product(lambda base, n: n < 0.0)
    base, n = parts.popitem()
    if parts:
        return "product", graph.product(1.0, parts), graph.product(1.0, {base: n})
    if n != int(n):  # y' = n (y/x) x'
        return "function", base, n * (node / base)
    return "product", graph.product(1.0, {base: n - 1.0}), base


def _scaled(terms, factor):
    return [(times(factor, a), x) for a, x in terms]


def _is_float(x, number):
    return isinstance(x, float) and x == number


def times(x, y):
    """Return the product of two coefficients."""
    if _is_float(x, 0.0) or _is_float(y, 0.0):
        return 0.0
    return y if _is_float(x, 1.0) else x * y


def total(terms):
    """Return the sum of coefficients, from the left."""
    nonzero = [term for term in terms if not _is_float(term, 0.0)]
    return functools.reduce(operator.add, nonzero) if nonzero else 0.0


def convolution(pairs, k):
    """Return the sum of products of orders j and k - j; late factors are added last."""
    return total(times(*pairs[j]) for j in sorted(pairs, key=lambda j: max(j, k - j)))
