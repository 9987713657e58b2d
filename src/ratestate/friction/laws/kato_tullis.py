"""The composite law of Kato and Tullis: slip law, with healing below a speed of its own."""

from types import MappingProxyType

from ..functions import exp, log
from ..law import FrictionLaw, Parameter


class KatoTullisLaw(FrictionLaw):
    """d theta/dt = exp(-V/V_cut) - (V theta/Dc) ln(V theta/Dc)."""

    name = "kato-tullis"
    label = "composite (Kato & Tullis) law"
    synonyms = ("composite",)
    source = "Kato & Tullis (2001) doi:10.1029/2000GL012060"
    parameters = MappingProxyType(
        {"V_cut": Parameter("m/s", "speed below which state heals at rest", "> 0", "'1e-8 m/s'")}
    )

    def evolution(self, V, theta, p):
        """exp(-V/V_cut) - (V theta/Dc) ln(V theta/Dc)."""
        return exp(-V / p.V_cut) - (V * theta / p.Dc) * log(V * theta / p.Dc)

    def runaway(self, v, psi, kappa, p):
        """c (v + psi) >= kappa, c = b/a - 1 > 0: at V >> V_cut this is the slip law."""
        c = p.b / p.a - 1.0
        return (c > 0.0) & (c * (v + psi[0]) >= kappa)
