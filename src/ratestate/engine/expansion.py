"""Taylor coefficients by recurrences, of quantities in a graph (series.py).

Each sum, product, quotient and exponential has a rule by which its coefficient of order k in time
follows from those of lower order (Moore 1966; Jorba & Zou 2005
doi:10.1080/10586458.2005.10128904).  `expand` goes through these rules, order by order, with any
kind of numbers: those of code that is being compiled, too (tracing.py).
"""

from ..friction.taylor import convolution, times, total
from .series import Series


def expand(derivatives, integrands, order, known):
    """Coefficients up to an order of each unknown, and of each integrand up to one less.

    Lists, in which None is a coefficient that is always 0.

    derivatives : dict unknown `Series` -> its derivative in time, a `Series`
    integrands : `Series`
    known : dict name -> number
    """
    found = _Expansion(known)
    nodes = _needed([*derivatives.values(), *integrands])
    for k in range(order):
        for one in nodes:
            found.add(one, k)
        for unknown, derivative in derivatives.items():
            found.add(unknown, 0)
            found.add_slope(unknown, k + 1, found.at(derivative, k))
    unknowns = [[found.at(one, k) for k in range(order + 1)] for one in derivatives]
    return unknowns, [[found.at(one, k) for k in range(order)] for one in integrands]


def _needed(series):
    """Those from which these follow, and these, each after those from which it follows."""
    found = {}

    def find(one):
        if one not in found:
            for operand in one.operands:
                if isinstance(operand, Series):
                    find(operand)
            found[one] = True

    for one in series:
        find(one)
    return found


class _Expansion:
    """Coefficients of `Series`, as far as they are found; None is one that is always 0.

    Each order waits for the one before.  So what is known last is added last, and by as few
    operations as there can be: an unknown's coefficient as its slope, of which that is a part.
    """

    def __init__(self, known):
        self.known = known
        self.c = {}  # (series, order) -> coefficient
        self.slopes = {}  # (series, j) -> j times the coefficient of order j
        self.terms = {}  # series -> what `_linear` gives
        self.over = {}  # quotient -> its dividend's terms over the divisor; and one over that

    def at(self, one, k):
        """The coefficient of order k of a series; 0 beyond those of constants and lines."""
        return self.c.get((one, k))

    def add(self, one, k):
        """Find the coefficient of order k, after those of lower order, and of its operands."""
        names = {"name": 1, "unknown": 1, "line": 2}.get(one.rule, 0)
        if one.rule == "number" and k == 0:
            self.c[one, 0] = one.operands[0]
        elif k < names:
            self.c[one, k] = self.known[one.operands[k]]
        elif names == 0 and (k == 0 or not one.is_constant):
            self.c[one, k] = getattr(self, f"_{one.rule}")(k, one, *one.operands)

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

    def _linear(self, one):
        """Constant factors and series whose sum it is: itself, if it is no sum."""
        if one not in self.terms:
            self.terms[one] = [(1.0, one)]
            if one.rule == "sum" and not one.is_constant:
                self.terms[one] = [term for x in one.operands for term in self._linear(x)]
            if one.rule == "product" and one.operands[0].is_constant and not one.is_constant:
                factor, x = one.operands
                self.terms[one] = self._scaled(self._linear(x), self.at(factor, 0))
        return self.terms[one]

    def _scaled(self, terms, factor):
        return [(times(factor, a), x) for a, x in terms]

    def _combination(self, terms, k):
        """The coefficient of order k of a sum of such terms."""
        early = [times(a, self.at(x, k)) for a, x in terms if (x, k) not in self.slopes]
        late = [(times(a, 1.0 / k), x) for a, x in terms if (x, k) in self.slopes]
        return total([*early, *(times(a, self.slopes[x, k]) for a, x in late)])

    def _exp(self, k, one, x, start, rate):
        if k == 0:
            return self.known[start]
        # k e_k = rate sum_j j x_j e_(k-j)
        pairs = {j: (self._slope(x, j), self.at(one, k - j)) for j in range(1, k)}
        last = times(times(self.at(one, 0), rate / k), self._slope(x, k))
        return total([times(convolution(pairs, k), rate / k), last])

    def _sum(self, k, one, x, y):
        if one.is_constant:
            return self.at(x, 0) + self.at(y, 0)
        return self._combination(self._linear(one), k)

    def _product(self, k, one, x, y):
        if x.is_constant and not y.is_constant:
            return self._combination(self._linear(one), k)
        return convolution({j: (self.at(x, j), self.at(y, k - j)) for j in range(k + 1)}, k)

    def _quotient(self, k, one, x, y):
        if k == 0:
            inverse = 1.0 / self.at(y, 0)
            self.over[one] = self._scaled(self._linear(x), inverse), inverse
            return self._combination(self.over[one][0], 0)
        # x = q y: q_k = (x_k - sum_(j<k) q_j y_(k-j))/y_0
        terms, inverse = self.over[one]
        whole = self._combination(terms, k)
        pairs = {j: (self.at(one, j), self.at(y, k - j)) for j in range(1, k)}
        less = times(convolution(pairs, k), inverse)
        last = times(times(self.at(one, 0), inverse), self.at(y, k))
        return total([None if less is None else -less, whole, None if last is None else -last])
