"""The law of Nagata: a change of the stress on the contacts changes their state."""

from types import MappingProxyType

from ..functions import expm1, where
from ..law import FrictionLaw, Parameter


class NagataLaw(FrictionLaw):
    """d theta/dt = 1 - V theta/Dc - (c/b) theta (d tau_f/dt)/sigma, tau_f = sigma mu (of eq. 1).

    The variable is phi = (1 + c) psi + (c a/b) v, in which it is exact, without a derivative of the
    stress; theta itself jumps where V does.
    """

    name = "nagata"
    label = "stress-weakening (Nagata) law"
    source = "Nagata, Nakatani & Yoshida (2012) doi:10.1029/2011JB008818"
    parameters = MappingProxyType(
        {"c": Parameter("1", "stress weakening of the state", ">= 0", "2.0")}
    )

    def evolution(self, V, theta, p):
        """theta d phi/dt = 1 - V theta/Dc."""
        return 1.0 - V * theta / p.Dc

    def _per_v(self, p):
        """c a/b; 0 where c is."""
        return where(p.c > 0.0, p.c * p.a / p.b, 0.0)

    def log_theta(self, v, psi, p):
        """ln(V_ref theta/Dc) = (phi - (c a/b) v)/(1 + c)."""
        return [(psi[0] - self._per_v(p) * v) / (1.0 + p.c)]

    def variables_of(self, v, logs, p):
        """phi from ln(V_ref theta/Dc)."""
        return [(1.0 + p.c) * logs[0] + self._per_v(p) * v]

    def complaint(self, slider):
        """Of b = 0, by which the law divides c."""
        divides = (slider.b == 0.0) * (slider.c > 0.0)
        divides = divides.any() if hasattr(divides, "any") else divides
        return "b = 0 where c > 0; give another b, or c = 0" if divides else ""

    def jumps_with_normal_stress(self, mu, alpha, slider):
        """d phi/d ln sigma: the stress on the contacts changes by mu d sigma."""
        b = slider.b + 1.0 * (slider.b == 0.0)  # (where c and alpha are 0)
        return (-(slider.c * mu + alpha) / b,)

    def runaway(self, v, psi, kappa, p):
        """(b/a - 1) (1 - exp(-y)) >= k, with y = ln(V theta/Dc).

        With slip D instead of time dy/dD = (b/a - 1) (1 - exp(-y)) - k, k = kappa (1 + c - c a/b),
        where V >> V_lp: as under the aging law, with another stiffness.
        """
        c, k = p.b / p.a - 1.0, kappa * (1.0 + p.c - self._per_v(p))
        y = v + self.log_theta(v, psi, p)[0]
        return (c > k) & (-c * expm1(-y) >= k)
