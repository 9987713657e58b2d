"""The aging (Dieterich) law: state evolves at rest too."""

import math

from ..functions import expm1
from ..law import FrictionLaw


class AgingLaw(FrictionLaw):
    """d theta/dt = 1 - V theta/Dc (eq. 2 of Im, Marone & Elsworth, 2019)."""

    name = "aging"
    label = "aging (Dieterich) law"
    synonyms = ("ageing", "dieterich", "slowness")
    source = (
        "Dieterich (1979) doi:10.1029/JB084iB05p02161; of runaway: Ranjith & Rice (1999) "
        "doi:10.1016/S0022-5096(98)00113-6"
    )

    def evolution(self, V, theta, p):
        """1 - V theta/Dc."""
        return 1.0 - V * theta / p.Dc

    def runaway(self, v, psi, kappa, p):
        """c (1 - exp(-y)) >= kappa, where c = b/a - 1 and y = v + psi.

        With slip D instead of time dy/dD = c (1 - exp(-y)) - kappa, where V >> V_lp.
        """
        c = p.b / p.a - 1.0
        return (c > kappa) & (-c * expm1(-v - psi[0]) >= kappa)

    def excursion(self, v, psi, kappa, beta):
        """E = kappa h(-psi) + h(-y), y = v + psi."""
        from ..convex import convex

        return kappa * convex(-psi) + convex(-(v + psi))

    def runaway_edge(self, kappa, beta, largest):
        """None: without mass every orbit comes back (Ranjith & Rice 1999)."""
        return math.inf, math.inf, math.inf
