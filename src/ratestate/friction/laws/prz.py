"""The law of Perrin, Rice and Zheng: symmetric in slip and healing near steady sliding."""

from ..functions import sinh
from ..law import FrictionLaw


class PRZLaw(FrictionLaw):
    """d theta/dt = (1 - (V theta/Dc)^2)/2.

    theta is counted such that it is Dc/V in steady sliding: half of that in the original
    1 - (V theta/(2 Dc))^2.
    """

    name = "prz"
    label = "PRZ (Perrin, Rice & Zheng) law"
    synonyms = ("perrin-rice-zheng",)
    source = "Perrin, Rice & Zheng (1995) doi:10.1016/0022-5096(95)00036-I"

    def evolution(self, V, theta, p):
        """(1 - (V theta/Dc)^2)/2."""
        return (1.0 - (V * theta / p.Dc) ** 2) / 2.0

    def runaway(self, v, psi, kappa, p):
        """c sinh(y) >= kappa, where c = b/a - 1 > 0 and y = v + psi.

        dy/dD = c sinh(y) - kappa + kappa w_lp/w then stays positive, with slip D instead of time.
        """
        c = p.b / p.a - 1.0
        return (c > 0.0) & (c * sinh(v + psi[0]) >= kappa)
