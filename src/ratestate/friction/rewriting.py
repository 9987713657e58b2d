"""Turn expressions into derivatives, constant coefficients and Python functions."""

import functools
import operator

import numpy as np

from . import functions
from .expressions import CONDITIONS, Graph
from .functions import DERIVATIVES, where


def distribute(x, factor):
    """Return x times a factor, multiplied into each term of x if it is a sum."""
    if x.kind == "sum" and len(x.parts) > 1:
        products = (n * distribute(term, factor) for term, n in x.parts)
        return functools.reduce(operator.add, products)
    outer, powers = x.powers
    varying = {base: n for base, n in powers.items() if not base.is_constant}
    if [(base.kind, n) for base, n in varying.items()] != [("sum", 1.0)]:
        return x * factor
    (only_sum,) = varying
    del powers[only_sum]
    return distribute(only_sum, x.graph.product(outer, powers) * factor)


class Derivative:
    """The derivative of expressions of one graph, computed by calling it.

    changes : dict symbol -> its derivative, an expression; other symbols have the derivative 0
    """

    def __init__(self, graph, changes):
        self.graph, self.derivatives = graph, dict(changes)

    def __call__(self, x):
        if x not in self.derivatives:
            self.derivatives[x] = self.graph.number(0.0) if x.is_constant else self._derivative(x)
        return self.derivatives[x]

    def _derivative(self, x):
        total = self.graph.number(0.0)
        if x.kind == "sum":
            for term, factor in x.parts:
                total = total + factor * self(term)
        elif x.kind == "product":
            for base, exponent in x.parts:
                others = self.graph.product(1.0, {**dict(x.parts), base: exponent - 1.0})
                total = total + exponent * others * self(base)
        elif x.kind == "where":
            condition, if_true, if_false = x.parts
            return where(condition, self(if_true), self(if_false))
        elif x.kind in DERIVATIVES:
            (argument,) = x.parts
            return DERIVATIVES[x.kind](argument, x) * self(argument)
        return total


class Hoisting:
    """A copy of expressions in a new graph, with symbols for their constant parts.

    constants : dict symbol -> the constant expression that it replaces
    """

    def __init__(self):
        self.graph, self.constants = Graph(merges=False), {}
        self._symbols, self._copies = {}, {}

    def __call__(self, x):
        if x not in self._copies:
            self._copies[x] = self._hoist(x)
        return self._copies[x]

    def _hoist(self, x):
        if x.is_constant and x.kind not in CONDITIONS:
            return self._symbol_for(x)
        if x.kind == "symbol":
            return self.graph.symbol(x.parts[0], is_constant=False)
        if x.kind not in ("sum", "product"):
            return self.graph.call(x.kind, *map(self, x.parts))
        constant = {term: n for term, n in x.terms.items() if term.is_constant}
        total = self._symbol_for(x.graph.sum(constant))
        for term, factor in x.terms.items():
            if not term.is_constant:
                total = total + self._multiple(term, factor)
        return total

    def _multiple(self, x, factor):
        """Return a multiple of an expression, with its constant factors as one symbol."""
        inner_factor, powers = x.powers
        constant = {base: n for base, n in powers.items() if base.is_constant}
        varying = {self(base): n for base, n in powers.items() if base not in constant}
        coefficient = self._symbol_for(x.graph.product(factor * inner_factor, constant))
        return coefficient * self.graph.product(1.0, varying)

    def _symbol_for(self, constant):
        if constant.kind == "number":
            return self.graph.number(constant.parts[0])
        if constant not in self._symbols:
            symbol = self.graph.symbol(("p", len(self._symbols)))
            self._symbols[constant], self.constants[symbol] = symbol, constant
        return self._symbols[constant]


def values_of(roots, inputs):
    """Return the values of expressions, a list of numbers of any kind.

    inputs : expression -> value, for each symbol and perhaps other expressions
    """
    if not (roots := tuple(roots)):
        return []
    programs, key = roots[0].graph.programs, (roots, tuple(inputs))
    if key not in programs:
        scope = {**vars(functions), "power": _power}
        exec(source_of(*key), scope)
        programs[key] = scope["value"]
    with np.errstate(all="ignore"):  # the side that `where` does not select may be NaN
        return programs[key](*inputs.values())


def source_of(roots, inputs):
    """Return the source of a function of inputs, which also identifies the expressions in roots."""
    names = {node: f"x{k}" for k, node in enumerate(inputs)}
    lines = [f"def value({', '.join(names.values())}):"]

    def name(node):
        if node.kind == "number":
            return repr(node.parts[0])
        if node not in names:
            if not node.operands:
                raise LookupError(f"no value is given for the symbol {node.parts[0]!r}")
            text = _text(node, name)
            names[node] = f"t{len(lines)}"
            lines.append(f"{names[node]} = {text}")
        return names[node]

    results = ", ".join(map(name, roots))
    return "\n    ".join([*lines, f"return [{results}]"])


def _text(x, name):
    """Return an expression as Python text; name : function that names an operand."""
    if x.kind == "sum":
        return _text_of_sum(x, name)
    if x.kind == "product":
        dividend, divisor = (
            " * ".join(
                name(base) if n == sign else f"power({name(base)}, {abs(n)!r})"
                for base, n in x.parts
                if n * sign > 0.0
            )
            for sign in (1.0, -1.0)
        )
        return f"{dividend or 1.0} / ({divisor})" if divisor else dividend
    arguments = map(name, x.parts)
    if x.kind in CONDITIONS:
        return CONDITIONS[x.kind].join(arguments)
    return f"{x.kind}({', '.join(arguments)})"


def _text_of_sum(x, name):
    if len(x.parts) == 2:
        (first, a), (second, b) = sorted(x.parts, key=lambda part: part[0].kind != "number")
        if first.kind == "number" and second.kind == "exp" and b == -a:
            return f"{b!r} * expm1({name(second.parts[0])})"
    text = ""
    for term, factor in x.parts:
        if term.kind == "number":
            text += f" + {factor!r}"
        elif abs(factor) == 1.0:
            text += f" {'+' if factor > 0.0 else '-'} {name(term)}"
        else:
            text += f" + {factor!r} * {name(term)}"
    return text.removeprefix(" + ").strip()


def _power(x, exponent):
    """Return x**exponent, for an exponent > 0."""
    integer = int(exponent)
    if exponent - integer == 0.5:
        root = functions.sqrt(x)
        return root if integer == 0 else root * _power(x, integer)
    if exponent != integer:
        return functions.exp(exponent * functions.log(x))
    if integer == 1:
        return x
    half = _power(x, integer // 2)
    return half * half if integer % 2 == 0 else half * half * x
