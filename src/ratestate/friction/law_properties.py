"""What follows from the functions of a law: how many numbers they take, and steady sliding."""

from types import SimpleNamespace
from typing import Any

from .kinematics import Forward


class LawProperties(Forward):
    """What is known of a law from what `law.FrictionLaw` has it give."""

    # of the law
    states: Any
    parameters: Any
    of_slider: Any
    coefficients: Any
    variables: Any
    log_states: Any
    steady_variables: Any
    stress: Any

    @property
    def symbols(self):
        """Symbols of the parameters that `coefficients` is given, beside sigma."""
        return ("a", "b", "Dc", *self.parameters, *self.of_slider)

    @property
    def reference_state(self):
        """psi where each theta_k is D_k/V_ref, a tuple: 0 each."""
        return (0.0,) * len(self.states)

    @property
    def n_coefficients(self):
        """How many `coefficients` there are."""
        ones = dict.fromkeys((*self.symbols, "sigma"), 1.0)
        return len(self.coefficients(1.0, SimpleNamespace(**ones)))

    @property
    def n_exponents(self):
        """How many `exponents` there are."""
        return len(self.exponents(0.0, 1.0, self.reference_state, (1.0,) * self.n_coefficients))

    @property
    def n_kept(self):
        """How many numbers the engine keeps in e (`kinematics`)."""
        p = (1.0,) * self.n_coefficients
        return self.n_exponents + len(self.jump_exponents(0.0, self.reference_state, p))

    def coefficient_arrays(self, V_ref, values):
        """`coefficients` of many sliders, a tuple of arrays of one shape, from their parameters.

        values : symbol -> array, of sigma too, with others among them that no law needs
        """
        import numpy as np  # slow to import, and `ratestate --help` needs the names of laws alone

        p = self.coefficients(V_ref, SimpleNamespace(**values))
        return tuple(np.broadcast_arrays(*p, V_ref)[:-1])

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
        import numpy as np

        V0 = values["V0"]
        p = self.coefficient_arrays(V0, values)
        v = np.log(V / V0)
        psi = self.variables(v, (-v,) * len(self.states), p)
        return values["mu0"] + values["a"] * self.resistance(v, V / V0, psi, p)

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
