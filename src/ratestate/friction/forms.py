"""Forms of friction: alternatives to the logarithms of speed and state in eq. 1.

`composition` puts the class of a form before the class of a law among the bases of a new class.
So the law gets another friction.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from ..errors import ParameterError
from .expressions import LIMIT
from .functions import (
    asinh,
    asinh_of_product,
    bounded_exp,
    exp,
    larger,
    log,
    smaller,
    softplus,
    tanh,
    where,
)
from .law import FrictionLaw
from .law_formula import LOG, Parameter, eq_1
from .tuples import dot

# ln(V/V1) up to which friction determines V in double precision: to 1e-5 there, as the slope is
# e**-20.
RESOLVED, LEAST_SLOPE = 20.0, 2e-9


class CutOff(FrictionLaw):
    """mu = mu0 - a ln(1 + V1/V) + b ln(1 + V2 theta/Dc).

    A second state adds a term with b2 and Dc2.  At V well below V1 and theta well above Dc/V2 this
    is eq. 1 with another mu0.

    Source: Okubo (1989) doi:10.1029/JB094iB09p12321.
    """

    OWN_PARAMETERS = MappingProxyType(
        {
            "V1": Parameter("m/s", "cut-off speed of the direct effect", "> 0", "'1 cm/s'"),
            "V2": Parameter("m/s", "cut-off speed of the state", "> 0", "'1 m/s'"),
        }
    )

    def mu(self, V, theta, ages, p, effects):
        mu = p.mu0 - p.a * log(1.0 + p.V1 / V)
        states = zip(effects, ages, strict=True)
        return sum((b * log(1.0 + p.V2 * age) for b, age in states), mu)

    def constants(self, p, effects):
        """Return ln(V1/V_ref) and ln(V2/V_ref)."""
        return {"v1": log(p.V1 / p.V_ref), "v2": log(p.V2 / p.V_ref)}

    def runaway(self, v, psi, kappa, p):
        """Return whether v > `LIMIT`: the spring then exceeds friction at any speed."""
        return v > LIMIT

    def discount_rounding(self, at, error, inertia, rounding, size, allowed):
        """Return the error of v, reduced if rounding of the force dominates it.

        The force determines v by direct effect, damping and inertia.  It is rounded relative to the
        terms of its sum and, like `softplus`, relative to 1.
        """
        v1, v2 = self.constant("v1", at.p), self.constant("v2", at.p)
        offset = softplus(v1) - sum(self.evolution_effects(at.p)) * softplus(v2)
        slope = larger(at.S_slopes[0] + inertia * at.w, LEAST_SLOPE)
        ratio = allowed * slope / (rounding * (1.0 + size + abs(offset)))
        return error * where(ratio < 1.0, ratio, 1.0)

    def largest_resolved_v(self, v_limit, p):
        """Return a limit a little beyond V1."""
        return where(
            v_limit < math.inf, smaller(v_limit, self.constant("v1", p) + RESOLVED), v_limit
        )

    def must_stop(self, v, p):
        """Return whether friction no longer determines V."""
        return v > self.constant("v1", p) + RESOLVED

    def weakens_faster_than_spring(self, at, kappa):
        """Return whether -sum_k b_k dpsi_k/dD > kappa, with slip D and b_k at these ages.

        If V >> V1, d(1/w)/dD = (kappa + sum_k b_k dpsi_k/dD)/w1 with w1 = V1/V_ref: 1/w falls to 0
        within a slip of w1/w [Dc], during which neither the states nor sigma change.
        """
        return -dot(at.R_slopes[1:], at.f) > kappa * at.w


class Regularized(FrictionLaw):
    """mu = a asinh(V/(2 V0) exp((mu0 + b ln(V0 theta/Dc))/a)).

    A second state adds a term to the exponent.  It equals eq. 1 if eq. 1 is well above a.  mu_ref
    is 0, so that friction and stress keep their digits if they are small.

    Source: Rice & Ben-Zion (1996) doi:10.1073/pnas.93.9.3811; Lapusta, Rice, Ben-Zion & Zheng
    (2000) doi:10.1029/2000JB900250.
    """

    OWN_PARAMETERS: Mapping[str, Parameter] = MappingProxyType({})
    reverses = True
    one_length = False  # the closed forms hold for eq. 1

    def mu(self, V, theta, ages, p, effects):
        states = eq_1(p.V0, ages, p, effects)
        return p.a * asinh(0.5 * V / p.V0 * exp(states / p.a))

    def reference(self, mu):
        """Return 0."""
        return 0.0 * mu

    def constants(self, p, effects):
        """Return Theta at theta_k = D_k/V_ref."""
        at_V_ref = [1.0 / p.V_ref] * len(effects)
        states = eq_1(p.V0, at_V_ref, p, effects)
        return {"barrier": states / p.a - log(p.V0 / p.V_ref)}

    def barrier(self, psi, p):
        """Return Theta, the height of the barriers (point.py)."""
        return self.constant("barrier", p) + dot(self.evolution_effects(p), psi)

    def net_speed(self, v, psi, p):
        t = tanh(v)
        c = bounded_exp(self.log_jump_rate(v, psi, p)) * (2.0 / (1.0 + abs(t)))
        return c * t, 1.0 / c, (c,)

    def log_jump_rate(self, v, psi, p):
        return abs(v) - self.barrier(psi, p)

    def v_at(self, w, psi, p):
        return asinh_of_product(w, self.barrier(psi, p))

    def speed(self, v, psi, p):
        import numpy as np

        t = np.tanh(v)
        with np.errstate(over="ignore"):
            jumps = np.exp(np.maximum(self.log_jump_rate(v, psi, p), -LIMIT))
            return jumps * (2.0 / (1.0 + np.abs(t))) * t


#: name of a form other than eq. 1 -> its class, whose parameters are OWN_PARAMETERS
FORMS: dict[str, Any] = {"cut-off": CutOff, "regularized": Regularized}


def form_name(form):
    """Return the name of a form in small letters; ParameterError if it is unknown."""
    name = form.lower() if isinstance(form, str) else None
    if name not in (LOG, *FORMS):
        names = " or ".join(map(repr, (LOG, *FORMS)))
        raise ParameterError(
            "is unknown", f"Choose {names}.", symbol="friction_form", value=repr(form)
        )
    return name


def parameters_of(form):
    """Return symbol -> `Parameter` of the parameters of a form, by its name."""
    return FORMS[form].OWN_PARAMETERS if form in FORMS else {}


def forms_with(symbol):
    """Return the names of the forms that have this parameter, a list."""
    return [name for name, form in FORMS.items() if symbol in form.OWN_PARAMETERS]
