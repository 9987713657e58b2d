"""The equations of motion under a law, derived from its formula.

The formula, d theta/dt of V, theta and the parameters p, is run once with expressions, in which

    V = V_ref exp(v),    theta_k = (D_k/V_ref) exp(psi_k),    T = t V_ref/Dc,

so that d psi_k/dT and friction come out as expressions in v and psi.  What is constant in these are
the coefficients, which are computed once a slider; derivatives follow (derivatives.py), and values
are computed in numbers of any kind (evaluation.py).
"""

import functools
from types import SimpleNamespace

from .derivatives import Derivative
from .evaluation import Real, evaluate
from .expressions import Graph, exp, log
from .rewriting import Hoisting, replaced, times_each

#: parameters of every slider that formulas are given; those of them that are > 0
COMMON, POSITIVE = ("a", "b", "Dc", "mu0", "V0"), ("a", "Dc", "V0")


def friction_of_logarithms(V, ages, p, effects):
    """mu = mu0 + a ln(V/V0) + sum_k b_k ln(V0 theta_k/D_k) (eq. 1), from the theta_k/D_k."""
    mu = p.mu0 + p.a * log(V / p.V0)
    return sum((b * log(p.V0 * age) for b, age in zip(effects, ages, strict=True)), mu)


class Equations:
    """d psi_k/dT and resistance R = (mu - mu_ref)/a as expressions in v and psi.

    mu_ref is friction at V_ref and theta_k = D_k/V_ref.

    Parameters
    ----------
    law : with `evolution`, and perhaps `friction`
    states : dict state -> the symbols of b_k and D_k
    parameters : dict symbol -> `Parameter`, of those beside `COMMON`
    friction : function of V, the theta_k/D_k, p and the b_k which gives mu; a form of friction
    """

    def __init__(self, law, states, parameters, friction=friction_of_logarithms):
        graph = Graph()
        positive = {*POSITIVE, *(name for name, one in parameters.items() if one.bound == "> 0")}
        names = (*COMMON, *parameters)
        symbols = {x: graph.symbol(("p", x), is_positive=x in positive) for x in names}
        V_ref, v = graph.symbol("V_ref", is_positive=True), graph.symbol("v", is_constant=False)
        psi = [graph.symbol(("psi", k), is_constant=False) for k in range(len(states))]
        p = SimpleNamespace(**symbols)
        effects, lengths = zip(*((symbols[b], symbols[D]) for b, D in states.values()), strict=True)
        V, ages = V_ref * exp(v), [exp(one) / V_ref for one in psi]
        theta = tuple(D * age for D, age in zip(lengths, ages, strict=True))
        rates = law.evolution(V, theta[0] if len(theta) == 1 else theta, p)
        rates = [
            times_each(graph.number(rate), p.Dc / D * exp(-one))
            for rate, D, one in zip(rates if len(theta) > 1 else [rates], lengths, psi, strict=True)
        ]
        mu = times_each(graph.number(friction(V, ages, p, effects)), graph.number(1.0))
        mu_ref = replaced(mu, dict.fromkeys([v, *psi], graph.number(0.0)))
        hoisting = Hoisting()
        self.rates = [hoisting(rate) for rate in rates]
        self.resistance = hoisting(times_each(mu - mu_ref, 1.0 / p.a))
        self.v, *self.psi = map(hoisting, (v, *psi))
        self.graph, self.constants = hoisting.graph, hoisting.constants
        self._parameters, self._V_ref = symbols, V_ref

    def coefficients(self, V_ref, values, functions=Real):
        """The numbers p that stand for what is constant, a tuple.

        values : symbol -> float or array, of the parameters [SI]
        """
        known = {one: values[symbol] for symbol, one in self._parameters.items()}
        known[self._V_ref] = V_ref
        return tuple(evaluate(self.constants.values(), known, functions))

    def derivative(self, x, *by):
        """The derivative of an expression by `v` or one of `psi`, by several in turn."""
        return functools.reduce(lambda one, symbol: self._derivatives[symbol](one), by, x)

    @functools.cached_property
    def _derivatives(self):
        one = self.graph.number(1.0)
        return {x: Derivative(self.graph, {x: one}) for x in (self.v, *self.psi)}

    def values(self, expressions, v, psi, p, functions=Real):
        """Values of expressions where v, psi (a tuple) and the coefficients are these, a list."""
        known = dict(zip((self.v, *self.psi, *self.constants), (v, *psi, *p), strict=True))
        return evaluate(expressions, known, functions)
