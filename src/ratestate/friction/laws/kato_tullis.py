"""The composite law of Kato and Tullis: slip law, with healing below a speed of its own."""

from types import MappingProxyType

from ..expressions import exp, log
from ..law import FrictionLaw, Parameter


class KatoTullisLaw(FrictionLaw):
    """d theta/dt = exp(-V/V_cut) - (V theta/Dc) ln(V theta/Dc).

    p = (b/a, V_ref/V_cut).  Source: Kato & Tullis (2001) doi:10.1029/2000GL012060.
    """

    name = "kato-tullis"
    label = "composite (Kato & Tullis) law"
    synonyms = ("composite",)
    parameters = MappingProxyType(
        {"V_cut": Parameter("m/s", "speed below which state heals at rest", "> 0", "'1e-8 m/s'")}
    )

    def evolution(self, V, theta, p):
        """exp(-V/V_cut) - (V theta/Dc) ln(V theta/Dc)."""
        return exp(-V / p.V_cut) - (V * theta / p.Dc) * log(V * theta / p.Dc)

    def coefficients(self, V_ref, slider):
        """p = (b/a, V_ref/V_cut)."""
        return slider.b / slider.a, V_ref / slider.V_cut

    def rescaled(self, p, ratio):
        """p for V_ref times `ratio`."""
        return p[0], p[1] * ratio

    def steady_variables(self, p):
        """psi where psi exp(psi) = exp(-V_ref/V_cut): Lambert's W function."""
        import numpy as np
        from scipy.special import lambertw  # slow to import

        return (lambertw(np.exp(-p[1])).real + 0.0 * p[0],)

    def exponents(self, v, w, psi, p):
        """e = (exp(-psi), exp(-V/V_cut))."""
        return -psi[0], -p[1] * w

    def rates(self, v, w, psi, e, p):
        """d psi/dT = exp(-psi) exp(-V/V_cut) - w (v + psi)."""
        return (e[0] * e[1] - w * (v + psi[0]),)

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of `rates` by v and by psi."""
        healing, u = e[0] * e[1], p[1] * w
        return (-u * healing - w * (v + psi[0]) - w,), (-healing - w,)

    def rate_partials_2(self, v, w, psi, e, p):
        """Second derivatives of `rates`: vv, v psi, psi psi."""
        healing, u = e[0] * e[1], p[1] * w
        by_vv = u * (u - 1.0) * healing - w * (v + psi[0]) - 2.0 * w
        return (by_vv,), (u * healing - w,), (healing,)

    def rate_partials_3(self, v, w, psi, e, p):
        """Third derivatives of `rates`: vvv, vv psi, v psi psi, psi psi psi."""
        healing, u = e[0] * e[1], p[1] * w
        by_vvv = -u * (u * (u - 3.0) + 1.0) * healing - w * (v + psi[0]) - 3.0 * w
        return (by_vvv,), (-u * (u - 1.0) * healing - w,), (-u * healing,), (-healing,)

    def heals_at_rest(self):
        """Whether state evolves without slip; here it does."""
        return True

    def runs_away(self, v, psi, kappa, p):
        """Whether c (v + psi) >= kappa, c = b/a - 1 > 0: at V >> V_cut this is the slip law."""
        c = p[0] - 1.0
        return c > 0.0 and c * (v + psi[0]) >= kappa
