"""What a friction law is: a class of a few scalar functions, for which the engine is compiled.

A law relates friction to the slip velocity V and to one state or more, and says how these evolve.
It is written in the engine's log variables, with a reference velocity V_ref and T = t V_ref/Dc,

    w = V/V_ref,   v = ln w,   psi_k = ln(V_ref theta_k/D_k),

for one slider, in numbers, and the engine compiles this same source: so a method holds arithmetic,
`math` and what else numba knows.  Friction and stress are divided by a:

    resistance R = (mu - mu_ref)/a,   x = (tau/sigma - mu_ref)/a,

and so is the `stress` that opposes motion, friction and what else there is (`composition`),

with mu_ref the friction at V_ref and theta_k = D_k/V_ref.  So a law knows no velocity but V_ref,
which may be chosen freely, and its own.

Each state is coupled to v and to itself, not to other states.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from .kinematics import LIMIT
from .law_properties import LawProperties

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


class FrictionLaw(LawProperties):
    """What laws have in common; friction is that of eq. 1, in one state, unless a law has its own.

    A subclass has `rates`, and their derivatives, at least.

    ==========  =============================================================
    v, w        ln(V/V_ref) and V/V_ref
    psi         tuple, a number a state
    e           tuple, e to the power of each of `exponents`
    p           tuple, what `coefficients` gives: here (b/a,); with cut-offs or
                damping more numbers follow, so take them by index
    ==========  =============================================================
    """

    name: str
    label: str  # in titles and legends
    synonyms: tuple[str, ...] = ()  # other names by which it is known, in small letters
    #: of the derivatives that it has: 1 is enough for runs, 2 for limit cycles, 3 for `hopf`
    orders: int = 3
    #: whether friction is that of eq. 1 in one state with d theta/dt = h(V theta/Dc), h(1) = 0 and
    #: h'(1) = -1: then eqs 6, 7 and 10 hold, and what else is known of such laws
    one_length: bool = False
    #: the form of friction (`forms`) that it is for; one for that of eq. 1 may take others too
    form = LOG
    #: of each state, its name in results -> the symbol of the distance D_k over which it evolves
    states: Mapping[str, str] = MappingProxyType({"theta": "Dc"})
    #: symbol -> what it is, of parameters beside a, b, Dc, mu0 and V0
    parameters: Mapping[str, Parameter] = MappingProxyType({})

    #: symbols of other parameters of sliders that `coefficients` needs
    of_slider: tuple[str, ...] = ()

    # Of arrays too, in Python alone

    def coefficients(self, V_ref, slider):
        """The dimensionless numbers p that the other methods are given, a tuple.

        slider : with parameters [SI] as attributes, `symbols` and sigma among them
        """
        return (slider.b / slider.a,)

    def rescaled(self, p, ratio):
        """`coefficients` for V_ref times `ratio`: others under a law with a speed of its own."""
        return p

    def complaint(self, slider):
        """What is wrong with its parameters together, and what helps, as text; "" if nothing."""
        return ""

    def jumps_with_normal_stress(self, mu, alpha, slider):
        """d psi_k/d ln sigma of each variable where sigma changes at once, a tuple.

        By Linker & Dieterich (1992), theta of the first state falls by alpha/b.

        mu : friction then; alpha : the slider's, 0 where b is; slider : as for `coefficients`
        """
        return -alpha / (slider.b + 1.0 * (slider.b == 0.0)), *(0.0 for _ in list(self.states)[1:])

    def log_states(self, v, psi, p):
        """ln(V_ref theta_k/D_k) of each state as it is reported, a tuple, from the variables."""
        return psi

    def variables(self, v, log_states, p):
        """The inverse of `log_states`."""
        return log_states

    def steady_variables(self, p):
        """psi in steady sliding at V_ref, a tuple; found numerically, unless a law knows it."""
        from .steady_state import steady_variables  # NumPy is slow to import

        return steady_variables(self, p)

    # In compiled code

    def exponents(self, v, w, psi, p):
        """Of which numbers the rates need the exponential."""
        return ()

    def resistance(self, v, w, psi, p):
        """(mu - mu_ref)/a."""
        return v + p[0] * psi[0]

    def resistance_partials(self, v, w, psi, p):
        """Derivatives of `resistance` by v, > 0, and by each of psi, a tuple."""
        return 1.0, (p[0],)

    def resistance_partials_2(self, v, w, psi, p):
        """Second derivatives of `resistance`: vv; v psi_k, a tuple; psi_j psi_k, of tuples."""
        return 0.0, (0.0,), ((0.0,),)

    def evolution_effects(self, p):
        """Derivatives of the friction of eq. 1 by each of psi, a tuple: b/a."""
        return (p[0],)

    def stress(self, v, w, psi, p):
        """What opposes the motion, as x is counted: friction, unless there is more."""
        return self.resistance(v, w, psi, p)

    def stress_partials(self, v, w, psi, p):
        """Derivatives of `stress`, as those of `resistance`."""
        return self.resistance_partials(v, w, psi, p)

    def stress_partials_2(self, v, w, psi, p):
        """Second derivatives of `stress`, as those of `resistance`."""
        return self.resistance_partials_2(v, w, psi, p)

    def rates(self, v, w, psi, e, p):
        """d psi/dT of each state, a tuple."""
        raise NotImplementedError

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of each of `rates` by v, a tuple, and by its own state, a tuple."""
        raise NotImplementedError

    def rate_partials_2(self, v, w, psi, e, p):
        """Second derivatives of `rates`: vv, v psi and psi psi, a tuple each."""
        raise NotImplementedError

    def heals_at_rest(self):
        """Whether state evolves without slip."""
        return False

    def runs_away(self, v, psi, kappa, p):
        """Whether a slider without mass, at V >> V_lp, runs away for sure; else it turns back.

        Where a law does not know: at speeds that no double would follow much further.
        """
        return v > 600.0

    def is_lost(self, v, p):
        """Whether a slider without mass or damping cannot be followed further, though it may turn
        back: at speeds that saturate, but where states evolve with slip alone.
        """
        return self.heals_at_rest() and v > LIMIT

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

    # Where they are known, else not called

    def held(self, psi, v, w, h, p):
        """psi after a time h at the constant speed w = exp(v), and its derivative by v: tuples."""
        return psi, psi

    def held_by_euler(self, psi, v, w, h, p):
        """What `held` would give, by one step of backward Euler."""
        return psi, psi

    def relaxed(self, psi, v, v_end, slip, forced):
        """psi, a number, at the end of a slip [Dc] from the speed v to v_end, given the integral of
        `forcing`.
        """
        raise NotImplementedError

    def forcing(self, curvature, part, w_end):
        """What drives the state with slip, where (V/V_end)^2 is `part`, of slope -`curvature`."""
        raise NotImplementedError

    #: c2, c3, ... of h(z) = -z + c2 z^2 + c3 z^3 + ... for a law of one length, which `rates` is at
    #: v = 0 and psi = z: to double precision for |z| < 0.5
    series: tuple[float, ...] = ()

    def excursion(self, v, psi, kappa, beta):
        """How far a state without inertia is from steady sliding, of arrays: see `quasi_static`."""
        raise NotImplementedError

    def runaway_edge(self, kappa, beta, largest):
        """The smallest disturbances that run away without mass: `separatrix.Thresholds`."""
        raise NotImplementedError

    def rate_partials_3(self, v, w, psi, e, p):
        """Third derivatives of `rates`: vvv, vv psi, v psi psi, psi psi psi, a tuple each."""
        raise NotImplementedError

    def resistance_partials_3(self, v, w, psi, p):
        """Third derivatives of `resistance`: vvv; v v psi_i; v psi_i psi_j; psi_i psi_j psi_k.

        A number, a tuple, a tuple of tuples, and these in a tuple.
        """
        n = range(len(psi))
        by_psi_psi = tuple(tuple(0.0 for _ in n) for _ in n)
        return 0.0, tuple(0.0 for _ in n), by_psi_psi, tuple(by_psi_psi for _ in n)

    def stress_partials_3(self, v, w, psi, p):
        """Third derivatives of `stress`, as those of `resistance`."""
        return self.resistance_partials_3(v, w, psi, p)

    # Of the law itself

    @property
    def has_own_speed(self):
        """Whether steady sliding is another problem at another speed."""
        return self.gives("rescaled")

    def gives(self, method):
        """Whether the law has a method, by name, that not every law has."""
        return getattr(type(self), method) is not getattr(FrictionLaw, method)
