"""Two states, each by the slip law over its own distance."""

import math

from ..expressions import log
from ..two_states import TwoStateLaw


class TwoStateSlipLaw(TwoStateLaw):
    """d theta_k/dt = -(V theta_k/D_k) ln(V theta_k/D_k), k = 1, 2; friction as of `TwoStateLaw`."""

    name = "two-state-slip"
    label = "two-state slip law"
    synonyms = ("two-state-ruina",)

    def evolution(self, V, theta, p):
        """-(V theta_k/D_k) ln(V theta_k/D_k) of each."""
        ages = V * theta[0] / p.Dc, V * theta[1] / p.Dc2
        return tuple(-age * log(age) for age in ages)

    def rates(self, v, w, psi, e, p):
        """d psi_1/dT = -w (v + psi_1), d psi_2/dT = -(Dc/Dc2) w (v + psi_2)."""
        return -w * (v + psi[0]), -p[2] * w * (v + psi[1])

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of `rates` by v, and by the state of each."""
        w2 = p[2] * w
        return (-w * (v + psi[0]) - w, -w2 * (v + psi[1]) - w2), (-w, -w2)

    def rate_partials_2(self, v, w, psi, e, p):
        """Second derivatives of `rates`: vv, v psi, psi psi."""
        w2 = p[2] * w
        by_vv = -w * (v + psi[0]) - 2.0 * w, -w2 * (v + psi[1]) - 2.0 * w2
        return by_vv, (-w, -w2), (0.0, 0.0)

    def rate_partials_3(self, v, w, psi, e, p):
        """Third derivatives of `rates`: vvv, vv psi, v psi psi, psi psi psi."""
        w2 = p[2] * w
        by_vvv = -w * (v + psi[0]) - 3.0 * w, -w2 * (v + psi[1]) - 3.0 * w2
        return by_vvv, (-w, -w2), (0.0, 0.0), (0.0, 0.0)

    def runs_away(self, v, psi, kappa, p):
        """Whether y = (v + psi_1, v + psi_2) is beyond the stable direction of a saddle.

        With slip D instead of time dy/dD = A y - kappa (1, 1), linear, where V >> V_lp.  Of the
        determinant of A, -(Dc/Dc2) c with c = (b + b2)/a - 1, the sign is that of a saddle where
        c > 0: then y runs away to the side of the left eigenvector (of the eigenvalue > 0) on which
        it is, with V growing along the right one to one of the sides.  Elsewhere it is followed
        to speeds at which nothing else than runaway is left.
        """
        b1, b2, r = p[0], p[1], p[2]
        c = b1 + b2 - 1.0
        if c <= 0.0:
            return v > 6000.0
        half = 0.5 * (b1 - 1.0 + r * (b2 - 1.0))
        growth = half + math.sqrt(half * half + r * c)
        steady = kappa / c
        y1, y2 = v + psi[0] - steady, v + psi[1] - steady / r
        # of two forms of the left eigenvector, and of the right one, those that do not vanish
        if abs(growth - b1 + 1.0) > abs(growth - r * (b2 - 1.0)):
            along = (b1 * y1 + (growth - b1 + 1.0) * y2) * (b1 * b1 + (growth - b1 + 1.0) * r * b2)
        else:
            l1 = growth - r * (b2 - 1.0)
            along = (l1 * y1 + r * b2 * y2) * (b1 * l1 + r * r * b2 * b2)
        return along >= 0.0

    def held(self, psi, v, w, h, p):
        """psi after a time h at the constant speed w = exp(v), and its derivative by v: tuples."""
        h2 = p[2] * h
        decay, decay2 = math.exp(-w * h), math.exp(-w * h2)
        y, y2 = psi[0] + v, psi[1] + v
        slopes = decay * (1.0 - y * w * h) - 1.0, decay2 * (1.0 - y2 * w * h2) - 1.0
        return (y * decay - v, y2 * decay2 - v), slopes
