"""The law of Perrin, Rice and Zheng: symmetric in slip and healing near steady sliding."""

import math

from ..law import FrictionLaw


class PRZLaw(FrictionLaw):
    """d theta/dt = (1 - (V theta/Dc)^2)/2.

    theta is counted such that it is Dc/V in steady sliding: half of that in the original
    1 - (V theta/(2 Dc))^2.  With y = v + psi = ln(V theta/Dc) the rate is -w sinh(y).

    Source: Perrin, Rice & Zheng (1995) doi:10.1016/0022-5096(95)00036-I.
    """

    name = "prz"
    label = "PRZ (Perrin, Rice & Zheng) law"
    synonyms = ("perrin-rice-zheng",)
    one_length = True
    # h = -sinh(z)
    series = tuple(-(k % 2) / math.factorial(k) for k in range(2, 16))

    def evolution(self, V, theta, p):
        """(1 - (V theta/Dc)^2)/2."""
        return (1.0 - (V * theta / p.Dc) ** 2) / 2.0

    def exponents(self, v, w, psi, p):
        """e = (exp(-psi),)."""
        return (-psi[0],)

    def rates(self, v, w, psi, e, p):
        """d psi/dT = (exp(-psi) - w^2 exp(psi))/2 = -w sinh(y)."""
        return (0.5 * (e[0] - w * w / e[0]),)

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of `rates` by v and by psi."""
        grown = w * w / e[0]
        return (-grown,), (-0.5 * (e[0] + grown),)

    def rate_partials_2(self, v, w, psi, e, p):
        """Second derivatives of `rates`: vv, v psi, psi psi."""
        grown = w * w / e[0]
        return (-2.0 * grown,), (-grown,), (0.5 * (e[0] - grown),)

    def rate_partials_3(self, v, w, psi, e, p):
        """Third derivatives of `rates`: vvv, vv psi, v psi psi, psi psi psi."""
        grown = w * w / e[0]
        return (-4.0 * grown,), (-2.0 * grown,), (-grown,), (-0.5 * (e[0] + grown),)

    def heals_at_rest(self):
        """Whether state evolves without slip; here it does."""
        return True

    def runs_away(self, v, psi, kappa, p):
        """Whether sinh(y) >= kappa/c, where c = b/a - 1 > 0.

        dy/dD = c sinh(y) - kappa + kappa w_lp/w then stays positive, with slip D instead of time.
        """
        c = p[0] - 1.0
        return c > 0.0 and v + psi[0] >= math.asinh(kappa / c)

    def held(self, psi, v, w, h, p):
        """psi after a time h at the constant speed w = exp(v), and its derivative by v: tuples.

        tanh(y/2) decays like exp(-w h).  What it lacks of 1 is kept apart, since y may be large.
        """
        y = psi[0] + v
        small = 2.0 / (math.exp(abs(y)) + 1.0)  # 1 - |tanh(y/2)|
        decay, decayed = math.exp(-w * h), -math.expm1(-w * h)
        rest = small + (1.0 - small) * decayed  # 1 - |tanh| at the end
        end = math.log((2.0 - rest) / rest)
        by_y = decay * small * (2.0 - small) / (rest * (2.0 - rest))
        by_h = -2.0 * (1.0 - small) * decay * w * h / (rest * (2.0 - rest))
        sign = 1.0 if y >= 0.0 else -1.0
        return (sign * end - v,), (by_y + sign * by_h - 1.0,)
