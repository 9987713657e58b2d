"""The slip (Ruina) law: state evolves with slip alone."""

import math

from ..expressions import log
from ..law import FrictionLaw


class SlipLaw(FrictionLaw):
    """d theta/dt = -(V theta/Dc) ln(V theta/Dc) (eq. 3 of Im, Marone & Elsworth, 2019).

    Source: Ruina (1983) doi:10.1029/JB088iB12p10359; of runaway: Gu, Rice, Ruina & Tse (1984)
    doi:10.1016/0022-5096(84)90007-3.
    """

    name = "slip"
    label = "slip (Ruina) law"
    synonyms = ("ruina",)
    one_length = True
    series = (0.0,)

    def evolution(self, V, theta, p):
        """-(V theta/Dc) ln(V theta/Dc)."""
        return -(V * theta / p.Dc) * log(V * theta / p.Dc)

    def rates(self, v, w, psi, e, p):
        """d psi/dT = -w (v + psi)."""
        return (-w * (v + psi[0]),)

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of `rates` with respect to v and to psi."""
        return (-w * (v + psi[0]) - w,), (-w,)

    def rate_partials_2(self, v, w, psi, e, p):
        """Second derivatives of `rates`: vv, v psi, psi psi."""
        return (-w * (v + psi[0]) - 2.0 * w,), (-w,), (0.0,)

    def rate_partials_3(self, v, w, psi, e, p):
        """Third derivatives of `rates`: vvv, vv psi, v psi psi, psi psi psi."""
        return (-w * (v + psi[0]) - 3.0 * w,), (-w,), (0.0,), (0.0,)

    def runs_away(self, v, psi, kappa, p):
        """Whether Q = y - kappa/c >= 0, where c = b/a - 1 > 0 and y = v + psi.

        With slip D instead of time dQ/dD = c Q + kappa w_lp/w, so that Q, once positive, grows for
        ever, whatever the load point does.
        """
        c = p[0] - 1.0
        return c > 0.0 and c * (v + psi[0]) >= kappa

    def held(self, psi, v, w, h, p):
        """psi after a time h at the constant speed w = exp(v), and its derivative by v."""
        decay = math.exp(-w * h)
        y = psi[0] + v
        return (y * decay - v,), (decay * (1.0 - y * w * h) - 1.0,)

    def relaxed(self, psi, v, v_end, slip, forced):
        """psi at the end of a slip [Dc] from the speed v to v_end, given the integral of `forcing`.

        The law is linear in s = v + psi: ds/dD = -s + dv/dD.
        """
        return (psi + v) * math.exp(-slip) + forced - v_end

    def forcing(self, curvature, part, w_end):
        """What drives s with slip: dv/dD, where (V/V_end)^2 is `part`, of slope -`curvature`."""
        return 0.5 * curvature / part

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
