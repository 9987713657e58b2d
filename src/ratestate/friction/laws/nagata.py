"""The law of Nagata: a change of the stress on the contacts changes their state."""

import math
from types import MappingProxyType

from ..law import FrictionLaw, Parameter


class NagataLaw(FrictionLaw):
    """d theta/dt = 1 - V theta/Dc - (c/b) theta (d tau_f/dt)/sigma, tau_f = sigma mu (of eq. 1).

    The variable is phi = (1 + c) psi + (c a/b) v, in which it is exact, without a derivative of the
    stress; theta itself jumps where V does.  p = (b/a, c, c a/b).

    Source: Nagata, Nakatani & Yoshida (2012) doi:10.1029/2011JB008818.
    """

    name = "nagata"
    label = "stress-weakening (Nagata) law"
    parameters = MappingProxyType(
        {"c": Parameter("1", "stress weakening of the state", ">= 0", "2.0")}
    )

    def coefficients(self, V_ref, slider):
        """p = (b/a, c, c a/b); the last is 0 where c is."""
        a, b, c = slider.a, slider.b, slider.c
        return b / a, c, c * a / (b + 1.0 * (c == 0.0) * (b == 0.0))

    def complaint(self, slider):
        """Of b = 0, by which the law divides c."""
        divides = (slider.b == 0.0) * (slider.c > 0.0)
        divides = divides.any() if hasattr(divides, "any") else divides
        return "b = 0 where c > 0; give another b, or c = 0" if divides else ""

    def jumps_with_normal_stress(self, mu, alpha, slider):
        """d phi/d ln sigma: the stress on the contacts changes by mu d sigma."""
        b = slider.b + 1.0 * (slider.b == 0.0)  # (where c and alpha are 0)
        return (-(slider.c * mu + alpha) / b,)

    def log_states(self, v, psi, p):
        """ln(V_ref theta/Dc) = (phi - (c a/b) v)/(1 + c)."""
        return ((psi[0] - p[2] * v) / (1.0 + p[1]),)

    def variables(self, v, log_states, p):
        """phi from ln(V_ref theta/Dc)."""
        return ((1.0 + p[1]) * log_states[0] + p[2] * v,)

    def exponents(self, v, w, psi, p):
        """e = (Dc/(V_ref theta),)."""
        return ((p[2] * v - psi[0]) / (1.0 + p[1]),)

    def resistance(self, v, w, psi, p):
        """(mu - mu_ref)/a."""
        return (v + p[0] * psi[0]) / (1.0 + p[1])

    def resistance_partials(self, v, w, psi, p):
        """Derivatives of `resistance` by v and by phi."""
        part = 1.0 / (1.0 + p[1])
        return part, (part * p[0],)

    def rates(self, v, w, psi, e, p):
        """d phi/dT = Dc/(V_ref theta) - w."""
        return (e[0] - w,)

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of `rates` by v and by phi."""
        by_phi = -e[0] / (1.0 + p[1])
        return (-p[2] * by_phi - w,), (by_phi,)

    def rate_partials_2(self, v, w, psi, e, p):
        """Second derivatives of `rates`: vv, v phi, phi phi."""
        by_phi_2 = e[0] / (1.0 + p[1]) ** 2
        return (p[2] ** 2 * by_phi_2 - w,), (-p[2] * by_phi_2,), (by_phi_2,)

    def rate_partials_3(self, v, w, psi, e, p):
        """Third derivatives of `rates`: vvv, vv phi, v phi phi, phi phi phi."""
        by_phi_3 = -e[0] / (1.0 + p[1]) ** 3
        by_vvv = -(p[2] ** 3) * by_phi_3 - w
        return (by_vvv,), (p[2] ** 2 * by_phi_3,), (-p[2] * by_phi_3,), (by_phi_3,)

    def heals_at_rest(self):
        """Whether state evolves without slip; here it does."""
        return True

    def runs_away(self, v, psi, kappa, p):
        """Whether exp(-y) <= 1 - k/(b/a - 1), with y = ln(V theta/Dc) and k < b/a - 1.

        With slip D instead of time dy/dD = (b/a - 1) (1 - exp(-y)) - k, k = kappa (1 + c - c a/b),
        where V >> V_lp: as under the aging law, with another stiffness.
        """
        beta, c, per_v = p[0], p[1], p[2]
        k = kappa * (1.0 + c - per_v)
        y = v + (psi[0] - per_v * v) / (1.0 + c)
        return beta - 1.0 > k and y >= -math.log1p(-k / (beta - 1.0))

    def held(self, psi, v, w, h, p):
        """phi after a time h at the constant speed w = exp(v), and its derivative by v: tuples.

        At constant speed theta ages as under the aging law, but 1 + c times as slowly.
        """
        slower, per_v = 1.0 + p[1], p[2]
        before, h = (psi[0] - per_v * v) / slower, h / slower
        decay = math.exp(-w * h)
        theta = math.exp(before)
        grown = -math.expm1(-w * h) / w
        new = theta * decay + grown
        by_v = (w * h * decay * (1.0 / w - theta) - grown) / new
        by_v -= per_v / slower * theta * decay / new
        return (slower * math.log(new) + per_v * v,), (slower * by_v + per_v,)
