"""Friction whose direct effect and whose state are cut off, at high speeds and at young ages."""

import math
from types import MappingProxyType

from ..expressions import LIMIT
from ..functions import larger, log, smaller, softplus, where
from ..law import FrictionLaw, Parameter
from ..tuples import dot

NAME = "cut-off"
# ln(V/V1) up to which double precision tells V from friction, there to 1e-5: by the slope e**-20.
RESOLVED, LEAST_SLOPE = 20.0, 2e-9
#: symbol -> what it is, of its parameters
OWN = MappingProxyType(
    {
        "V1": Parameter("m/s", "cut-off speed of the direct effect", "> 0", "'1 cm/s'"),
        "V2": Parameter("m/s", "cut-off speed of the state", "> 0", "'1 m/s'"),
    }
)


class CutOff(FrictionLaw):
    """mu = mu0 - a ln(1 + V1/V) + b ln(1 + V2 theta/Dc), and of a second state b2 likewise.

    At V well below V1 and theta well above Dc/V2 that is eq. 1 with another mu0.

    Source: Okubo (1989) doi:10.1029/JB094iB09p12321.
    """

    own = OWN
    # what is known of a law of one length is under eq. 1
    one_length, series = False, None

    def mu(self, V, theta, ages, p, effects):
        """From the theta_k/D_k and the b_k."""
        mu = p.mu0 - p.a * log(1.0 + p.V1 / V)
        each = zip(effects, ages, strict=True)
        return sum((b * log(1.0 + p.V2 * age) for b, age in each), mu)

    def constants(self, p, effects):
        """ln(V1/V_ref) and ln(V2/V_ref)."""
        return {"v1": log(p.V1 / p.V_ref), "v2": log(p.V2 / p.V_ref)}

    def runaway(self, v, psi, kappa, p):
        """Where the spring pulls harder than friction at all speeds, as when sigma falls."""
        return v > LIMIT

    def without_rounding(self, error, y, w, e, p, inertia, rounding, size, allowed):
        """Force tells v by the direct effect, by damping, and by inertia in the step.

        It is rounded to parts of the numbers it is a sum of, and of 1, as `softplus` is.
        """
        by_v, _ = self.stress_slopes(y[1], w, y[2:], e, p)
        effects = self.evolution_effects(p)
        offset = softplus(self.constant("v1", p)) - sum(effects) * softplus(self.constant("v2", p))
        slope = larger(by_v + inertia * w, LEAST_SLOPE)
        part = allowed * slope / (rounding * (1.0 + size + abs(offset)))
        return error * where(part < 1.0, part, 1.0)

    def resolved(self, v_limit, p):
        """A little beyond V1."""
        return where(
            v_limit < math.inf, smaller(v_limit, self.constant("v1", p) + RESOLVED), v_limit
        )

    def is_lost(self, v, p):
        """Where friction does not tell V."""
        return v > self.constant("v1", p) + RESOLVED

    def outruns_spring(self, v, w, psi, e, kappa, p):
        """Whether -sum_k b_k dpsi_k/dD > kappa, with slip D and the b_k left at these ages.

        Where V >> V1, d(1/w)/dD = (kappa + sum_k b_k dpsi_k/dD)/w1, w1 = V1/V_ref: 1/w falls
        to 0 within a slip of w1/w [Dc], in which neither the states nor sigma change.
        """
        _, left = self.resistance_partials(v, w, psi, p)
        return -dot(left, self.rates(v, w, psi, e, p)) > kappa * w


FORM = CutOff
