"""Derive state evolution and friction from a law's formulas, as functions of arrays.

The formulas, d theta/dt and perhaps friction, run once with expressions (expressions.py):

    V = V_ref exp(v),    theta_k = (D_k/V_ref) exp(psi_k),    T = t V_ref/Dc.

This yields d psi_k/dT and friction as expressions in v and psi.  Their constant parts are the
coefficients, which are computed once for each slider.  Derivatives, and values in numbers of any
kind, follow from the expressions (rewriting.py).
"""

import functools
from types import SimpleNamespace

import numpy as np

from .expressions import LIMIT, FormulaError, Graph, topological_order
from .functions import exp
from .rewriting import Hoisting, distribute, source_of, values_of

#: parameters of all sliders that are > 0
POSITIVE_PARAMETERS = ("a", "Dc", "V0")


class Equations:
    """d psi_k/dT and resistance R = (mu - mu_ref)/a as expressions in v and psi.

    law : the law with these formulas; names : symbols of the parameters that they may use

    Attributes
    ----------
    v, w, psi, kappa : the symbols; w = exp(v)
    rates, resistance : d psi_k/dT of each state, and R; all expressions to be computed are in lists
    exponentials, exponents : the exponentials in rates, except w, and their arguments
    runs_away : a condition, or None if the law has no criterion
    log_theta, variables : ln(V_ref theta_k/D_k) as a function of v and psi, and its inverse, whose
        argument is named psi too; None if both are the identity
    evolution_effects : b_k/a
    law_constants : name -> constant expression in a list, from the law's `constants`
    constants : symbol -> constant expression in parameters and V_ref: the coefficients
    friction_at_reference : mu_ref, a constant expression: mu at V_ref and theta_k = D_k/V_ref
    zeta : damping V_ref/(a sigma); None without damping
    """

    def __init__(self, law, names):
        graph = Graph()
        positive = {x for x, parameter in law.parameters.items() if parameter.bound == "> 0"}
        positive.update(POSITIVE_PARAMETERS)
        symbols = {x: graph.symbol(("p", x), is_positive=x in positive) for x in names}
        symbols["V_ref"] = V_ref = graph.symbol("V_ref", is_positive=True)
        if "damping" in symbols:
            symbols["sigma"] = graph.symbol("sigma", is_positive=True)
        v = graph.symbol("v", is_constant=False)
        psi = [graph.symbol(("psi", k), is_constant=False) for k in range(len(law.states))]
        kappa = graph.symbol("kappa", is_constant=False)
        p = SimpleNamespace(**{x: symbols[x] for x in names})
        b, D = zip(*((symbols[b], symbols[D]) for b, D in law.states.values()), strict=True)

        logs = law.log_theta(v, psi, p)
        V, ages = V_ref * exp(v), [exp(log) / V_ref for log in logs]
        theta = tuple(length * age for length, age in zip(D, ages, strict=True))
        d_theta = law.evolution(V, theta[0] if len(theta) == 1 else theta, p)
        rates = [
            distribute(rate, p.Dc / length * exp(-log))
            for rate, length, log in zip(_rates_of(d_theta, graph, law), D, logs, strict=True)
        ]
        mu = law.mu(V, theta, ages, p, b)
        mu = distribute(_as_expression(graph, mu, "friction"), graph.one)
        reference = {node: node for node in topological_order([mu]) if node.is_constant}
        reference |= dict.fromkeys([v, *psi], graph.number(0.0))
        mu_ref = law.reference(graph.number(*values_of([mu], reference)))
        self.friction_at_reference = [mu_ref]

        hoisting = Hoisting()
        self.graph, self.constants = hoisting.graph, hoisting.constants
        self._parameters = symbols
        self.evolution_effects = [hoisting(b_k / p.a) for b_k in b]
        self.rates = [hoisting(rate) for rate in rates]
        self.resistance = [hoisting(distribute(mu - mu_ref, 1.0 / p.a))]
        constants = law.constants(SimpleNamespace(**symbols), b)
        self.law_constants = {name: [hoisting(graph.number(x))] for name, x in constants.items()}
        self.v, self.kappa, *self.psi = map(hoisting, (v, kappa, *psi))
        self.w = hoisting(exp(v))
        if "damping" in symbols:
            zeta = p.damping * V_ref / (p.a * symbols["sigma"])
            self.zeta = hoisting(zeta)
            condition = (zeta <= 0.0) & (v > LIMIT)  # damping > 0 prevents runaway
        else:
            self.zeta, condition = None, law.runaway(v, tuple(psi), kappa, p)
        self.runs_away = None if condition is None else [hoisting(condition)]
        self.log_theta = self.variables = None
        if any(log is not psi_k for log, psi_k in zip(logs, psi, strict=True)):
            self.log_theta = [hoisting(log) for log in logs]
            self.variables = [hoisting(x) for x in law.variables_of(v, psi, p)]
        self.exponentials = [
            node
            for node in topological_order(self.rates)
            if node.kind == "exp" and not node.is_constant and node is not self.w
        ]
        self.exponents = [node.parts[0] for node in self.exponentials]

    def coefficients(self, V_ref, values):
        """Return the values p of the constant expressions, a tuple.

        values : symbol -> float or array, of the parameters [SI]
        """
        return tuple(self._values_from_parameters(self.constants.values(), V_ref, values))

    def reference_friction(self, V_ref, values):
        """Return mu_ref; values as for `coefficients`."""
        return self._values_from_parameters(self.friction_at_reference, V_ref, values)[0]

    def _values_from_parameters(self, expressions, V_ref, values):
        given = {**values, "V_ref": V_ref}
        inputs = {symbol: given[x] for x, symbol in self._parameters.items() if x in given}
        return values_of(expressions, {x: np.asarray(y, float)[()] for x, y in inputs.items()})

    @property
    def text(self):
        """Return a text that identifies these equations."""
        optional = self.runs_away, self.log_theta, self.variables, *self.law_constants.values()
        roots = [*self.evolution_effects, *self.rates, *self.resistance]
        roots += [root for group in optional for root in group or []]
        formulas = source_of(roots, [self.v, self.kappa, *self.psi, *self.constants])
        constants = [*self.constants.values(), *self.friction_at_reference]
        return f"{formulas}\n{source_of(constants, self._parameters.values())}"

    @functools.cached_property
    def used_parameters(self):
        """Return the symbols of the parameters in coefficients, a set; perhaps "V_ref"."""
        nodes = {*topological_order(self.constants.values())}
        return {name for name, symbol in self._parameters.items() if symbol in nodes}

    def values(self, expressions, v, psi, p, kappa=None):
        """Return the values of expressions at this v, psi (a tuple) and p, a list."""
        inputs = {self.v: v, self.kappa: kappa, **dict(zip(self.psi, psi, strict=False))}
        return values_of(expressions, inputs | dict(zip(self.constants, p, strict=False)))


def _rates_of(returned, graph, law):
    """Return the rates from `evolution` as expressions, one for each state."""
    rates = returned if isinstance(returned, tuple | list) else (returned,)
    if len(rates) != len(law.states):
        raise FormulaError(
            f"evolution returns {len(rates)} rates, and states has {len(law.states)}. Return "
            f"d theta/dt of each state, in the order of states.",
            "evolution",
        )
    return [_as_expression(graph, rate, "evolution") for rate in rates]


def _as_expression(graph, x, method):
    if x is None:
        raise FormulaError(f"{method} returns None. Return the value of the formula.", method)
    try:
        return graph.number(x)
    except FormulaError as error:
        raise FormulaError(f"{method} must return a number: {error}", method) from None
