"""Expressions made anew: multiplied out, with others in the place of symbols, without constants."""

import functools
import operator

from .expressions import CONDITIONS, Graph, exp, log, ordered, power


def times_each(x, factor):
    """x times a factor, which multiplies each term of a sum, and of a constant times a sum."""
    if x.kind == "sum" and len(x.parts) > 1:
        products = (n * times_each(one, factor) for one, n in x.parts)
        return functools.reduce(operator.add, products)
    outer, powers = x.powers
    changing = {one: n for one, n in powers.items() if not one.is_constant}
    if [(one.kind, n) for one, n in changing.items()] != [("sum", 1.0)]:
        return x * factor
    (whole,) = changing
    del powers[whole]
    return times_each(whole, x.graph.product(outer, powers) * factor)


def replaced(x, by):
    """An expression with others in the place of symbols; by : dict symbol -> expression."""
    done = dict(by)
    for one in ordered([x]):
        if one not in done:
            done[one] = one if one.is_constant else _made_again(one, done)
    return done[x]


def _made_again(x, done):
    """An expression whose operands are replaced."""
    if x.kind == "sum":
        return sum((factor * done[one] for one, factor in x.parts), x.graph.number(0.0))
    if x.kind == "product":
        raised = (power(done[one], exponent) for one, exponent in x.parts)
        return functools.reduce(operator.mul, raised)
    arguments = [done[one] for one in x.parts]
    if x.kind in ("exp", "log"):
        return exp(*arguments) if x.kind == "exp" else log(*arguments)
    return x.graph.call(x.kind, *arguments)


class Hoisting:
    """Expressions in a new graph, in which symbols stand for what is constant in them.

    constants : dict symbol -> the constant expression that it stands for
    """

    def __init__(self):
        self.graph, self.constants = Graph(merges=False), {}
        self._symbols, self._done = {}, {}

    def __call__(self, x):
        """The new expression."""
        if x not in self._done:
            self._done[x] = self._made(x)
        return self._done[x]

    def _made(self, x):
        if x.kind in CONDITIONS:
            return self.graph.call(x.kind, *map(self, x.parts))
        if x.is_constant:
            return self._symbol(x)
        if x.kind == "symbol":
            return self.graph.symbol(x.parts[0], is_constant=False)
        if x.kind == "sum":
            terms = x.terms
            total = self._symbol(
                x.graph.sum({one: n for one, n in terms.items() if one.is_constant})
            )
            for one, factor in terms.items():
                if not one.is_constant:
                    total = total + self._multiple(one, factor)
            return total
        if x.kind == "product":
            return self._multiple(x, 1.0)
        return self.graph.call(x.kind, *map(self, x.parts))

    def _multiple(self, x, factor):
        """A multiple of an expression; what is constant in it is apart."""
        inner, powers = x.powers
        constant = {base: n for base, n in powers.items() if base.is_constant}
        rest = {self(base): n for base, n in powers.items() if not base.is_constant}
        return self._symbol(x.graph.product(factor * inner, constant)) * self.graph.product(
            1.0, rest
        )

    def _symbol(self, constant):
        if constant.kind == "number":
            return self.graph.number(constant.parts[0])
        if constant not in self._symbols:
            symbol = self.graph.symbol(("p", len(self._symbols)))
            self._symbols[constant], self.constants[symbol] = symbol, constant
        return self._symbols[constant]
