"""The slip (Ruina) law: state evolves with slip alone."""

from ..functions import log
from ..law import FrictionLaw


class SlipLaw(FrictionLaw):
    """d theta/dt = -(V theta/Dc) ln(V theta/Dc) (eq. 3 of Im, Marone & Elsworth, 2019)."""

    name = "slip"
    label = "slip (Ruina) law"
    synonyms = ("ruina",)
    source = (
        "Ruina (1983) doi:10.1029/JB088iB12p10359; of runaway: Gu, Rice, Ruina & Tse (1984) "
        "doi:10.1016/0022-5096(84)90007-3"
    )

    def evolution(self, V, theta, p):
        """-(V theta/Dc) ln(V theta/Dc)."""
        return -(V * theta / p.Dc) * log(V * theta / p.Dc)

    def runaway(self, v, psi, kappa, p):
        """Q = y - kappa/c >= 0, where c = b/a - 1 > 0 and y = v + psi.

        With slip D instead of time dQ/dD = c Q + kappa w_lp/w, so that Q, once positive, grows for
        ever, whatever the load point does.
        """
        c = p.b / p.a - 1.0
        return (c > 0.0) & (c * (v + psi[0]) >= kappa)

    def excursion(self, v, psi, kappa, beta):
        """E = -x - ln(1 - z), z = x + kappa h(v): inf from the separatrix z = 1 on."""
        import numpy as np

        from ..convex import convex

        x = v + beta * psi
        with np.errstate(divide="ignore"):
            return -x - np.log1p(-np.minimum(x + kappa * convex(v), 1.0))

    def runaway_edge(self, kappa, beta, largest):
        """The smallest disturbances that run away without mass, up to this size."""
        from ..separatrix import runaway_edge

        return runaway_edge(kappa, beta, largest)
