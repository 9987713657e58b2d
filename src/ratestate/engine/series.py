"""The formulas of a law as a graph of quantities, which are series in time.

The methods of a law are arithmetic.  Given `Series` instead of numbers they give the equations of
motion as sums, products, quotients and exponentials, whose coefficients expansion.py finds.
"""

import math

#: of which the product is written out
LARGEST_POWER = 16


class NotASeries(TypeError):
    """A formula holds what has no rule here."""


class Series:
    """A quantity of which the coefficients are known by a rule, or a constant; immutable."""

    def __init__(self, graph, rule, *operands):
        self.graph, self.rule, self.operands = graph, rule, operands
        self.is_constant = rule in ("number", "name") or (
            rule in ("sum", "product", "quotient") and all(one.is_constant for one in operands)
        )

    def __add__(self, other):
        return self.graph.sum(self, other)

    def __radd__(self, other):
        return self.graph.sum(other, self)

    def __sub__(self, other):
        return self.graph.sum(self, -self.graph.series(other))

    def __rsub__(self, other):
        return self.graph.sum(other, -self)

    def __mul__(self, other):
        return self.graph.product(self, other)

    def __rmul__(self, other):
        return self.graph.product(other, self)

    def __truediv__(self, other):
        return self.graph.quotient(self, other)

    def __rtruediv__(self, other):
        return self.graph.quotient(other, self)

    def __neg__(self):
        return self.graph.product(-1.0, self)

    def __pow__(self, power):
        if not isinstance(power, int) or not 1 <= power <= LARGEST_POWER:
            raise NotASeries(f"a power of {power!r}")
        return self if power == 1 else self * self ** (power - 1)

    def __bool__(self):
        raise NotASeries("a condition")

    def __eq__(self, other):
        raise NotASeries("a comparison")

    __hash__ = object.__hash__


class Graph:
    """The `Series` of some equations, each of them once."""

    def __init__(self):
        self.known = {}

    def series(self, x):
        """A number as a `Series`; one that is a `Series` as it is."""
        if isinstance(x, Series):
            return x
        if not isinstance(x, (int, float)) or not math.isfinite(x):
            raise NotASeries(f"{x!r}")
        return self._node("number", float(x))

    def name(self, name):
        """A constant that is known by this name."""
        return self._node("name", name)

    def unknown(self, name):
        """A series whose first coefficient has this name; `expand` is given its derivative."""
        return self._node("unknown", name)

    def line(self, start, slope):
        """A series of two coefficients, which have these names."""
        return self._node("line", start, slope)

    def exp(self, x, start, rate=1.0):
        """A series proportional to e**(rate x), whose first coefficient is known by a name."""
        if x.is_constant:
            return self.name(start)
        if x.rule == "product" and x.operands[0].rule == "number":
            factor, x = x.operands
            return self.exp(x, start, rate * factor.operands[0])
        return self._node("exp", x, start, rate)

    def sum(self, x, y):
        """x + y."""
        x, y = self.series(x), self.series(y)
        if self._is(x, 0.0) or self._is(y, 0.0):
            return y if self._is(x, 0.0) else x
        return self._node("sum", x, y)

    def product(self, x, y):
        """x y."""
        x, y = self.series(x), self.series(y)
        if y.is_constant and not x.is_constant:
            x, y = y, x
        if self._is(x, 0.0) or self._is(x, 1.0):
            return x if self._is(x, 0.0) else y
        if x.is_constant and y.rule == "product" and y.operands[0].is_constant:
            return self._node("product", self.product(x, y.operands[0]), y.operands[1])
        return self._node("product", x, y)

    def quotient(self, x, y):
        """x/y."""
        return self._node("quotient", self.series(x), self.series(y))

    def differential(self, x, changes):
        """How x changes, to first order, where unknowns do.

        changes : dict unknown `Series` -> its change, a `Series`; all that is found is added
        """
        if x.is_constant or x.rule == "line":
            return self.series(0.0)
        if x not in changes:
            changes[x] = self._differential(x, changes)
        return changes[x]

    def _differential(self, x, changes):
        if x.rule == "exp":
            exponent, _, rate = x.operands
            return rate * (x * self.differential(exponent, changes))
        one, other = x.operands
        d_one, d_other = (self.differential(part, changes) for part in x.operands)
        if x.rule == "sum":
            return d_one + d_other
        if x.rule == "product":
            return d_one * other + one * d_other
        return (d_one - x * d_other) / other

    def _is(self, x, value):
        return x.rule == "number" and x.operands[0] == value

    def _node(self, rule, *operands):
        key = (rule, *(id(one) if isinstance(one, Series) else one for one in operands))
        if key not in self.known:
            self.known[key] = self._folded(rule, operands)
        return self.known[key]

    def _folded(self, rule, operands):
        """A node; a number where it is arithmetic of numbers."""
        of = [one for one in operands if isinstance(one, Series)]
        if of and rule in ("sum", "product") and all(one.rule == "number" for one in of):
            x, y = (one.operands[0] for one in of)
            return self.series(x + y if rule == "sum" else x * y)
        return Series(self, rule, *operands)
