"""Taylor coefficients in time of expressions, by recurrences.

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


def expand(derivatives, integrands, order, known):
    """Return lists of Taylor coefficients of unknowns and of integrands.

    Those of integrands end one order before `order`.  A coefficient that is always 0 is the float
    0.0.

    derivatives : dict unknown symbol -> its derivative in time, an expression
    integrands : expressions
    start : dict expression -> value at the start, for each symbol and perhaps other expressions; a
        pair of value and rate for a symbol that changes at a constant rate
    """
    found = _Expansion(known)
    nodes = found.ordered([*derivatives, *derivatives.values(), *integrands])
    for k in range(order):
        for one in nodes:
            found.add(one, k)
        for unknown, derivative in derivatives.items():
            found.slopes[unknown, k + 1] = slope = found.at(derivative, k)
            found.c[unknown, k + 1] = times(slope, 1.0 / (k + 1))
    unknowns = [[found.at(one, k) for k in range(order + 1)] for one in derivatives]
    return unknowns, [[found.at(one, k) for k in range(order)] for one in integrands]


class _Expansion:
    """The coefficients of expressions that are known so far.

    Each order waits for the order before.  So the terms that are known last are added last, in few
    operations: a sum takes the slopes of the unknowns instead of their coefficients.
    """

    def __init__(self, known):
        self.known = known
        self.rules = {}  # expression -> its `_rule`
        self.c = {}  # (expression, order) -> coefficient
        self.slopes = {}  # (expression, j) -> j times the coefficient of order j
        self.terms = {}  # expression -> its `_linear_terms`
        self.over = {}  # quotient -> terms of its dividend divided by the divisor; 1/divisor

    def ordered(self, roots):
        """Return the roots and all that their rules need, operands first, a list."""
        nodes, waiting = {}, list(roots)

        def find(one):
            if one in nodes:
                return
            rule, *operands = self.rules.setdefault(one, _rule(one))
            if rule == "function":  # the rule needs only lower orders of `inner`
                waiting.append(operands.pop())
            for operand in operands:
                find(operand)
            nodes[one] = True

        while waiting:
            find(waiting.pop(0))
        return list(nodes)

    def at(self, one, k):
        """Return the coefficient of order k; 0 if the expression has none."""
        return self.c.get((one, k), 0.0)

    def add(self, one, k):
        """Compute the coefficient of order k; lower orders and operands come first."""
        rule, *operands = self.rules[one]
        if rule != "known":
            self.c[one, k] = getattr(self, f"_{rule}")(k, one, *operands)
        elif k < 2 and isinstance(self.known.get(one), tuple):
            self.c[one, k] = self.known[one][k]
        elif k == 0:
            self.c[one, 0] = self._first(one)

    def _first(self, one):
        """Return the coefficient of order 0, from the operands unless it is given."""
        if (one, 0) in self.c:
            return self.c[one, 0]
        if one in self.known:
            return self.known[one]
        return values_of([one], {x: self._first(x) for x in one.operands})[0]

    def _linear(self, one):
        """Return the expression as a sum: pairs of a constant factor and an expression."""
        if one not in self.terms:
            rule, *operands = self.rules[one]
            self.terms[one] = [(1.0, one)]
            if rule == "sum":
                self.terms[one] = [
                    (a * factor, x) for part, factor in one.parts for a, x in self._linear(part)
                ]
            elif rule == "multiple":
                factor, x = operands
                self.terms[one] = _scaled(self._linear(x), self.at(factor, 0))
        return self.terms[one]

    def _slope(self, one, j):
        if (one, j) not in self.slopes:
            terms = self._linear(one)
            if terms[0][1] is one:
                self.slopes[one, j] = times(self.at(one, j), float(j))
            else:
                self.slopes[one, j] = total(times(a, self._slope(x, j)) for a, x in terms)
        return self.slopes[one, j]

    def _combination(self, terms, k):
        """Return the coefficient of order k of a sum of such terms."""
        early = [times(a, self.at(x, k)) for a, x in terms if (x, k) not in self.slopes]
        late = [(times(a, 1.0 / k), x) for a, x in terms if (x, k) in self.slopes]
        return total([*early, *(times(a, self.slopes[x, k]) for a, x in late)])

    def _sum(self, k, one, *_):
        return self._combination(self._linear(one), k)

    _multiple = _sum

    def _product(self, k, one, x, y):
        return convolution({j: (self.at(x, j), self.at(y, k - j)) for j in range(k + 1)}, k)

    def _quotient(self, k, one, x, y):
        if k == 0:
            inverse = 1.0 / self.at(y, 0)
            self.over[one] = _scaled(self._linear(x), inverse), inverse
            return self._combination(self.over[one][0], 0)
        # x = q y: q_k = (x_k - sum_(j<k) q_j y_(k-j))/y_0
        terms, inverse = self.over[one]
        pairs = {j: (self.at(one, j), self.at(y, k - j)) for j in range(1, k)}
        less = times(convolution(pairs, k), inverse)
        last = times(times(self.at(one, 0), inverse), self.at(y, k))
        return total([-less, self._combination(terms, k), -last])

    def _function(self, k, one, x, inner):
        """Apply f' = inner x': k f_k = sum_j j x_j inner_(k-j)."""
        if k == 0:
            return self._first(one)
        pairs = {j: (self._slope(x, j), self.at(inner, k - j)) for j in range(1, k)}
        last = times(times(self.at(inner, 0), 1.0 / k), self._slope(x, k))
        return total([times(convolution(pairs, k), 1.0 / k), last])


def _rule(one):
    """Return the rule for an expression's coefficients, and its operands, a tuple."""
    if one.is_constant or one.kind == "symbol":
        return ("known",)
    if one.kind == "sum":
        return "sum", *one.operands
    if one.kind == "product":
        return _rule_of_product(one.graph, dict(one.parts), one)
    if one.kind not in DERIVATIVES or one.kind == "abs":
        raise NoSeries(one.kind)
    (x,) = one.parts
    return "function", x, DERIVATIVES[one.kind](x, one)


def _rule_of_product(graph, parts, one):
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
        return "function", base, n * (one / base)
    return "product", graph.product(1.0, {base: n - 1.0}), base


def _scaled(terms, factor):
    return [(times(factor, a), x) for a, x in terms]


def _is(x, number):
    return isinstance(x, float) and x == number


def times(x, y):
    """Return the product of two coefficients."""
    if _is(x, 0.0) or _is(y, 0.0):
        return 0.0
    return y if _is(x, 1.0) else x * y


def total(terms):
    """Return the sum of coefficients, from the left."""
    known = [one for one in terms if not _is(one, 0.0)]
    return functools.reduce(operator.add, known) if known else 0.0


def convolution(pairs, k):
    """Return the sum of products of orders j and k - j; late factors are added last."""
    return total(times(*pairs[j]) for j in sorted(pairs, key=lambda j: max(j, k - j)))
