"""What the author of a friction law writes: names, parameters, formulas.

It also has the methods that forms of friction and varying normal stress replace.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from .expressions import LIMIT
from .functions import exp_and_inverse, log

#: name of the form of friction of eq. 1
LOG = "log"
#: separates the name that a user gave a law from the hash of its formula
HASH_MARK = "@"
#: example values of the parameters that every law has
EXAMPLE = {"a": 0.01, "b": 0.015, "Dc": 1e-5, "mu0": 0.6, "V0": 1e-6}


class Parameter(NamedTuple):
    """A parameter that a law has in addition to a, b, Dc, mu0 and V0.

    Parameters
    ----------
    unit : str
        SI unit; "1" for a pure number.
    long_name : str
        Name of the quantity in messages and reports.
    bound : {"", "> 0", ">= 0"}
        Range of its values.
    example : str
        A value with its unit, as a user would write it.
    """

    unit: str
    long_name: str
    bound: str = ""
    example: str = ""


def eq_1(V, ages, p, effects):
    """Return mu0 + a ln(V/V0) + sum_k b_k ln(V0 theta_k/D_k); ages : theta_k/D_k."""
    mu = p.mu0 + p.a * log(V / p.V0)
    return sum((b * log(p.V0 * age) for b, age in zip(effects, ages, strict=True)), mu)


class LawFormula:
    """The definition of a law; `law.FrictionLaw` adds what follows from it."""

    name: str
    label: str  # for titles and legends
    synonyms: tuple[str, ...] = ()  # other names of the law, in small letters
    source: str = ""
    #: the form of friction (`forms`) that the law needs; laws with LOG may take other forms too
    form = LOG
    #: name of each state in results -> the symbols of b_k and D_k
    states: Mapping[str, tuple[str, str]] = MappingProxyType({"theta": ("b", "Dc")})
    #: symbol -> `Parameter`, in addition to a, b, Dc, mu0 and V0
    parameters: Mapping[str, Parameter] = MappingProxyType({})

    # Formulas: run once with expressions, so they use the functions of `ratestate.laws`

    def evolution(self, V, theta, p):
        """Return d theta/dt [1], a tuple if the law has several states."""
        raise NotImplementedError

    def friction(self, V, theta, p):
        """Return mu, if the law replaces eq. 1."""
        raise NotImplementedError

    def constants(self, p, effects):
        """Return other constants that its methods need, name -> value; p has V_ref too."""
        return {}

    def runaway(self, v, psi, kappa, p):
        """Return whether a slider without mass at V >> V_lp surely runs away.

        If not, the solver follows it.  None instead of a condition: the law has no criterion.

        kappa : K Dc/(a sigma)
        """
        return None

    # If d theta/dt depends on the rate of stress, the law integrates another variable than psi,
    # which absorbs that rate.  `evolution` is then theta times the rate of this variable.

    def log_theta(self, v, psi, p):
        """Return ln(V_ref theta_k/D_k) of each state from the variables psi, a list."""
        return list(psi)

    def variables_of(self, v, logs, p):
        """Return psi from ln(V_ref theta_k/D_k): the inverse of `log_theta`."""
        return list(logs)

    # Methods that take arrays

    def complaint(self, slider):
        """Return what is wrong with the parameters together and the remedy, or None."""
        return None

    def jumps_with_normal_stress(self, mu, alpha, slider):
        """Return d psi_k/d ln sigma of each variable in a jump of sigma, a tuple.

        Linker & Dieterich (1992): theta of the first state falls by alpha/b.

        mu : friction before the jump; alpha : the slider's, 0 if b is 0
        slider : has the parameters [SI] as attributes
        """
        return -alpha / (slider.b + 1.0 * (slider.b == 0.0)), *(0.0 for _ in list(self.states)[1:])

    # The speed as a function of v; `forms.Regularized` replaces these methods (point.py)

    #: whether slip may reverse
    reverses = False

    def net_speed(self, v, psi, p):
        """Return w, 1/c (point.py), and a tuple of the numbers that the engine stores."""
        return *exp_and_inverse(v), ()

    def log_jump_rate(self, v, psi, p):
        """Return ln of the larger of the forward and backward jump rates: v if w > 0."""
        return v

    def v_at(self, w, psi, p):
        """Return v at the speed w, which may be an array."""
        return log(w)

    def speed(self, v, psi, p):
        """Return w as the engine computes it, for arrays, without its upper limit."""
        import numpy as np

        with np.errstate(over="ignore"):  # without mass V may overflow and fall again
            return np.exp(np.maximum(v, -LIMIT))

    # Varying normal stress; `composition.Varying` replaces these methods

    varies = False

    def history(self, p):
        """Return the last coefficients in p, those that change with time, a tuple."""
        return ()

    def later(self, p, dT):
        """Return p a time dT later; it changes only if normal stress varies."""
        return p

    def stiffness(self, kappa, p):
        """Return K Dc/(a sigma(t)), given its value kappa at t = 0."""
        return kappa

    # Extreme speeds

    def largest_resolved_v(self, v_limit, p):
        """Return the largest v, up to v_limit, at which friction determines the speed.

        v_limit : v beyond which the engine checks whether a slider without mass or damping runs
            away; inf for other sliders
        """
        return v_limit

    def weakens_faster_than_spring(self, at, kappa):
        """Return whether friction falls faster with slip than the spring's force.

        Friction hardly depends on V at this point.  A slider without mass at V >> V_lp then surely
        runs away.

        at : a `Point`
        """
        return False

    def discount_rounding(self, at, error, inertia, rounding, size, allowed):
        """Return `Point.error_of_v`, reduced if rounding dominates it.

        at : a `Point`; inertia : eta0/h
        rounding : of x, psi and p, relative; size : of x and psi; allowed : error allowed in v
        """
        return error
