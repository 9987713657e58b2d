"""What the package does with a friction law: equations, coefficients and steady sliding.

All computations under a law use log variables, a reference velocity V_ref and T = t V_ref/Dc:

    w = V/V_ref,   v = ln w,   psi_k = ln(V_ref theta_k/D_k).

The numbers may be floats, arrays, or numbers that write code.  Friction and stress are divided by
a:

    resistance R = (mu - mu_ref)/a,   x = (tau/sigma - mu_ref)/a,

with mu_ref, the friction at V_ref and theta_k = D_k/V_ref.  The stress S that opposes motion,
friction and perhaps damping, is divided by a too (`equations_of_motion`).  Each state is coupled to
v and to itself, not to other states.
"""

import math
from functools import cached_property
from types import SimpleNamespace

from ..errors import ParameterError
from .expressions import EXPRESSION_LOCK, LIMIT, topological_order
from .law_formula import EXAMPLE, LOG, LawFormula, eq_1
from .point import Point

#: ln(V/V_ref) at rest, the largest rate that counts as 0, and an example of own parameters
LOG_SPEED_AT_REST, NEGLIGIBLE_RATE, OWN_EXAMPLE = -300.0, 1e-50, 0.7
#: points (v, psi) at which `one_length` compares rates, and the largest difference allowed
COMPARED_POINTS, ROUNDING = ((0.3, -0.2), (-1.1, 0.9), (0.7, 0.4)), 1e-12
#: highest order of `FrictionLaw.series`: enough for double precision if |z| < 0.5
LAST_COEFFICIENT = 15


class _thread_safe_property(cached_property):
    """A cached property that is computed only once, even if several threads need it."""

    def __get__(self, instance, owner=None):
        with EXPRESSION_LOCK:
            return super().__get__(instance, owner)


class FrictionLaw(LawFormula):
    """The base class of friction laws.

    A law of your own derives from this class.  It needs the attribute ``name`` and the method
    ``evolution(self, V, theta, p)``, which returns d theta/dt (see `ratestate.register`).  Friction
    follows eq. 1, mu0 + a ln(V/V0) + sum_k b_k ln(V0 theta_k/D_k), unless the law has the method
    ``friction(self, V, theta, p)``.  All other methods and attributes follow from these formulas.
    The solver uses them.

    ==========  ==================================================================
    V           slip rate [m/s], > 0, without sign
    theta       state [s], > 0; a tuple if the law has several states
    p           a, b, Dc, mu0, V0 and the law's own parameters as attributes [SI]
    v, w, psi   ln(V/V_ref), V/V_ref, and ln(V_ref theta_k/D_k) of each state
    ==========  ==================================================================
    """

    def mu(self, V, theta, ages, p, effects):
        """Return mu, given the ages theta_k/D_k and the effects b_k."""
        if self.overrides("friction"):
            return self.friction(V, theta[0] if len(theta) == 1 else theta, p)
        return eq_1(V, ages, p, effects)

    def reference(self, mu):
        """Return mu_ref, given mu at V_ref and theta_k = D_k/V_ref."""
        return mu

    # Equations that follow from the formula (equations_of_motion.py), and values at a point

    @_thread_safe_property
    def equations(self):
        """Derive the law's `Equations` from its formulas."""
        from .equations import Equations  # needs NumPy, which is slow to import

        return Equations(self, (*EXAMPLE, *self.parameters))

    @_thread_safe_property
    def motion(self):
        """Return the equations of motion in the engine's variables, a `Motion`."""
        from .equations_of_motion import Motion

        return Motion(self, self.reverses)

    @_thread_safe_property
    def motion_in_speed(self):
        """Return the equations of motion with v = ln(V/V_ref), a `Motion`."""
        from .equations_of_motion import Motion

        return Motion(self, False) if self.reverses else self.motion

    def at(self, v, psi, p):
        """Return a `Point` in the engine's variables, in floats or arrays."""
        w = self.speed(v, psi, p) if self.reverses else None
        return Point(self, p, (None, v, *psi), w)

    def at_speed(self, v, psi, p):
        """Return a `Point` at the speed V_ref exp(v), with omega = v."""
        return Point(self, p, (None, v, *psi), motion=self.motion_in_speed)

    def coefficients(self, V_ref, slider):
        """Return the dimensionless coefficients p that other methods need, a tuple: b_k/a first.

        slider : an object whose attributes are sigma and the parameters in `symbols` [SI]
        """
        return self.equations.coefficients(V_ref, vars(slider))

    def coefficient_arrays(self, V_ref, values):
        """Return the `coefficients` of many sliders, a tuple of arrays of one shape.

        values : symbol -> array, sigma too; symbols that the law does not need are ignored
        """
        import numpy as np  # slow to import; `ratestate --help` needs only the names of laws

        p = self.coefficients(V_ref, SimpleNamespace(**values))
        return tuple(np.broadcast_arrays(*p, V_ref)[:-1])

    def constant(self, name, p):
        """Return the value of one of the law's `constants`."""
        return self.equations.values(self.equations.law_constants[name], 0.0, (), p)[0]

    def evolution_effects(self, p):
        """Return b_k/a, the derivatives of (mu of eq. 1)/a with respect to each psi (tuple)."""
        return tuple(self.equations.values(self.equations.evolution_effects, 0.0, (), p))

    def log_states(self, v, psi, p):
        """Return ln(V_ref theta_k/D_k) of each reported state, a tuple."""
        logs = self.equations.log_theta
        return psi if logs is None else tuple(self.equations.values(logs, v, psi, p))

    def variables(self, v, log_states, p):
        """Return psi from ln(V_ref theta_k/D_k): the inverse of `log_states`."""
        psi = self.equations.variables
        return log_states if psi is None else tuple(self.equations.values(psi, v, log_states, p))

    # Extreme speeds

    def runs_away(self, v, psi, kappa, p):
        """Return whether `runaway` holds, or if the law has no such criterion, v > `LIMIT`."""
        condition = self.equations.runs_away
        if condition is None:
            return v > LIMIT
        return self.equations.values(condition, v, psi, p, kappa)[0]

    def must_stop(self, v, p):
        """Return whether the solver must stop although the motion is not a runaway.

        The slider has no mass and no damping.  It may slow down again, but double precision cannot
        represent its speed unless the states evolve with slip alone.
        """
        return v > LIMIT if self.heals_at_rest else False

    # The kind of law

    @property
    def slider_parameters(self):
        """Return which of mu0 and V0 the `coefficients` depend on, a tuple."""
        return tuple(x for x in ("mu0", "V0") if x in self.equations.used_parameters)

    @property
    def symbols(self):
        """Return the symbols of the parameters that `coefficients` needs besides sigma."""
        return ("a", "b", "Dc", *self.parameters, *self.slider_parameters)

    @property
    def lengths(self):
        """Return the symbols of the slip distances over which the states evolve, a tuple."""
        return tuple(D for _, D in self.states.values())

    @property
    def reference_state(self):
        """Return psi at theta_k = D_k/V_ref, a tuple of zeros."""
        return (0.0,) * len(self.states)

    @property
    def n_coefficients(self):
        return len(self.motion.p)

    @property
    def n_stored(self):
        """Return how many numbers the engine stores in `Point.e`."""
        return len(self.equations.exponentials) + self.reverses

    @property
    def has_speed_scale(self):
        """Return whether the equations of steady sliding depend on its speed."""
        return "V_ref" in self.equations.used_parameters

    @cached_property
    def heals_at_rest(self):
        """Return whether the state evolves without slip."""
        example = dict.fromkeys(self.symbols, OWN_EXAMPLE) | EXAMPLE | {"sigma": 1e6}
        p = self.coefficients(EXAMPLE["V0"], SimpleNamespace(**example))
        at = self.at_speed(LOG_SPEED_AT_REST, self.reference_state, p)
        return any(abs(rate) > NEGLIGIBLE_RATE for rate in at.f)

    @cached_property
    def one_length(self):
        """Return whether the law has one state, eq. 1 and d theta/dt = h(V theta/Dc).

        h(1) = 0 and h'(1) = -1 are required too.  Eqs 6, 7 and 10 and the closed forms hold for
        such laws of one length.
        """
        if self.form != LOG or self.parameters or self.overrides("friction"):
            return False
        equations = self.equations
        if equations.log_theta or dict(self.states) != {"theta": ("b", "Dc")}:
            return False
        if any(node in equations.constants for node in topological_order(equations.rates)):
            return False  # h depends on a parameter or on V_ref
        for v, psi in COMPARED_POINTS:
            (rate,), (h,) = (self.at_speed(*x, ()).f for x in ((v, (psi,)), (0.0, (v + psi,))))
            if not abs(rate / math.exp(v) - h) <= ROUNDING:
                return False
        return self.series is not None

    @cached_property
    def has_recurrences(self):
        """Return whether every expression in the equations has Taylor coefficients in time."""
        from .taylor import NoSeries, expand

        try:
            expand(self.motion.in_time[0], [], 0, {})
        except NoSeries:
            return False
        return True

    @cached_property
    def series(self):
        """Return c2, c3, ... of h(z) = -z + c2 z^2 + c3 z^3 + ..., None for any other h.

        h(z) is d psi/dT at v = 0 and psi = z, under a law of one length.
        """
        from .taylor import NoSeries, expand

        equations = self.equations
        start = dict.fromkeys((equations.v, *equations.psi), 0.0) | {equations.w: 1.0}
        by_z = {equations.psi[0]: equations.graph.number(1.0)}
        try:
            _, (h,) = expand(by_z, equations.rates[:1], LAST_COEFFICIENT + 1, start)
        except NoSeries:
            return None
        c0, c1, *others = (float(x or 0.0) for x in h)
        if not (abs(c0) <= ROUNDING and abs(c1 + 1.0) <= ROUNDING):
            return None
        return tuple(others)

    # Steady sliding

    def steady(self, p, v=0.0):
        """Return the `Point` of steady sliding at V = V_ref exp(v).

        ParameterError if a user's law has no steady sliding there, or friction falls with V there.
        """
        from .steady_state import steady_point, steady_problem  # these need NumPy

        at = steady_point(self, p, v)
        if problem := steady_problem(at):
            raise ParameterError(
                f"cannot be used: {problem}",
                "Give other parameters.",
                symbol="law",
                value=repr(self.name),
            )
        return at

    def reference_friction(self, V, values):
        """Return mu at V (n,) and theta_k = D_k/V: the steady friction under most laws.

        values : symbol -> (n,), mu0 and V0 too
        """
        return self.equations.reference_friction(V, values) + 0.0 * V

    def steady_friction(self, V, values):
        """Return mu in steady sliding at V (n,); values as for `reference_friction`."""
        R = self.steady(self.coefficient_arrays(V, values)).R
        return self.reference_friction(V, values) + values["a"] * R

    def steady_tau(self, V, values):
        """Return tau/sigma in steady sliding at V (n,): friction plus damping."""
        at = self.steady(self.coefficient_arrays(V, values))
        return self.reference_friction(V, values) + values["a"] * at.R + values["a"] * (at.S - at.R)

    def __getstate__(self):
        """Return the state for pickle, without derived properties, which hold functions."""
        kind = type(self)
        derived = {x for x in vars(self) if isinstance(getattr(kind, x, None), cached_property)}
        return {name: x for name, x in vars(self).items() if name not in derived}

    def overrides(self, method):
        """Return whether the law has its own version of a method, by name."""
        return getattr(type(self), method) is not getattr(FrictionLaw, method)
