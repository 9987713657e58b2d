"""What a friction law is: the formula of how its states evolve, from which all else is derived.

Everything that is computed under a law is written in log variables, with a reference velocity V_ref
and T = t V_ref/Dc,

    w = V/V_ref,   v = ln w,   psi_k = ln(V_ref theta_k/D_k),

for numbers of any kind: floats, arrays, code that is being written.  Friction and stress are
divided by a:

    resistance R = (mu - mu_ref)/a,   x = (tau/sigma - mu_ref)/a,

and so is the `stress` that opposes motion, friction and what else there is (`composition`),
with mu_ref the friction at V_ref and theta_k = D_k/V_ref.  Each state is coupled to v and to
itself, not to other states.
"""

from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

from .expressions import LIMIT
from .functions import log
from .law_properties import LawProperties
from .tuples import grouped

#: the friction of eq. 1, a form by its name
LOG = "log"


class Parameter(NamedTuple):
    """A parameter that a law has beside a, b, Dc, mu0 and V0: the quantity that it is.

    Parameters
    ----------
    unit : str
        SI unit, "1" of a pure number.
    long_name : str
        What messages and reports call it.
    bound : {"", "> 0", ">= 0"}
        Range of its values.
    example : str
        A value as a user would write it, with its unit.
    """

    unit: str
    long_name: str
    bound: str = ""
    example: str = ""


def eq_1(V, ages, p, effects):
    """mu = mu0 + a ln(V/V0) + sum_k b_k ln(V0 theta_k/D_k), from the theta_k/D_k and b_k."""
    mu = p.mu0 + p.a * log(V / p.V0)
    return sum((b * log(p.V0 * age) for b, age in zip(effects, ages, strict=True)), mu)


class FrictionLaw(LawProperties):
    """A friction law: a name, and the formula of d theta/dt.

    Friction is that of eq. 1, mu0 + a ln(V/V0) + sum_k b_k ln(V0 theta_k/D_k), unless the law has a
    `friction` of its own.

    ==========  ==================================================================
    V           slip rate [m/s], > 0, without sign
    theta       state [s], > 0; of several states a tuple of them
    p           a, b, Dc, mu0, V0 and the law's own parameters as attributes [SI]
    v, w, psi   ln(V/V_ref), V/V_ref, and of each state ln(V_ref theta_k/D_k)
    e           tuple, e to the power of each of `exponents`
    ==========  ==================================================================
    """

    name: str
    label: str  # in titles and legends
    synonyms: tuple[str, ...] = ()  # other names by which it is known, in small letters
    source: str = ""
    #: the form of friction (`forms`) that it is for; one for that of eq. 1 may take others too
    form = LOG
    #: of each state, its name in results -> the symbols of b_k and of D_k
    states: Mapping[str, tuple[str, str]] = MappingProxyType({"theta": ("b", "Dc")})
    #: symbol -> what it is, of parameters beside a, b, Dc, mu0 and V0
    parameters: Mapping[str, Parameter] = MappingProxyType({})

    # Formulas, run once with expressions: functions are those of `ratestate.laws`

    def evolution(self, V, theta, p):
        """d theta/dt [1]; of several states a tuple."""
        raise NotImplementedError

    def friction(self, V, theta, p):
        """mu, of a law whose friction is not that of eq. 1."""
        raise NotImplementedError

    def mu(self, V, theta, ages, p, effects):
        """mu by the law's form of friction, or its own; ages : theta_k/D_k; effects : b_k."""
        if self.gives("friction"):
            return self.friction(V, theta[0] if len(theta) == 1 else theta, p)
        return eq_1(V, ages, p, effects)

    def reference(self, mu):
        """mu_ref, from mu at V_ref and theta_k = D_k/V_ref."""
        return mu

    def constants(self, p, effects):
        """name -> other constants that methods need; p : as for formulas, and V_ref."""
        return {}

    def runaway(self, v, psi, kappa, p):
        """Whether a slider without mass, at V >> V_lp, runs away for sure; else it turns back.

        None: the law does not know.

        kappa : K Dc/(a sigma)
        """
        return None

    # A law whose rate needs that of the stress takes that into the variable that it integrates, in
    # place of psi.  `evolution` is then theta times the rate of that variable.

    def log_theta(self, v, psi, p):
        """ln(V_ref theta_k/D_k) of each state from the variables psi, a list."""
        return list(psi)

    def variables_of(self, v, logs, p):
        """The inverse of `log_theta`."""
        return list(logs)

    # Of arrays

    def complaint(self, slider):
        """What is wrong with its parameters together, and what helps, as text; "" if nothing."""
        return ""

    def jumps_with_normal_stress(self, mu, alpha, slider):
        """d psi_k/d ln sigma of each variable where sigma changes at once, a tuple.

        By Linker & Dieterich (1992), theta of the first state falls by alpha/b.

        mu : friction then; alpha : the slider's, 0 where b is
        slider : with parameters [SI] as attributes
        """
        return -alpha / (slider.b + 1.0 * (slider.b == 0.0)), *(0.0 for _ in list(self.states)[1:])

    # Derived, in numbers of any kind

    @cached_property
    def equations(self):
        """The law's `Equations`."""
        from .equations import Equations  # (which needs NumPy)

        return Equations(self)

    def coefficients(self, V_ref, slider):
        """The dimensionless numbers p that other methods are given, a tuple: b_k/a first.

        slider : with parameters [SI] as attributes, `symbols` and sigma among them
        """
        return self.equations.coefficients(V_ref, vars(slider))

    def constant(self, name, p):
        """The value of one of `constants`."""
        return self._of_constants(self.equations.named[name], p)[0]

    def evolution_effects(self, p):
        """Derivatives of the friction of eq. 1 by each of psi, a tuple: b_k/a."""
        return tuple(self._of_constants(self.equations.effects, p))

    def _of_constants(self, expressions, p):
        return self.equations.values(expressions, 0.0, 1.0, self.reference_state, p)

    def _values(self, expressions, v, w, psi, p, e=None, kappa=None):
        return self.equations.values(expressions, v, w, psi, p, e, kappa)

    def log_states(self, v, psi, p):
        """ln(V_ref theta_k/D_k) of each state as it is reported, a tuple, from the variables."""
        found = self.equations.log_theta
        return psi if found is None else tuple(self._values(found, v, None, psi, p))

    def variables(self, v, log_states, p):
        """The inverse of `log_states`."""
        found = self.equations.variables
        return log_states if found is None else tuple(self._values(found, v, None, log_states, p))

    def exponents(self, v, w, psi, p):
        """Of which numbers the rates need the exponential, a tuple."""
        return tuple(self._values(self.equations.exponents, v, w, psi, p))

    def resistance(self, v, w, psi, p):
        """(mu - mu_ref)/a."""
        return self._values(self.equations.resistance, v, w, psi, p)[0]

    def resistance_partials(self, v, w, psi, p):
        """Derivatives of `resistance` by v, > 0, and by each of psi, a tuple."""
        by_v, *by_psi = self._values(self.equations.slopes, v, w, psi, p)
        return by_v, tuple(by_psi)

    def resistance_bends(self, v, w, psi, p):
        """Second derivatives of `resistance`: rows, by v and each of psi, of a symmetric matrix."""
        return grouped(tuple(self._values(self.equations.bends, v, w, psi, p)), (v, *psi))

    def stress(self, v, w, psi, p):
        """What opposes the motion, as x is counted: friction, and damping."""
        return self.stress_of(self.resistance(v, w, psi, p), w, p)

    def stress_partials(self, v, w, psi, p):
        """Derivatives of `stress`, as those of `resistance`; damping adds the same number by v."""
        by_v, by_psi = self.resistance_partials(v, w, psi, p)
        return self.stress_of(by_v, w, p), by_psi

    def rates(self, v, w, psi, e, p):
        """d psi/dT of each state, a tuple."""
        return tuple(self._values(self.equations.rates, v, w, psi, p, e))

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of each of `rates` by v, a tuple, and by its own state, a tuple."""
        return grouped(tuple(self._values(self.equations.rate_slopes, v, w, psi, p, e)), psi)

    # The balance of forces, of numbers or expressions (`motion`); `composition` adds to it

    #: whether normal stress varies
    varies = False
    #: part of which it is composed -> place in p of the first coefficient of that
    places: Mapping[str, int] = MappingProxyType({})

    def strength_of(self, R, p):
        """N: friction R, unless normal stress varies."""
        return R

    def stress_of(self, N, w, p):
        """S: the strength N, unless there is damping."""
        return N

    def rates_of(self, rates, R, growth, p):
        """d psi/dT: the law's own, unless normal stress varies."""
        return rates

    def history(self, p):
        """What of p changes with time, a tuple: of the last ones."""
        return ()

    def rates_in_time(self, growth, p):
        """s and the growth of ln s, expressions, -> their derivatives in T, if they vary."""
        return {}

    def later(self, p, dT):
        """p at a time dT later: others where normal stress varies."""
        return p

    def stiffness(self, kappa, p):
        """K Dc/(a sigma(t)), of which kappa is that at t = 0: so stiff is the spring beside N/s."""
        return kappa

    @cached_property
    def motion(self):
        """The equations of motion, a `Motion`."""
        from .motion import Motion

        return Motion(self)

    # In the variables that the engine integrates: e as of `kinematics`

    def resistance_in_v(self, v, w, psi, p):
        """R."""
        return self.motion("resistance", v, w, psi, p)[0]

    def strength_in_v(self, v, w, psi, p):
        """N."""
        return self.motion("strength", v, w, psi, p)[0]

    def stress_in_v(self, v, w, psi, p):
        """S."""
        return self.motion("stress", v, w, psi, p)[0]

    def rates_in_v(self, v, w, psi, e, p):
        """d psi/dT."""
        return self.motion("rates", v, w, psi, p, e)

    def stress_slopes(self, v, w, psi, e, p):
        """Slopes of S: by omega and by each of psi, a tuple."""
        by_omega, *by_psi = self.motion("stress_slopes", v, w, psi, p, e)
        return by_omega, tuple(by_psi)

    def strength_drift(self, v, w, psi, p):
        """d/dT of N at constant v and psi, in a tuple; () unless normal stress varies."""
        return self.motion("strength_drift", v, w, psi, p)

    def rate_drift(self, v, w, psi, p):
        """d/dT of the rates at constant v and psi, a tuple; () unless normal stress varies."""
        return self.motion("rate_drift", v, w, psi, p)

    def rate_slopes(self, v, w, psi, e, p):
        """Slopes of `rates_in_v`: by omega, a tuple, and each by its own state, a tuple."""
        return grouped(self.motion("rate_slopes", v, w, psi, p, e), psi)

    # What a slider does at speeds beyond others

    def runs_away(self, v, psi, kappa, p):
        """As `runaway` says; where a law does not know, beyond speeds that doubles can follow."""
        condition = self.equations.runs_away
        if condition is None:
            return v > LIMIT
        return self._values(condition, v, None, psi, p, kappa=kappa)[0]

    def is_lost(self, v, p):
        """Whether a slider without mass or damping cannot be followed further, though it may turn
        back: at speeds that saturate, but where states evolve with slip alone.
        """
        return v > LIMIT if self.heals_at_rest else False

    def resolved(self, v_limit, p):
        """v up to which friction tells the speed of a slider without mass or damping: `v_limit`.

        v_limit : v at which it is asked whether such a slider runs away; inf of others
        """
        return v_limit

    def outruns_spring(self, v, w, psi, e, kappa, p):
        """Whether friction, which hardly depends on V there, falls faster with slip than the
        spring's force: a slider without mass at V >> V_lp then runs away for sure.
        """
        return False

    def __getstate__(self):
        """What pickle takes along: not what is derived, which holds functions made here."""
        kind = type(self)
        derived = {x for x in vars(self) if isinstance(getattr(kind, x, None), cached_property)}
        return {name: x for name, x in vars(self).items() if name not in derived}

    def gives(self, method):
        """Whether the law has a method, by name, that not every law has."""
        return getattr(type(self), method) is not getattr(FrictionLaw, method)
