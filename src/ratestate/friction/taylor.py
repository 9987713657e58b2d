"""Taylor coefficients in time of expressions, by recurrences.

Each sum, product, quotient and function has a rule by which its coefficient of order k in time
follows from those of lower order (Moore 1966; Jorba & Zou 2005
doi:10.1080/10586458.2005.10128904).  `expand` goes through these rules, order by order, with
numbers of any kind.
"""

import functools
import operator

from .functions import DERIVATIVES
from .rewriting import function_of


class NoSeries(TypeError):
    """An expression has no rule here, as a choice has none."""


def expand(derivatives, integrands, order, known):
    """Coefficients up to an order of each unknown, and of each integrand up to one less.

    Lists, in which None is a coefficient that is always 0.

    derivatives : dict unknown symbol -> its derivative in time, an expression
    integrands : expressions
    known : dict expression -> its value at the start, of each symbol and of what else is known; of
        a symbol that changes at a constant rate a pair, its value and that rate
    """
    found = _Expansion(known)
    nodes = found.ordered([*derivatives, *derivatives.values(), *integrands])
    for k in range(order):
        for one in nodes:
            found.add(one, k)
        for unknown, derivative in derivatives.items():
            found.add_slope(unknown, k + 1, found.at(derivative, k))
    unknowns = [[found.at(one, k) for k in range(order + 1)] for one in derivatives]
    return unknowns, [[found.at(one, k) for k in range(order)] for one in integrands]


class _Expansion:
    """Coefficients of expressions, as far as they are found; None is one that is always 0.

    Each order waits for the one before.  So what is known last is added last, and by as few
    operations as there can be: an unknown's coefficient as its slope, of which that is a part.
    """

    def __init__(self, known):
        self.known = known
        self.rules = {}  # expression -> what `_rule` gives
        self.c = {}  # (expression, order) -> coefficient
        self.slopes = {}  # (expression, j) -> j times the coefficient of order j
        self.terms = {}  # expression -> what `_linear` gives
        self.over = {}  # quotient -> its dividend's terms over the divisor; and one over that

    def at(self, one, k):
        """The coefficient of order k; None beyond those of constants and lines."""
        return self.c.get((one, k))

    def add_slope(self, one, j, value):
        """Let j times the coefficient of order j be this."""
        self.slopes[one, j] = value
        self.c[one, j] = times(value, 1.0 / j)

    def _slope(self, one, j):
        if (one, j) not in self.slopes:
            terms = self._linear(one)
            if terms[0][1] is one:
                self.slopes[one, j] = times(self.at(one, j), float(j))
            else:
                self.slopes[one, j] = total(times(a, self._slope(x, j)) for a, x in terms)
        return self.slopes[one, j]

    def _scaled(self, terms, factor):
        return [(times(factor, a), x) for a, x in terms]

    def _combination(self, terms, k):
        """The coefficient of order k of a sum of such terms."""
        early = [times(a, self.at(x, k)) for a, x in terms if (x, k) not in self.slopes]
        late = [(times(a, 1.0 / k), x) for a, x in terms if (x, k) in self.slopes]
        return total([*early, *(times(a, self.slopes[x, k]) for a, x in late)])

    def _quotient(self, k, one, x, y):
        if k == 0:
            inverse = 1.0 / self.at(y, 0)
            self.over[one] = self._scaled(self._linear(x), inverse), inverse
            return self._combination(self.over[one][0], 0)
        # x = q y: q_k = (x_k - sum_(j<k) q_j y_(k-j))/y_0
        terms, inverse = self.over[one]
        pairs = {j: (self.at(one, j), self.at(y, k - j)) for j in range(1, k)}
        less = times(convolution(pairs, k), inverse)
        last = times(times(self.at(one, 0), inverse), self.at(y, k))
        return total([_negative(less), self._combination(terms, k), _negative(last)])

    def ordered(self, roots):
        """All that some expressions follow from, and these, each after what it follows from."""
        nodes, waiting = {}, list(roots)

        def find(one):
            if one in nodes:
                return
            rule, *operands = self.rules.setdefault(one, _rule(one))
            if rule == "function":  # (of the other one it needs lower orders alone)
                waiting.append(operands.pop())
            for operand in operands:
                find(operand)
            nodes[one] = True

        while waiting:
            find(waiting.pop(0))
        return list(nodes)

    def add(self, one, k):
        """Find the coefficient of order k, after those of lower order, and of its operands."""
        rule, *operands = self.rules[one]
        if rule == "known":
            if (one, k) in self.c:  # of an unknown, from its slope
                return
            given = self.known.get(one)
            if k < 2 and isinstance(given, tuple):
                self.c[one, k] = given[k]
            elif k == 0:
                self.c[one, 0] = self._first(one)
        else:
            self.c[one, k] = getattr(self, f"_{rule}")(k, one, *operands)

    def _first(self, one):
        """The coefficient of order 0, from those of the operands if it is not known."""
        if (known := self.at(one, 0)) is not None:
            return known
        if one in self.known:
            return self.known[one]
        return _function(one)(*map(self._first, one.operands))[0]

    def _linear(self, one):
        """Constant factors and expressions whose sum it is: itself, if it is no sum."""
        if one not in self.terms:
            rule, *operands = self.rules[one]
            self.terms[one] = [(1.0, one)]
            if rule == "sum":
                self.terms[one] = [
                    (a * factor, x) for part, factor in one.parts for a, x in self._linear(part)
                ]
            elif rule == "multiple":
                factor, x = operands
                self.terms[one] = self._scaled(self._linear(x), self.at(factor, 0))
        return self.terms[one]

    def _sum(self, k, one, *_):
        return self._combination(self._linear(one), k)

    _multiple = _sum

    def _product(self, k, one, x, y):
        return convolution({j: (self.at(x, j), self.at(y, k - j)) for j in range(k + 1)}, k)

    def _function(self, k, one, x, inner):
        """From f' = inner x': k f_k = sum_j j x_j inner_(k-j)."""
        if k == 0:
            return self._first(one)
        pairs = {j: (self._slope(x, j), self.at(inner, k - j)) for j in range(1, k)}
        last = times(times(self.at(inner, 0), 1.0 / k), self._slope(x, k))
        return total([times(convolution(pairs, k), 1.0 / k), last])


@functools.cache
def _function(one):
    return function_of([one], one.operands)


def _rule(one):
    """By which rule an expression's coefficients follow, and from which expressions, a tuple."""
    if one.is_constant or one.kind in ("symbol", "positive"):
        return ("known",)
    if one.kind == "sum":
        return "sum", *one.operands
    if one.kind == "product":
        return _rule_of_product(one)
    if one.kind not in DERIVATIVES or one.kind == "abs":
        raise NoSeries(one.kind)
    (x,) = one.parts
    return "function", x, DERIVATIVES[one.kind](x, one)


def _rule_of_product(one):
    graph, parts = one.graph, dict(one.parts)
    constant = {base: n for base, n in parts.items() if base.is_constant}
    below = {base: -n for base, n in parts.items() if n < 0.0 and base not in constant}
    above = {base: n for base, n in parts.items() if n > 0.0 and base not in constant}
    if constant:
        rest = {base: n for base, n in parts.items() if base not in constant}
        return "multiple", graph.product(1.0, constant), graph.product(1.0, rest)
    if below:
        return "quotient", graph.product(1.0, above), graph.product(1.0, below)
    base, n = parts.popitem()
    if parts:
        return "product", graph.product(1.0, parts), graph.product(1.0, {base: n})
    if n != int(n):  # y' = n (y/x) x'
        return "function", base, n * (one / base)
    return "product", graph.product(1.0, {base: n - 1.0}), base


def _negative(x):
    return None if x is None else -x


def times(x, y):
    """The product of two coefficients; None is 0."""
    if x is None or y is None:
        return None
    if isinstance(x, float) and x == 1.0:
        return y
    return x * y


def total(terms):
    """The sum of coefficients that are not None, from the left; None if all are."""
    known = [one for one in terms if one is not None]
    return functools.reduce(operator.add, known) if known else None


def convolution(pairs, k):
    """The sum of products of which the factors are of order j and k - j, by j.

    Those that are known last are added last.
    """
    ordered = sorted(pairs, key=lambda j: max(j, k - j))
    return total([times(*pairs[j]) for j in ordered])
