"""Two states, each by the slip law over its own distance."""

from ..functions import log, sqrt, where
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

    def runaway(self, v, psi, kappa, p):
        """y = (v + psi_1, v + psi_2) is beyond the stable direction of a saddle.

        With slip D instead of time dy/dD = A y - kappa (1, 1), linear, where V >> V_lp.  Of the
        determinant of A, -(Dc/Dc2) c with c = (b + b2)/a - 1, the sign is that of a saddle where
        c > 0: then y runs away to the side of the left eigenvector (of the eigenvalue > 0) on which
        it is, with V growing along the right one to one of the sides.  Elsewhere it is followed
        to speeds at which nothing else than runaway is left.
        """
        b1, b2, r = p.b / p.a, p.b2 / p.a, p.Dc / p.Dc2
        c = b1 + b2 - 1.0
        some_c = where(c > 0.0, c, 1.0)
        half = 0.5 * (b1 - 1.0 + r * (b2 - 1.0))
        growth = half + sqrt(half * half + r * some_c)
        steady = kappa / some_c
        y1, y2 = v + psi[0] - steady, v + psi[1] - steady / r
        # of two forms of the left eigenvector, and of the right one, those that do not vanish
        m1, m2 = growth - b1 + 1.0, growth - r * (b2 - 1.0)
        one = (b1 * y1 + m1 * y2) * (b1 * b1 + m1 * r * b2)
        other = (m2 * y1 + r * b2 * y2) * (b1 * m2 + r * r * b2 * b2)
        along = where(abs(m1) > abs(m2), one, other)
        return ((c > 0.0) & (along >= 0.0)) | ((c <= 0.0) & (v > 6000.0))
