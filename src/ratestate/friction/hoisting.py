"""What is constant in expressions, apart: it is computed once, before all else."""

from .expressions import Graph


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
        if x.is_constant:
            return self._symbol(x)
        if x.kind == "symbol":
            return self.graph.symbol(x.parts[0], is_constant=False)
        if x.kind == "sum":
            terms = x.terms
            total = self._symbol(x.graph.sum({one: n for one, n in terms.items() if one.is_constant}))
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
        return self._symbol(x.graph.product(factor * inner, constant)) * self.graph.product(1.0, rest)

    def _symbol(self, constant):
        if constant.kind == "number":
            return self.graph.number(constant.parts[0])
        if constant not in self._symbols:
            symbol = self.graph.symbol(("p", len(self._symbols)))
            self._symbols[constant], self.constants[symbol] = symbol, constant
        return self._symbols[constant]
