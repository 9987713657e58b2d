"""What follows from the formulas of a law: steady sliding, and what kind of law it is."""

import functools
import math
from types import SimpleNamespace
from typing import Any

from ..errors import ParameterError
from .expressions import ordered
from .kinematics import Forward

#: values of the parameters that every formula is given, and of a law's own, as examples
EXAMPLE, OWN_EXAMPLE = {"a": 0.01, "b": 0.015, "Dc": 1e-5, "mu0": 0.6, "V0": 1e-6}, 0.7
#: between a user's law's own name and the hash of its content
MARK = "@"
#: ln(V/V_ref) of rest, and a rate that is none
REST, NOTHING = -300.0, 1e-50
#: points (v, psi) at which rates of one length are compared, and what may be between them
POINTS, ROUNDING = ((0.3, -0.2), (-1.1, 0.9), (0.7, 0.4)), 1e-12
#: of which c2, c3, ... are known, which serve to double precision for |z| < 0.5
LAST_OF_SERIES = 15


class LawProperties(Forward):
    """What is known of a law from what `law.FrictionLaw` has it give."""

    # of the law
    name: Any
    states: Any
    parameters: Any
    equations: Any
    form: Any
    coefficients: Any
    variables: Any
    log_states: Any
    resistance: Any
    resistance_partials: Any
    rates: Any
    rate_partials: Any
    stress: Any
    exponents: Any
    gives: Any

    @property
    def is_of_user(self):
        """Whether a user brings it: then its name ends in the hash of its formula."""
        return MARK in self.name

    @property
    def of_slider(self):
        """Which of mu0 and V0 `coefficients` depend on, a tuple."""
        return tuple(x for x in ("mu0", "V0") if x in self.equations.used)

    @property
    def symbols(self):
        """Symbols of the parameters that `coefficients` is given, beside sigma."""
        return ("a", "b", "Dc", *self.parameters, *self.of_slider)

    @property
    def lengths(self):
        """Symbols of the distances over which its states evolve, a tuple."""
        return tuple(D for _, D in self.states.values())

    @property
    def reference_state(self):
        """psi where each theta_k is D_k/V_ref, a tuple: 0 each."""
        return (0.0,) * len(self.states)

    @functools.cached_property
    def n_coefficients(self):
        """How many `coefficients` there are."""
        ones = dict.fromkeys((*self.symbols, "sigma"), 1.0)
        return len(self.coefficients(1.0, SimpleNamespace(**ones)))

    @functools.cached_property
    def n_kept(self):
        """How many numbers the engine keeps in e (`kinematics`)."""
        return len(self.equations.exponentials) + self.reverses

    @property
    def has_own_speed(self):
        """Whether steady sliding is another problem at another speed."""
        return "V_ref" in self.equations.used

    @functools.cached_property
    def heals_at_rest(self):
        """Whether state evolves without slip."""
        rates = self._rates_of_example(REST, self.reference_state)
        return any(abs(rate) > NOTHING for rate in rates)

    @functools.cached_property
    def one_length(self):
        """Whether friction is that of eq. 1 in one state with d theta/dt = h(V theta/Dc).

        With h(1) = 0 and h'(1) = -1: then eqs 6, 7 and 10 hold, and what else is known of such
        laws.
        """
        if self.form != "log" or self.parameters or self.gives("friction"):
            return False
        equations = self.equations
        if equations.log_theta or dict(self.states) != {"theta": ("b", "Dc")}:
            return False
        if any(one in equations.constants for one in ordered(equations.rates)):
            return False  # h depends on a parameter, or on a speed
        for v, psi in POINTS:
            (rate,), (same,) = (
                self._rates_of_example(*x) for x in ((v, (psi,)), (0.0, (v + psi,)))
            )
            if not abs(rate / math.exp(v) - same) <= ROUNDING:
                return False
        return self.series is not None

    @functools.cached_property
    def series(self):
        """c2, c3, ... of h(z) = -z + c2 z^2 + c3 z^3 + ..., which `rates` is at v = 0 and psi = z.

        Of a law of one length.  None: h is no such series.
        """
        from .taylor import NoSeries, expand

        equations = self.equations
        known = dict.fromkeys((equations.v, *equations.psi), 0.0) | {equations.w: 1.0}
        known |= zip(equations.constants, self._coefficients_of_example(), strict=True)
        by_z = {equations.psi[0]: equations.graph.number(1.0)}
        try:
            _, (found,) = expand(by_z, equations.rates[:1], LAST_OF_SERIES + 1, known)
        except NoSeries:
            return None
        rest, slope, *others = (float(x or 0.0) for x in found)
        if not (abs(rest) <= ROUNDING and abs(slope + 1.0) <= ROUNDING):
            return None
        return tuple(others)

    def _coefficients_of_example(self):
        values = dict.fromkeys(self.symbols, OWN_EXAMPLE) | EXAMPLE | {"sigma": 1e6}
        return tuple(map(float, self.coefficients(EXAMPLE["V0"], SimpleNamespace(**values))))

    def _rates_of_example(self, v, psi):
        p, w = self._coefficients_of_example(), math.exp(v)
        return self.rates(v, w, psi, self.exponentials(v, w, psi, p), p)

    def coefficient_arrays(self, V_ref, values):
        """`coefficients` of many sliders, a tuple of arrays of one shape, from their parameters.

        values : symbol -> array, of sigma too, with others among them that no law needs
        """
        import numpy as np  # slow to import, and `ratestate --help` needs the names of laws alone

        p = self.coefficients(V_ref, SimpleNamespace(**values))
        return tuple(np.broadcast_arrays(*p, V_ref)[:-1])

    def steady_variables(self, p, v=0.0):
        """psi in steady sliding at V = V_ref exp(v), a tuple.

        ParameterError if, under a user's law, there is none, or friction falls with V there.
        """
        from .steady_state import steady_problem, steady_variables  # (which need NumPy)

        found = steady_variables(self, p, v)
        if problem := steady_problem(self, found, p, v):
            raise ParameterError(f"law = {self.name!r}: {problem}. Give other parameters.")
        return found

    def steady_log_states(self, p):
        """`log_states` in steady sliding at V_ref, a tuple."""
        return self.log_states(0.0, self.steady_variables(p), p)

    def steady_resistance(self, p):
        """`resistance` in steady sliding at V_ref, 0 for most laws: theta_k is D_k/V_ref there."""
        return self.resistance(0.0, 1.0, self.steady_variables(p), p)

    def steady_stress(self, p):
        """`stress` in steady sliding at V_ref."""
        return self.stress(0.0, 1.0, self.steady_variables(p), p)

    def reference_friction(self, V, values):
        """mu at V (n,) and theta_k = D_k/V, from parameters; that of steady sliding for most laws.

        values : symbol -> (n,), mu0 and V0 too
        """
        return self.equations.reference_friction(V, values) + 0.0 * V

    def steady_friction(self, V, values):
        """mu in steady sliding at V (n,), from parameters; values as for `reference_friction`."""
        rest = self.steady_resistance(self.coefficient_arrays(V, values))
        return self.reference_friction(V, values) + values["a"] * rest

    def steady_tau(self, V, values):
        """tau/sigma in steady sliding at V (n,): friction, and what else opposes the motion."""
        p = self.coefficient_arrays(V, values)
        beside = self.steady_stress(p) - self.steady_resistance(p)
        return self.steady_friction(V, values) + values["a"] * beside

    def exponentials(self, v, w, psi, p):
        """The exponentials e of arrays or numbers, a tuple, in Python."""
        import numpy as np

        return tuple(np.exp(x) for x in self.exponents(v, w, psi, p))
