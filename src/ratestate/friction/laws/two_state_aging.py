"""Two states, each by the aging law over its own distance."""

from ..functions import expm1
from ..two_states import TwoStateLaw


class TwoStateAgingLaw(TwoStateLaw):
    """d theta_k/dt = 1 - V theta_k/D_k, k = 1, 2; friction as of `TwoStateLaw`."""

    name = "two-state-aging"
    label = "two-state aging law"
    synonyms = ("two-state-ageing", "two-state-dieterich")

    def evolution(self, V, theta, p):
        """1 - V theta_k/D_k of each."""
        return 1.0 - V * theta[0] / p.Dc, 1.0 - V * theta[1] / p.Dc2

    def runaway(self, v, psi, kappa, p):
        """y_k = v + psi_k both grow from here on; else it is followed to huge speeds.

        With slip D instead of time, q_k = 1 - exp(-y_k) and V >> V_lp they grow at the rates
        (b q_1 + b2 (Dc/Dc2) q_2)/a - kappa less q_1, or (Dc/Dc2) q_2.  Where b and b2 are not
        negative both rates rise with the other's y, so that they stay positive.
        """
        b1, b2 = p.b / p.a, p.b2 / p.a
        q1, q2 = -expm1(-v - psi[0]), -(p.Dc / p.Dc2) * expm1(-v - psi[1])
        drive = b1 * q1 + b2 * q2 - kappa
        grows = (b1 >= 0.0) & (b2 >= 0.0) & (drive >= q1) & (drive >= q2)
        return (v > 600.0) | (grows & (q1 > 0.0) & (q2 > 0.0))
