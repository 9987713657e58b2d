"""Friction with two states, each of which evolves over a distance of its own."""

from types import MappingProxyType

from .law import FrictionLaw, Parameter


class TwoStateLaw(FrictionLaw):
    """mu = mu0 + a ln(V/V0) + b ln(V0 theta/Dc) + b2 ln(V0 theta2/Dc2).

    p = (b/a, b2/a, Dc/Dc2).  Source: Ruina (1983) doi:10.1029/JB088iB12p10359; Gu, Rice, Ruina &
    Tse (1984) doi:10.1016/0022-5096(84)90007-3.
    """

    states = MappingProxyType({"theta": "Dc", "theta2": "Dc2"})
    parameters = MappingProxyType(
        {
            "b2": Parameter("1", "evolution effect of the second state", example="0.002"),
            "Dc2": Parameter("m", "critical slip distance of the second state", "> 0", "'100 um'"),
        }
    )

    def coefficients(self, V_ref, slider):
        """p = (b/a, b2/a, Dc/Dc2)."""
        return slider.b / slider.a, slider.b2 / slider.a, slider.Dc / slider.Dc2

    def evolution_effects(self, p):
        """Derivatives of the friction of eq. 1 by each of psi, a tuple."""
        return p[0], p[1]

    def resistance(self, v, w, psi, p):
        """(mu - mu_ref)/a."""
        return v + p[0] * psi[0] + p[1] * psi[1]

    def resistance_partials(self, v, w, psi, p):
        """Derivatives of `resistance` by v and by each of psi."""
        return 1.0, (p[0], p[1])

    def resistance_partials_2(self, v, w, psi, p):
        """Second derivatives of `resistance`, all 0."""
        return 0.0, (0.0, 0.0), ((0.0, 0.0), (0.0, 0.0))
