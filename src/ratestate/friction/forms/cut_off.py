"""Friction whose direct effect and whose state are cut off, at high speeds and at young ages."""

import functools
import math
from types import MappingProxyType

from ..expressions import log
from ..functions import (
    bent_each,
    diagonal,
    larger,
    logistic,
    logistic_each,
    softplus,
    softplus_each,
    weighted,
    weighted_sum,
    zeros_for,
)
from ..kinematics import LIMIT
from ..law import FrictionLaw, Parameter

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


def friction(V, ages, p, effects):
    """mu = mu0 - a ln(1 + V1/V) + sum_k b_k ln(1 + V2 theta_k/D_k), from the theta_k/D_k."""
    mu = p.mu0 - p.a * log(1.0 + p.V1 / V)
    return sum((b * log(1.0 + p.V2 * age) for b, age in zip(effects, ages, strict=True)), mu)


@functools.cache
def form_at(i):
    """The class of this form whose coefficients begin at p[i], after those of a law of state."""
    j, k = i + 1, i + 2

    class CutOff(FrictionLaw):
        """mu = mu0 - a ln(1 + V1/V) + b ln(1 + V2 theta/Dc), and of a second state b2 likewise.

        At V well below V1 and theta well above Dc/V2 that is eq. 1 with another mu0.  p[i], p[j]
        and p[k] are ln(V1/V_ref), ln(V2/V_ref) and what makes friction mu_ref at V_ref.

        Source: Okubo (1989) doi:10.1029/JB094iB09p12321.
        """

        own = OWN
        inner: FrictionLaw  # the law with the friction of eq. 1
        # what is known of a law of one length, and of its runaway, is under eq. 1
        one_length, series = False, ()
        excursion, runaway_edge = FrictionLaw.excursion, FrictionLaw.runaway_edge

        def coefficients(self, V_ref, slider):
            """Those of the law with the friction of eq. 1, and three more."""
            import numpy as np

            of_law = self.inner.coefficients(V_ref, slider)
            return self._with_own(of_law, np.log(slider.V1 / V_ref), np.log(slider.V2 / V_ref))

        def rescaled(self, p, ratio):
            """`coefficients` for V_ref times `ratio`."""
            import numpy as np

            of_law = self.inner.rescaled(p[:i], ratio)
            return self._with_own(of_law, p[i] - np.log(ratio), p[j] - np.log(ratio))

        def _with_own(self, of_law, lnV1, lnV2):
            effects = sum(self.inner.evolution_effects(of_law))
            return (*of_law, lnV1, lnV2, softplus(lnV1) - effects * softplus(lnV2))

        def reference_friction(self, V, values):
            """mu at V (n,) and theta_k = D_k/V; values as for a law."""
            return values["mu0"] - values["a"] * self.coefficient_arrays(V, values)[k]

        def resistance(self, v, w, psi, p):
            """(mu - mu_ref)/a."""
            state = weighted_sum(self.evolution_effects(p), softplus_each(p[j], psi))
            return p[k] - softplus(p[i] - v) + state

        def resistance_partials(self, v, w, psi, p):
            """Derivatives of `resistance` by v and by each of psi."""
            by_psi = weighted(self.evolution_effects(p), logistic_each(p[j], psi))
            return logistic(p[i] - v), by_psi

        def resistance_partials_2(self, v, w, psi, p):
            """Second derivatives of `resistance`: vv; v psi_k; psi_j psi_k, tuples."""
            part = logistic(p[i] - v)
            bends = weighted(self.evolution_effects(p), bent_each(logistic_each(p[j], psi)))
            return -part * (1.0 - part), zeros_for(psi), diagonal(bends)

        def resistance_partials_3(self, v, w, psi, p):
            """Third derivatives of `resistance`, as of a law."""
            part, on = logistic(p[i] - v), logistic_each(p[j], psi)
            zero = zeros_for(psi)
            own = [
                effect * x * (1.0 - x) * (1.0 - 2.0 * x)
                for effect, x in zip(self.evolution_effects(p), on, strict=True)
            ]
            by_psi = tuple(
                diagonal(tuple(x if other == state else 0.0 for other in range(len(psi))))
                for state, x in enumerate(own)
            )
            return part * (1.0 - part) * (1.0 - 2.0 * part), zero, diagonal(zero), by_psi

        def without_rounding(self, error, y, w, e, p, inertia, rounding, size, allowed):
            """Force tells v by the direct effect, by damping, and by inertia in the step.

            It is rounded to parts of the numbers it is a sum of, and of 1, as `softplus` is.
            """
            by_v, _ = self.stress_slopes(y[1], w, y[2:], e, p)
            slope = larger(by_v + inertia * w, LEAST_SLOPE)
            part = allowed * slope / (rounding * (1.0 + size + abs(p[k])))
            return error * (part if part < 1.0 else 1.0)

        def runs_away(self, v, psi, kappa, p):
            """Where the spring pulls harder than friction at all speeds, as when sigma falls."""
            return v > LIMIT

        def resolved(self, v_limit, p):
            """A little beyond V1."""
            return min(v_limit, p[i] + RESOLVED) if v_limit < math.inf else v_limit

        def is_lost(self, v, p):
            """Where friction does not tell V."""
            return v > p[i] + RESOLVED

        def outruns_spring(self, v, w, psi, e, kappa, p):
            """Whether -sum_k b_k dpsi_k/dD > kappa, with slip D and the b_k left at these ages.

            Where V >> V1, d(1/w)/dD = (kappa + sum_k b_k dpsi_k/dD)/w1, w1 = V1/V_ref: 1/w falls
            to 0 within a slip of w1/w [Dc], in which neither the states nor sigma change.
            """
            left = weighted(self.evolution_effects(p), logistic_each(p[j], psi))
            return -weighted_sum(left, self.rates(v, w, psi, e, p)) > kappa * w

    return CutOff
