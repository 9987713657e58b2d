"""Taylor coefficients by recurrences, of quantities in a graph (series.py).

Each sum, product, quotient and exponential has a rule by which its coefficient of order k in time
follows from those of lower order (Moore 1966; Jorba & Zou 2005
doi:10.1080/10586458.2005.10128904).  `expand` goes through these rules, order by order, with any
kind of numbers: those of code that is being compiled, too (tracing.py).
"""

from ..friction.taylor import Recurrences, convolution, times, total
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


class _Expansion(Recurrences):
    """Those of series.py."""

    def add(self, one, k):
        """Find the coefficient of order k, after those of lower order, and of its operands."""
        names = {"name": 1, "unknown": 1, "line": 2}.get(one.rule, 0)
        if one.rule == "number" and k == 0:
            self.c[one, 0] = one.operands[0]
        elif k < names:
            self.c[one, k] = self.known[one.operands[k]]
        elif names == 0 and (k == 0 or not one.is_constant):
            self.c[one, k] = getattr(self, f"_{one.rule}")(k, one, *one.operands)

    def _linear(self, one):
        if one not in self.terms:
            self.terms[one] = [(1.0, one)]
            if one.rule == "sum" and not one.is_constant:
                self.terms[one] = [term for x in one.operands for term in self._linear(x)]
            if one.rule == "product" and one.operands[0].is_constant and not one.is_constant:
                factor, x = one.operands
                self.terms[one] = self._scaled(self._linear(x), self.at(factor, 0))
        return self.terms[one]

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
