"""Two states, each by the aging law over its own distance."""

import math

from ..two_states import TwoStateLaw


class TwoStateAgingLaw(TwoStateLaw):
    """d theta_k/dt = 1 - V theta_k/D_k, k = 1, 2; friction as of `TwoStateLaw`."""

    name = "two-state-aging"
    label = "two-state aging law"
    synonyms = ("two-state-ageing", "two-state-dieterich")

    def evolution(self, V, theta, p):
        """1 - V theta_k/D_k of each."""
        return 1.0 - V * theta[0] / p.Dc, 1.0 - V * theta[1] / p.Dc2

    def exponents(self, v, w, psi, p):
        """e = (exp(-psi_1), exp(-psi_2))."""
        return -psi[0], -psi[1]

    def rates(self, v, w, psi, e, p):
        """d psi_1/dT = exp(-psi_1) - w, d psi_2/dT = (Dc/Dc2) (exp(-psi_2) - w)."""
        return e[0] - w, p[2] * (e[1] - w)

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of `rates` by v, and by the state of each."""
        return (-w, -p[2] * w), (-e[0], -p[2] * e[1])

    def rate_partials_2(self, v, w, psi, e, p):
        """Second derivatives of `rates`: vv, v psi, psi psi."""
        return (-w, -p[2] * w), (0.0, 0.0), (e[0], p[2] * e[1])

    def rate_partials_3(self, v, w, psi, e, p):
        """Third derivatives of `rates`: vvv, vv psi, v psi psi, psi psi psi."""
        return (-w, -p[2] * w), (0.0, 0.0), (0.0, 0.0), (-e[0], -p[2] * e[1])

    def heals_at_rest(self):
        """Whether state evolves without slip; here it does."""
        return True

    def runs_away(self, v, psi, kappa, p):
        """Whether y_k = v + psi_k both grow from here on; else it is followed to huge speeds.

        With slip D instead of time, q_k = 1 - exp(-y_k) and V >> V_lp they grow at the rates
        (b q_1 + b2 (Dc/Dc2) q_2)/a - kappa less q_1, or (Dc/Dc2) q_2.  Where b and b2 are not
        negative both rates rise with the other's y, so that they stay positive.
        """
        b1, b2, r = p[0], p[1], p[2]
        q1, q2 = -math.expm1(-v - psi[0]), -r * math.expm1(-v - psi[1])
        drive = b1 * q1 + b2 * q2 - kappa
        grows = b1 >= 0.0 and b2 >= 0.0 and drive >= q1 and drive >= q2
        return v > 600.0 or (grows and q1 > 0.0 and q2 > 0.0)

    def held(self, psi, v, w, h, p):
        """psi after a time h at the constant speed w = exp(v), and its derivative by v: tuples."""
        new, slope = self.held_alone(psi[0], w, h)
        new2, slope2 = self.held_alone(psi[1], w, p[2] * h)
        return (new, new2), (slope, slope2)

    def held_alone(self, psi, w, h):
        """`held` of one state, over the time h Dc/D_k."""
        decay = math.exp(-w * h)
        theta = math.exp(psi)
        grown = -math.expm1(-w * h) / w
        new = theta * decay + grown
        return math.log(new), (w * h * decay * (1.0 / w - theta) - grown) / new
