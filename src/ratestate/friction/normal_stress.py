"""Normal stress that varies with time: s(t) = sigma(t)/sigma(0), known from the loading.

Friction pushes with sigma(t) mu.  A change of normal stress changes the states too, by
`FrictionLaw.jumps_with_normal_stress`: d psi_k = h_k d ln s, with h_k = h_k0 + h_k1 R.

Where sigma jumps, V stays as it is, and psi does what it does in a very short ramp at that V.  A
slider without mass then is at once at the speed at which friction balances the spring: what one of
ever smaller mass does.  (In a short ramp V follows the balance meanwhile, which the states feel
where h_k1 is not 0, under the law of Nagata.)

Source: Linker & Dieterich (1992) doi:10.1029/92JB00017.
"""

import functools
import math
from types import MappingProxyType

from .functions import cosine, expm1, sine, where
from .law import FrictionLaw
from .tuples import dot, plus, product, times

#: places, from the end of p, of a history: base, its rate, amplitude, frequency and phase [periods]
#: of a sinusoid on it; then s, ds/dT and d2s/dT2, to which the base, a straight line, adds nothing
BASE, RATE, AMPLITUDE, FREQUENCY, PHASE, S, DS, DDS = range(-8, 0)


@functools.cache
def varying_at(i, n):
    """The class of laws in n states under varying sigma, with coefficients of its own from p[i]."""
    j, k, last = i + 1, i + 1 + n, i + 1 + 2 * n

    class Varying(FrictionLaw):
        """A friction law under normal stress sigma(t), which the engine alone is given.

        p[i] is mu_ref/a, then come h_k0 and h_k1 of each state, and at the end the history.
        """

        own: MappingProxyType = MappingProxyType({})
        S, PHASE = S, PHASE
        of_slider = ("mu0", "V0", "alpha", "sigma_amplitude", "sigma_period")
        inner: FrictionLaw  # the law under a constant sigma

        def coefficients(self, V_ref, slider):
            """Those of the law under a constant sigma, those of its own, and sigma's history."""
            of_law = self.inner.coefficients(V_ref, slider)
            mu_ref = self.inner.reference_friction(V_ref, vars(slider))
            jumps = self.inner.jumps_with_normal_stress
            at_mu_ref, by_R = jumps(mu_ref, slider.alpha, slider), jumps(slider.a, 0.0, slider)
            amplitude = slider.sigma_amplitude / slider.sigma
            frequency = slider.Dc / (slider.sigma_period * V_ref)
            history = 1.0, 0.0, amplitude, frequency, 0.0, 1.0, 0.0, 0.0
            return (*of_law, mu_ref / slider.a, *at_mu_ref, *by_R, *history)

        def strength_in_v(self, v, w, psi, p):
            """N = s R + (s - 1) mu_ref/a."""
            return p[S] * self.resistance_in_v(v, w, psi, p) + (p[S] - 1.0) * p[i]

        def strength_slopes(self, v, w, psi, e, p):
            """Slopes of `strength_in_v`."""
            by_omega, by_psi = self.resistance_slopes(v, w, psi, e, p)
            return p[S] * by_omega, times(p[S], by_psi)

        def strength_drift(self, v, w, psi, p):
            """d/dT of `strength_in_v` at constant v and psi, in a tuple."""
            return (p[DS] * (self.resistance_in_v(v, w, psi, p) + p[i]),)

        def jumps(self, v, w, psi, p):
            """d psi_k/d ln s."""
            return plus(p[j:k], times(self.resistance_in_v(v, w, psi, p), p[k:last]))

        def rates_in_v(self, v, w, psi, e, p):
            """d psi/dT: the law's, and what normal stress adds."""
            jumps = self.jumps(v, w, psi, p)
            return plus(self.state_rates(v, w, psi, e, p), times(p[DS] / p[S], jumps))

        def rate_slopes(self, v, w, psi, e, p):
            """Slopes of `rates_in_v`; only a law of one state has h_k1, so none but its own."""
            by_omega, by_psi = self.state_rate_slopes(v, w, psi, e, p)
            R_omega, R_psi = self.resistance_slopes(v, w, psi, e, p)
            by_R = times(p[DS] / p[S], p[k:last])
            return plus(by_omega, times(R_omega, by_R)), plus(by_psi, product(by_R, R_psi))

        def rate_drift(self, v, w, psi, p):
            """d/dT of `rates_in_v` at constant v and psi."""
            growth = p[DS] / p[S]
            return times(p[DDS] / p[S] - growth * growth, self.jumps(v, w, psi, p))

        def after_jump(self, v, w, psi, e, p, rise):
            """psi where ln s has risen at once, at constant V, from which v then follows.

            R changes in proportion to the jumps, which it makes larger or smaller.
            """
            _, by_psi = self.resistance_slopes(v, w, psi, e, p)
            growth = rise * dot(by_psi, p[k:last])
            grows = abs(growth) > 0.0
            effective = rise * where(grows, expm1(growth) / where(grows, growth, 1.0), 1.0)
            return plus(psi, times(effective, self.jumps(v, w, psi, p)))

        def history(self, p):
            """Those of p that belong to the history."""
            return p[BASE:]

        def later(self, p, dT):
            """p at a time dT later in the same segment."""
            return self.at_time(p, p[BASE] + dT * p[RATE], p[RATE], p[PHASE] + dT * p[FREQUENCY])

        def at_time(self, p, base, rate, phase):
            """p where the base and its rate are these, and the sinusoid's phase."""
            amplitude, frequency = p[AMPLITUDE], p[FREQUENCY]
            speed = 2.0 * math.pi * frequency
            wave = amplitude * sine(phase)
            ds, dds = rate + speed * amplitude * cosine(phase), -speed * speed * wave
            history = base, rate, amplitude, frequency, phase, base + wave, ds, dds
            return p[:last] + history

        def stiffness(self, kappa, p):
            """K Dc/(a sigma(t))."""
            return kappa / p[S]

    return Varying
