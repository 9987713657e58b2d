"""What a friction law is: the formula of how its states evolve, from which all else is derived.

Everything that is computed under a law is written in log variables, with a reference velocity V_ref
and T = t V_ref/Dc,

    w = V/V_ref,   v = ln w,   psi_k = ln(V_ref theta_k/D_k),

for numbers of any kind: floats, arrays, code that is being written.  Friction and stress are
divided by a:

    resistance R = (mu - mu_ref)/a,   x = (tau/sigma - mu_ref)/a,

and so is the stress S that opposes motion, friction and what else there is (`motion`), with mu_ref
the friction at V_ref and theta_k = D_k/V_ref.  Each state is coupled to v and to itself, not to
other states.
"""

import math
from functools import cached_property
from types import SimpleNamespace

from ..errors import ParameterError
from .expressions import LIMIT, MAKING, ordered
from .law_formula import EXAMPLE, LOG, LawFormula, eq_1
from .point import Point

#: ln(V/V_ref) of rest, the largest rate that counts as 0, and an example of own parameters
REST, NOTHING, OWN_EXAMPLE = -300.0, 1e-50, 0.7
#: points (v, psi) at which rates of one length are compared, and what may be between them
POINTS, ROUNDING = ((0.3, -0.2), (-1.1, 0.9), (0.7, 0.4)), 1e-12
#: of which c2, c3, ... are known, which serve to double precision for |z| < 0.5
LAST_OF_SERIES = 15


class _made_once(cached_property):
    """A cached property that is computed once, even if threads ask for it at once."""

    def __get__(self, instance, owner=None):
        with MAKING:
            return super().__get__(instance, owner)


class FrictionLaw(LawFormula):
    """A friction law: a name, and the formula of d theta/dt.

    Friction is that of eq. 1, mu0 + a ln(V/V0) + sum_k b_k ln(V0 theta_k/D_k), unless the law has a
    `friction` of its own.

    ==========  ==================================================================
    V           slip rate [m/s], > 0, without sign
    theta       state [s], > 0; of several states a tuple of them
    p           a, b, Dc, mu0, V0 and the law's own parameters as attributes [SI]
    v, w, psi   ln(V/V_ref), V/V_ref, and of each state ln(V_ref theta_k/D_k)
    ==========  ==================================================================
    """

    def mu(self, V, theta, ages, p, effects):
        """mu by the law's form of friction, or its own; ages : theta_k/D_k; effects : b_k."""
        if self.gives("friction"):
            return self.friction(V, theta[0] if len(theta) == 1 else theta, p)
        return eq_1(V, ages, p, effects)

    def reference(self, mu):
        """mu_ref, from mu at V_ref and theta_k = D_k/V_ref."""
        return mu

    # What follows from the formula: equations (equations.py, motion.py), and values at a point

    @_made_once
    def equations(self):
        """The law's `Equations`."""
        from .equations import Equations  # (which needs NumPy)

        return Equations(self, (*EXAMPLE, *self.parameters))

    @_made_once
    def motion(self):
        """The equations of motion in the engine's variables, a `Motion`."""
        from .motion import Motion

        return Motion(self, self.reverses)

    @_made_once
    def motion_in_speed(self):
        """The same with v = ln(V/V_ref)."""
        from .motion import Motion

        return Motion(self, False) if self.reverses else self.motion

    def at(self, v, psi, p):
        """A `Point` in the engine's variables, in numbers of Python."""
        w = self.speed(v, psi, p) if self.reverses else None
        return Point(self, p, (None, v, *psi), w)

    def at_speed(self, v, psi, p):
        """A `Point` at the speed V_ref exp(v); slopes by omega are those by this v."""
        return Point(self, p, (None, v, *psi), motion=self.motion_in_speed)

    def coefficients(self, V_ref, slider):
        """The dimensionless numbers p that other methods are given, a tuple: b_k/a first.

        slider : with parameters [SI] as attributes, `symbols` and sigma among them
        """
        return self.equations.coefficients(V_ref, vars(slider))

    def coefficient_arrays(self, V_ref, values):
        """`coefficients` of many sliders, a tuple of arrays of one shape, from their parameters.

        values : symbol -> array, of sigma too, with others among them that no law needs
        """
        import numpy as np  # slow to import, and `ratestate --help` needs the names of laws alone

        p = self.coefficients(V_ref, SimpleNamespace(**values))
        return tuple(np.broadcast_arrays(*p, V_ref)[:-1])

    def constant(self, name, p):
        """The value of one of `constants`."""
        return self.equations.values(self.equations.named[name], 0.0, (), p)[0]

    def evolution_effects(self, p):
        """Derivatives of the friction of eq. 1 by each of psi, a tuple: b_k/a."""
        return tuple(self.equations.values(self.equations.effects, 0.0, (), p))

    def log_states(self, v, psi, p):
        """ln(V_ref theta_k/D_k) of each state as it is reported, a tuple, from the variables."""
        found = self.equations.log_theta
        return psi if found is None else tuple(self.equations.values(found, v, psi, p))

    def variables(self, v, log_states, p):
        """The inverse of `log_states`."""
        made = self.equations.variables
        return log_states if made is None else tuple(self.equations.values(made, v, log_states, p))

    # What a slider does at speeds beyond others

    def runs_away(self, v, psi, kappa, p):
        """As `runaway` says; where a law does not know, beyond speeds that doubles can follow."""
        condition = self.equations.runs_away
        if condition is None:
            return v > LIMIT
        return self.equations.values(condition, v, psi, p, kappa)[0]

    def is_lost(self, v, p):
        """Whether a slider without mass or damping cannot be followed further, though it may turn
        back: at speeds that saturate, but where states evolve with slip alone.
        """
        return v > LIMIT if self.heals_at_rest else False

    # What kind of law it is

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

    @property
    def n_coefficients(self):
        """How many `coefficients` there are."""
        return len(self.motion.p)

    @property
    def n_kept(self):
        """How many numbers the engine keeps in e of a `Point`."""
        return len(self.equations.exponentials) + self.reverses

    @property
    def has_own_speed(self):
        """Whether steady sliding is another problem at another speed."""
        return "V_ref" in self.equations.used

    @cached_property
    def heals_at_rest(self):
        """Whether state evolves without slip."""
        example = dict.fromkeys(self.symbols, OWN_EXAMPLE) | EXAMPLE | {"sigma": 1e6}
        p = self.coefficients(EXAMPLE["V0"], SimpleNamespace(**example))
        return any(abs(rate) > NOTHING for rate in self.at_speed(REST, self.reference_state, p).f)

    @cached_property
    def one_length(self):
        """Whether friction is that of eq. 1 in one state with d theta/dt = h(V theta/Dc).

        With h(1) = 0 and h'(1) = -1: then eqs 6, 7 and 10 hold, and what else is known of such
        laws.
        """
        if self.form != LOG or self.parameters or self.gives("friction"):
            return False
        equations = self.equations
        if equations.log_theta or dict(self.states) != {"theta": ("b", "Dc")}:
            return False
        if any(one in equations.constants for one in ordered(equations.rates)):
            return False  # h depends on a parameter, or on a speed
        for v, psi in POINTS:
            (rate,), (same,) = (self.at_speed(*x, ()).f for x in ((v, (psi,)), (0.0, (v + psi,))))
            if not abs(rate / math.exp(v) - same) <= ROUNDING:
                return False
        return self.series is not None

    @cached_property
    def series(self):
        """c2, c3, ... of h(z) = -z + c2 z^2 + c3 z^3 + ..., which the rate is at v = 0 and psi = z.

        Of a law of one length.  None: h is no such series.
        """
        from .taylor import NoSeries, expand

        equations = self.equations
        known = dict.fromkeys((equations.v, *equations.psi), 0.0) | {equations.w: 1.0}
        by_z = {equations.psi[0]: equations.graph.number(1.0)}
        try:
            _, (found,) = expand(by_z, equations.rates[:1], LAST_OF_SERIES + 1, known)
        except NoSeries:
            return None
        rest, slope, *others = (float(x or 0.0) for x in found)
        if not (abs(rest) <= ROUNDING and abs(slope + 1.0) <= ROUNDING):
            return None
        return tuple(others)

    # Steady sliding

    def steady(self, p, v=0.0):
        """A `Point` of steady sliding at V = V_ref exp(v).

        ParameterError if, under a user's law, there is none, or friction falls with V there.
        """
        from .steady_state import steady_point, steady_problem  # (which need NumPy)

        at = steady_point(self, p, v)
        if problem := steady_problem(at):
            raise ParameterError(f"law = {self.name!r}: {problem}. Give other parameters.")
        return at

    def reference_friction(self, V, values):
        """mu at V (n,) and theta_k = D_k/V, from parameters; that of steady sliding for most laws.

        values : symbol -> (n,), mu0 and V0 too
        """
        return self.equations.reference_friction(V, values) + 0.0 * V

    def steady_friction(self, V, values):
        """mu in steady sliding at V (n,), from parameters; values as for `reference_friction`."""
        rest = self.steady(self.coefficient_arrays(V, values)).R
        return self.reference_friction(V, values) + values["a"] * rest

    def steady_tau(self, V, values):
        """tau/sigma in steady sliding at V (n,): friction, and what else opposes the motion."""
        at = self.steady(self.coefficient_arrays(V, values))
        return self.reference_friction(V, values) + values["a"] * at.R + values["a"] * (at.S - at.R)

    def __getstate__(self):
        """What pickle takes along: not what is derived, which holds functions made here."""
        kind = type(self)
        derived = {x for x in vars(self) if isinstance(getattr(kind, x, None), cached_property)}
        return {name: x for name, x in vars(self).items() if name not in derived}

    def gives(self, method):
        """Whether the law has a method, by name, that not every law has."""
        return getattr(type(self), method) is not getattr(FrictionLaw, method)
