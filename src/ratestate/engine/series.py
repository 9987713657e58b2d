"""Recurrences of Taylor coefficients, as code, from the formulas of a law.

The methods of a law are arithmetic.  Given `Series` instead of numbers they give the equations of
motion as a graph of sums, products, quotients and exponentials, each of which has a rule by which
its coefficient of order k in time follows from those of lower order (Moore 1966; Jorba & Zou 2005
doi:10.1080/10586458.2005.10128904).  `code` writes these rules out, order by order, as one
straight line of arithmetic, which loops over lanes can vectorise.
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
        self.name = f"s{len(graph.nodes)}"

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
    """The `Series` of some equations, each of them once, in the order in which they follow."""

    def __init__(self):
        self.nodes, self.known = [], {}

    def series(self, x):
        """A number as a `Series`; one that is a `Series` as it is."""
        if isinstance(x, Series):
            return x
        if not isinstance(x, (int, float)) or not math.isfinite(x):
            raise NotASeries(f"{x!r}")
        return self._node("number", repr(float(x)))

    def name(self, name):
        """A constant that has this name in the code."""
        return self._node("name", name)

    def unknown(self, name):
        """A series whose first coefficient has this name; `code` is given its derivative."""
        return self._node("unknown", name)

    def line(self, start, slope):
        """A series of two coefficients, which have these names."""
        return self._node("line", start, slope)

    def exp(self, x, start, rate=1.0):
        """A series proportional to e**(rate x), whose first coefficient is the expression start."""
        if x.is_constant:
            return self.name(start)
        if x.rule == "product" and x.operands[0].rule == "number":
            factor, x = x.operands
            return self.exp(x, start, rate * float(factor.operands[0]))
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

    def _is(self, x, value):
        return x.rule == "number" and float(x.operands[0]) == value

    def _node(self, rule, *operands):
        key = (rule, *(id(one) if isinstance(one, Series) else one for one in operands))
        if key not in self.known:
            self.known[key] = one = self._folded(rule, operands)
            if not any(one is other for other in self.nodes):
                self.nodes.append(one)
        return self.known[key]

    def _folded(self, rule, operands):
        """A node; a number where it is arithmetic of numbers."""
        of = [one for one in operands if isinstance(one, Series)]
        if of and rule in ("sum", "product") and all(one.rule == "number" for one in of):
            x, y = (float(one.operands[0]) for one in of)
            return self.series(x + y if rule == "sum" else x * y)
        return Series(self, rule, *operands)


def code(graph, derivatives, integrands, order):
    """Lines (list of str) that compute coefficients up to an order, and names of these.

    derivatives : dict unknown `Series` -> its derivative in time, a `Series`
    integrands : `Series` whose coefficients are wanted up to one order less

    The names are those of each unknown (tuple of order + 1), and of each integrand (of order).
    """
    needed = _needed([*derivatives.values(), *integrands])
    nodes = [one for one in graph.nodes if id(one) in needed]
    lines = [f"{one.name} = {_constant(one)}" for one in nodes if one.is_constant]
    lines += [f"{one.name}_0 = {one.operands[0]}" for one in derivatives]
    exponents = {id(one.operands[0]): one.operands[0] for one in nodes if one.rule == "exp"}
    slopes = {one.name: [""] for one in exponents.values()}  # names of j x_j, by j
    for k in range(order):
        for one in nodes:
            if not one.is_constant and one.rule not in ("unknown", "line"):
                lines.append(f"{one.name}_{k} = {_coefficient(one, k, slopes)}")
                if one.name in slopes and k:
                    slopes[one.name].append(f"{one.name}_slope_{k}")
                    lines.append(f"{one.name}_slope_{k} = {float(k)!r} * {one.name}_{k}")
        for unknown, derivative in derivatives.items():
            value = _at(derivative, k)
            slopes.setdefault(unknown.name, [""]).append(value)
            lines.append(f"{unknown.name}_{k + 1} = {value or '0.0'} * {1.0 / (k + 1)!r}")
    unknowns = [[f"{one.name}_{k}" for k in range(order + 1)] for one in derivatives]
    return lines, unknowns, [[_at(one, k) or "0.0" for k in range(order)] for one in integrands]


def _needed(series):
    """The ids of those from which these follow, and of these."""
    found, todo = set(), list(series)
    while todo:
        one = todo.pop()
        if id(one) not in found:
            found.add(id(one))
            todo += [x for x in one.operands if isinstance(x, Series)]
    return found


def _constant(one):
    """The expression of a constant."""
    if one.rule in ("number", "name"):
        return one.operands[0]
    sign = {"sum": "+", "product": "*", "quotient": "/"}[one.rule]
    return f"{one.operands[0].name} {sign} {one.operands[1].name}"


def _at(one, k):
    """The coefficient of order k of a series as it is called in the code; "" where that is 0."""
    if one.is_constant:
        return "" if k else one.name
    if one.rule == "line":
        return one.operands[k] if k < 2 else ""
    return f"{one.name}_{k}"


def _coefficient(one, k, slopes):
    """The expression of the coefficient of order k; slopes : name -> names of j x_j, by j."""
    if one.rule == "exp":
        x, start, rate = one.operands
        if k == 0:
            return start
        # k e_k = rate sum_j j x_j e_(k-j)
        whole = _total((slopes[x.name][j], f"{one.name}_{k - j}") for j in range(1, k + 1))
        return f"({whole}) * {rate / k!r}"
    x, y = one.operands
    if one.rule == "sum":
        return " + ".join(filter(None, (_at(x, k), _at(y, k)))) or "0.0"
    if one.rule == "product":
        return _total((_at(x, j), _at(y, k - j)) for j in range(k + 1))
    # x = q y: q_k = (x_k - sum_(j<k) q_j y_(k-j))/y_0
    less = "".join(f" - {one.name}_{j} * {_at(y, k - j)}" for j in range(k) if _at(y, k - j))
    return f"({_at(x, k) or '0.0'}{less}) / {_at(y, 0)}"


def _total(pairs):
    """The sum of products of factors that are not 0, those last that are known last."""
    pairs = list(pairs)
    middle = (len(pairs) - 1) / 2
    ordered = sorted(range(len(pairs)), key=lambda j: abs(j - middle))
    known = [pairs[j] for j in ordered if all(pairs[j])]
    return " + ".join(f"{x} * {y}" for x, y in known) or "0.0"
