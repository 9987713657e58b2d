"""Friction that stays finite at rest, and acts against the slip in either direction."""

import functools
from types import MappingProxyType

from ..elementary import asinh
from ..equations import friction_of_logarithms
from ..expressions import exp
from ..functions import asinh_of_exp, scaled, weighted_sum
from ..law import FrictionLaw
from ..reversing import Reversing

NAME = "regularized"
#: symbol -> what it is, of its parameters: none
OWN: MappingProxyType = MappingProxyType({})


def friction(V, ages, p, effects):
    """mu = a asinh(V/(2 V0) exp((mu0 + sum_k b_k ln(V0 theta_k/D_k))/a)), from the theta_k/D_k."""
    states = friction_of_logarithms(p.V0, ages, p, effects)
    return p.a * asinh(0.5 * V / p.V0 * exp(states / p.a))


@functools.cache
def form_at(i):
    """The class of this form whose coefficient is p[i], after those of a law of state."""

    class Regularized(Reversing, FrictionLaw):
        """mu = a asinh(V/(2 V0) exp((mu0 + b ln(V0 theta/Dc))/a)), and of a second state likewise.

        It is eq. 1 where that is well above a.  p[i] is Theta at theta_k = D_k/V_ref, and mu_ref
        is 0, so that friction and stress keep their digits where they are small.

        Source: Rice & Ben-Zion (1996) doi:10.1073/pnas.93.9.3811; Lapusta, Rice, Ben-Zion & Zheng
        (2000) doi:10.1029/2000JB900250.
        """

        own = OWN
        of_slider = ("mu0", "V0")
        inner: FrictionLaw  # the law with the friction of eq. 1
        # what is known of a law of one length, and of its runaway, is under eq. 1
        one_length, series = False, ()
        excursion, runaway_edge = FrictionLaw.excursion, FrictionLaw.runaway_edge

        def coefficients(self, V_ref, slider):
            """Those of the law with the friction of eq. 1, and Theta."""
            import numpy as np

            of_law = self.inner.coefficients(V_ref, slider)
            rise = 1.0 - sum(self.inner.evolution_effects(of_law))
            return (*of_law, slider.mu0 / slider.a + rise * np.log(V_ref / slider.V0))

        def rescaled(self, p, ratio):
            """`coefficients` for V_ref times `ratio`."""
            import numpy as np

            of_law = self.inner.rescaled(p[:i], ratio)
            rise = 1.0 - sum(self.inner.evolution_effects(of_law))
            return (*of_law, p[i] + rise * np.log(ratio))

        def reference_friction(self, V, values):
            """mu_ref (n,), which is 0 here."""
            return 0.0 * values["a"] * V

        def barrier(self, psi, p):
            """Theta."""
            return p[i] + weighted_sum(self.evolution_effects(p), psi)

        def resistance(self, v, w, psi, p):
            """mu/a, of V > 0."""
            return asinh_of_exp(v + self.barrier(psi, p))

        def resistance_partials(self, v, w, psi, p):
            """Derivatives of `resistance` by v and by each of psi."""
            t, _ = self._slopes(v, psi, p)
            return t, scaled(t, self.evolution_effects(p))

        def resistance_partials_2(self, v, w, psi, p):
            """Second derivatives of `resistance`: vv; v psi_k; psi_j psi_k, tuples."""
            effects, (t, bend) = self.evolution_effects(p), self._slopes(v, psi, p)
            by_v_psi = scaled(t * bend, effects)
            return t * bend, by_v_psi, tuple(scaled(effect, by_v_psi) for effect in effects)

        def resistance_partials_3(self, v, w, psi, p):
            """Third derivatives of `resistance`, as of a law."""
            effects, (t, bend) = self.evolution_effects(p), self._slopes(v, psi, p)
            third = t * bend * (1.0 - 3.0 * t * t)
            once = scaled(third, effects)
            twice = tuple(scaled(effect, once) for effect in effects)
            each = tuple(tuple(scaled(effect, row) for row in twice) for effect in effects)
            return third, once, twice, each

        def _slopes(self, v, psi, p):
            """The derivative of mu/a by v, t = tanh(mu/a), and 1 - t^2."""
            import numpy as np

            mu = asinh_of_exp(v + self.barrier(psi, p))
            rest = np.exp(-2.0 * mu)
            return -np.expm1(-2.0 * mu) / (1.0 + rest), 4.0 * rest / (1.0 + rest) ** 2

    return Regularized
