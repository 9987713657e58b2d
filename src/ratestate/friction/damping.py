"""A dashpot beside friction: of the machine, or the waves that a fault radiates."""

import functools
from types import MappingProxyType

from .law import FrictionLaw, Parameter

#: symbol -> what it is, of its parameters
OWN = MappingProxyType({"damping": Parameter("Pa s/m", "damping", ">= 0", "'5 MPa s/m'")})


@functools.cache
def damped_at(i):
    """The class of laws with damping whose own coefficient is p[i], after those of a law."""

    class Damped(FrictionLaw):
        """A friction law with damping: S = N + zeta w, with zeta = damping V_ref/(a sigma).

        Not a law by itself: `composition` makes a class of this and the class of a law, in that
        order.

        Source: Rice (1993) doi:10.1029/93JB00191, with damping G/(2 c_s), that of shear waves.
        """

        own = OWN
        # what is known of a law of one length is without a dashpot
        one_length, series, has_own_speed = False, None, True
        inner: FrictionLaw  # the law without the dashpot

        def coefficients(self, V_ref, slider):
            """Those of the law without the dashpot, and zeta."""
            import numpy as np

            with np.errstate(over="ignore"):  # at speeds at which V_c is sought
                zeta = slider.damping * V_ref / (slider.a * slider.sigma)
            return (*self.inner.coefficients(V_ref, slider), zeta)

        def stress(self, v, w, psi, p):
            """What opposes the motion, R + zeta w."""
            return self.resistance(v, w, psi, p) + p[i] * w

        def stress_partials(self, v, w, psi, p):
            """Derivatives of `stress` by v and by each of psi, a tuple."""
            by_v, by_psi = self.resistance_partials(v, w, psi, p)
            return by_v + p[i] * w, by_psi

        def stress_partials_2(self, v, w, psi, p):
            """Second derivatives of `stress`: vv; v psi_k, a tuple; psi_j psi_k, of tuples."""
            by_vv, by_vpsi, by_psipsi = self.resistance_partials_2(v, w, psi, p)
            return by_vv + p[i] * w, by_vpsi, by_psipsi

        def stress_partials_3(self, v, w, psi, p):
            """Third derivatives of `stress`, as those of `resistance`."""
            by_vvv, *others = self.resistance_partials_3(v, w, psi, p)
            return by_vvv + p[i] * w, *others

        def stress_in_v(self, v, w, psi, p):
            """S from the engine's v."""
            return self.strength_in_v(v, w, psi, p) + p[i] * w

        def stress_slopes(self, v, w, psi, e, p):
            """Slopes of `stress_in_v`."""
            by_omega, by_psi = self.strength_slopes(v, w, psi, e, p)
            return by_omega + p[i] * self.speed_slope(w, e), by_psi

        def runs_away(self, v, psi, kappa, p):
            """Never, at any speed the dashpot holds what friction does not; unless it is none."""
            return (p[i] <= 0.0) & (v > 600.0)

    return Damped
