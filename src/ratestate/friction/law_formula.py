"""What a friction law states: names, parameters, and the formula of how its states evolve.

And what forms of friction and varying normal stress change of the motion under it.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from .expressions import LIMIT
from .functions import exp_and_inverse, log

#: the friction of eq. 1, a form by its name
LOG = "log"
#: between a user's law's own name and the hash of its content
MARK = "@"
#: values of the parameters that every formula is given, as examples
EXAMPLE = {"a": 0.01, "b": 0.015, "Dc": 1e-5, "mu0": 0.6, "V0": 1e-6}


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


class LawFormula:
    """What a law states (`law.FrictionLaw` has what follows)."""

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

    # How v tells the speed, which `forms.Regularized` does in another way (point.py)

    #: whether slip may reverse
    reverses = False

    def net_speed(self, v, psi, p):
        """w, 1/c, and in a tuple what the engine keeps of them."""
        return *exp_and_inverse(v), ()

    def log_of_faster(self, v, psi, p):
        """ln of the rate of forward or of backward jumps, whichever is larger."""
        return v

    def v_at(self, w, psi, p):
        """v at the speed w, of arrays too."""
        return log(w)

    def speed(self, v, psi, p):
        """w of arrays, as the engine has it, but where that saturates far up."""
        import numpy as np

        with np.errstate(over="ignore"):  # without mass V may overflow, and come back
            return np.exp(np.maximum(v, -LIMIT))

    # Normal stress that varies, which `composition.Varying` adds

    varies = False

    def history(self, p):
        """What of p changes with time, a tuple: of the last ones."""
        return ()

    def later(self, p, dT):
        """p at a time dT later: others where normal stress varies."""
        return p

    def stiffness(self, kappa, p):
        """K Dc/(a sigma(t)), of which kappa is that at t = 0: so stiff is the spring beside N/s."""
        return kappa

    # What a slider does at speeds beyond others

    def resolved(self, v_limit, p):
        """v up to which friction tells the speed of a slider without mass or damping: `v_limit`.

        v_limit : v at which it is asked whether such a slider runs away; inf of others
        """
        return v_limit

    def outruns_spring(self, at, kappa):
        """Whether friction, which hardly depends on V there, falls faster with slip than the
        spring's force: a slider without mass at V >> V_lp then runs away for sure.

        at : a `Point`
        """
        return False

    def without_rounding(self, at, error, inertia, rounding, size, allowed):
        """`Point.error_of_v`, less where rounding feigns more of it in v than is allowed.

        at : a `Point`; inertia : eta0/h
        rounding : as a part of the numbers in x, psi and p; size : of x and psi
        """
        return error
