"""The built-in friction laws.

The methods `runaway` use y = v + psi = ln(V theta/Dc) and c = b/a - 1.  At V >> V_lp the slip D
replaces time.  The conditions guarantee that y, and so V, only grows from then on.
"""

from types import MappingProxyType

from .functions import exp, expm1, log, sinh, sqrt, where
from .law import FrictionLaw
from .law_formula import Parameter


class SlipLaw(FrictionLaw):
    """d theta/dt = -(V theta/Dc) ln(V theta/Dc) (eq. 3 of Im et al., 2019)."""

    name = "slip"
    label = "slip (Ruina) law"
    synonyms = ("ruina",)
    source = (
        "Ruina (1983) doi:10.1029/JB088iB12p10359; of runaway: Gu, Rice, Ruina & Tse (1984) "
        "doi:10.1016/0022-5096(84)90007-3"
    )

    def evolution(self, V, theta, p):
        return -(V * theta / p.Dc) * log(V * theta / p.Dc)

    def runaway(self, v, psi, kappa, p):
        """Return whether c > 0 and Q = y - kappa/c >= 0: dQ/dD = c Q + kappa w_lp/w > 0."""
        c = p.b / p.a - 1.0
        return (c > 0.0) & (c * (v + psi[0]) >= kappa)


class AgingLaw(FrictionLaw):
    """d theta/dt = 1 - V theta/Dc (eq. 2 of Im et al., 2019)."""

    name = "aging"
    label = "aging (Dieterich) law"
    synonyms = ("ageing", "dieterich", "slowness")
    source = (
        "Dieterich (1979) doi:10.1029/JB084iB05p02161; of runaway: Ranjith & Rice (1999) "
        "doi:10.1016/S0022-5096(98)00113-6"
    )

    def evolution(self, V, theta, p):
        return 1.0 - V * theta / p.Dc

    def runaway(self, v, psi, kappa, p):
        """Return whether c (1 - exp(-y)) >= kappa, as dy/dD = c (1 - exp(-y)) - kappa."""
        c = p.b / p.a - 1.0
        return (c > kappa) & (-c * expm1(-v - psi[0]) >= kappa)


class FlashHeatingLaw(FrictionLaw):
    """d Psi/dt = -(V/Dc) (Psi - Psi_ss), with mu = a asinh(V/(2 V0) exp(Psi/a)).

    Psi_ss is chosen so that mu in steady sliding is

        mu_ss = mu_w + (mu_lv - mu_w)/(1 + (V/V_w)^8)^(1/8),    mu_lv = mu0 - (b - a) ln(V/V0).

    Psi = mu0 + b ln(V0 theta/Dc) defines theta.  The friction is the regularized form.
    """

    name = "flash-heating"
    label = "flash-heating law"
    synonyms = ("flash",)
    source = "Noda, Dunham & Rice (2009) doi:10.1029/2008JB006143; benchmark TPV104 of SCEC"
    form = "regularized"
    parameters = MappingProxyType(
        {
            "V_w": Parameter("m/s", "speed from which contacts flash-heat", "> 0", "'0.1 m/s'"),
            "mu_w": Parameter("1", "friction at seismic speeds", ">= 0", "0.2"),
        }
    )

    def evolution(self, V, theta, p):
        """Return -(theta/b) (V/Dc) (Psi - Psi_ss), since d Psi = (b/theta) d theta."""
        mu_lv = p.mu0 - (p.b - p.a) * log(V / p.V0)
        mu_ss = p.mu_w + (mu_lv - p.mu_w) / (1.0 + (V / p.V_w) ** 8) ** 0.125
        Psi_ss = p.a * log(2.0 * p.V0 / V * sinh(mu_ss / p.a))
        Psi = p.mu0 + p.b * log(p.V0 * theta / p.Dc)
        return -(theta / p.b) * (V / p.Dc) * (Psi - Psi_ss)

    def complaint(self, slider):
        """Return a problem if b <= 0, mu_lv <= 0 at V_w, or mu_w > mu0."""
        import numpy as np

        if np.any(slider.b <= 0.0):
            return "needs b > 0, since theta is counted by b", "Give another b."
        slow = slider.mu0 - (slider.b - slider.a) * np.log(slider.V_w / slider.V0)
        if np.any(slow <= 0.0):
            return (
                f"gives a steady friction mu0 - (b - a) ln(V/V0) of {float(np.min(slow)):.3g} at "
                "V_w, without any heat",
                "Give a larger mu0, or a smaller b or V_w.",
            )
        excess = slider.mu_w - slider.mu0
        if np.any(excess > 0.0):
            i = np.argmax(np.ravel(excess))
            mu_w, mu0 = (np.ravel(x + 0.0 * excess)[i] for x in (slider.mu_w, slider.mu0))
            return (
                f"has mu_w = {mu_w:.6g} > mu0 = {mu0:.6g}, but mu_w is the friction of contacts "
                "that heat has weakened",
                "Give a smaller mu_w, or a larger mu0.",
            )
        return None


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
        return exp(-V / p.V_cut) - (V * theta / p.Dc) * log(V * theta / p.Dc)

    def runaway(self, v, psi, kappa, p):
        """Return whether c > 0 and c y >= kappa: at V >> V_cut the law is the slip law."""
        c = p.b / p.a - 1.0
        return (c > 0.0) & (c * (v + psi[0]) >= kappa)


class NagataLaw(FrictionLaw):
    """d theta/dt = 1 - V theta/Dc - (c/b) theta (d tau_f/dt)/sigma.

    tau_f = sigma mu, with mu of eq. 1.  The law integrates phi = (1 + c) psi + (c a/b) v, whose
    rate needs no derivative of the stress.  If V jumps, theta jumps too.
    """

    name = "nagata"
    label = "stress-weakening (Nagata) law"
    source = "Nagata, Nakatani & Yoshida (2012) doi:10.1029/2011JB008818"
    parameters = MappingProxyType(
        {"c": Parameter("1", "stress weakening of the state", ">= 0", "2.0")}
    )

    def evolution(self, V, theta, p):
        """Return theta d phi/dt = 1 - V theta/Dc."""
        return 1.0 - V * theta / p.Dc

    def _per_v(self, p):
        """Return c a/b, or 0 if c = 0."""
        return where(p.c > 0.0, p.c * p.a / p.b, 0.0)

    def log_theta(self, v, psi, p):
        """Return ln(V_ref theta/Dc) = (phi - (c a/b) v)/(1 + c)."""
        return [(psi[0] - self._per_v(p) * v) / (1.0 + p.c)]

    def variables_of(self, v, logs, p):
        """Return phi from ln(V_ref theta/Dc)."""
        return [(1.0 + p.c) * logs[0] + self._per_v(p) * v]

    def complaint(self, slider):
        """Return a problem if b = 0 and c > 0, because the law divides c by b."""
        divides = (slider.b == 0.0) * (slider.c > 0.0)
        divides = divides.any() if hasattr(divides, "any") else divides
        return ("has b = 0 and c > 0", "Give another b, or c = 0.") if divides else None

    def jumps_with_normal_stress(self, mu, alpha, slider):
        """Return d phi/d ln sigma; the stress on the contacts changes by mu d sigma."""
        b = slider.b + 1.0 * (slider.b == 0.0)  # if b is 0, so are c and alpha
        return (-(slider.c * mu + alpha) / b,)

    def runaway(self, v, psi, kappa, p):
        """Return whether (b/a - 1) (1 - exp(-y)) >= k = kappa (1 + c - c a/b).

        dy/dD = (b/a - 1) (1 - exp(-y)) - k, as under the aging law with another stiffness.
        """
        c, k = p.b / p.a - 1.0, kappa * (1.0 + p.c - self._per_v(p))
        y = v + self.log_theta(v, psi, p)[0]
        return (c > k) & (-c * expm1(-y) >= k)


class PRZLaw(FrictionLaw):
    """d theta/dt = (1 - (V theta/Dc)^2)/2.

    theta is Dc/V in steady sliding: half the theta of the original law, 1 - (V theta/(2 Dc))^2.
    """

    name = "prz"
    label = "PRZ (Perrin, Rice & Zheng) law"
    synonyms = ("perrin-rice-zheng",)
    source = "Perrin, Rice & Zheng (1995) doi:10.1016/0022-5096(95)00036-I"

    def evolution(self, V, theta, p):
        return (1.0 - (V * theta / p.Dc) ** 2) / 2.0

    def runaway(self, v, psi, kappa, p):
        """Return whether c > 0 and c sinh(y) >= kappa: dy/dD > c sinh(y) - kappa."""
        c = p.b / p.a - 1.0
        return (c > 0.0) & (c * sinh(v + psi[0]) >= kappa)


class TwoStateLaw(FrictionLaw):
    """mu = mu0 + a ln(V/V0) + b ln(V0 theta/Dc) + b2 ln(V0 theta2/Dc2)."""

    source = (
        "Ruina (1983) doi:10.1029/JB088iB12p10359; Gu, Rice, Ruina & Tse (1984) "
        "doi:10.1016/0022-5096(84)90007-3"
    )
    states = MappingProxyType({"theta": ("b", "Dc"), "theta2": ("b2", "Dc2")})
    parameters = MappingProxyType(
        {
            "b2": Parameter("1", "evolution effect of the second state", example="0.002"),
            "Dc2": Parameter("m", "critical slip distance of the second state", "> 0", "'100 um'"),
        }
    )


class TwoStateAgingLaw(TwoStateLaw):
    """d theta_k/dt = 1 - V theta_k/D_k; friction: `TwoStateLaw`."""

    name = "two-state-aging"
    label = "two-state aging law"
    synonyms = ("two-state-ageing", "two-state-dieterich")

    def evolution(self, V, theta, p):
        return 1.0 - V * theta[0] / p.Dc, 1.0 - V * theta[1] / p.Dc2

    def runaway(self, v, psi, kappa, p):
        """Return whether both y_k = v + psi_k grow from here on, or v is huge.

        With q_k = 1 - exp(-y_k), the rates are (b q_1 + b2 (Dc/Dc2) q_2)/a - kappa - q_1 for y_1,
        and with (Dc/Dc2) q_2 in place of the last q_1 for y_2.  If neither b nor b2 is negative,
        each rate rises with the other's y, so both stay positive.
        """
        b1, b2 = p.b / p.a, p.b2 / p.a
        q1, q2 = -expm1(-v - psi[0]), -(p.Dc / p.Dc2) * expm1(-v - psi[1])
        drive = b1 * q1 + b2 * q2 - kappa
        grows = (b1 >= 0.0) & (b2 >= 0.0) & (drive >= q1) & (drive >= q2)
        return (v > 600.0) | (grows & (q1 > 0.0) & (q2 > 0.0))


class TwoStateSlipLaw(TwoStateLaw):
    """d theta_k/dt = -(V theta_k/D_k) ln(V theta_k/D_k); friction: `TwoStateLaw`."""

    name = "two-state-slip"
    label = "two-state slip law"
    synonyms = ("two-state-ruina",)

    def evolution(self, V, theta, p):
        ages = V * theta[0] / p.Dc, V * theta[1] / p.Dc2
        return tuple(-age * log(age) for age in ages)

    def runaway(self, v, psi, kappa, p):
        """Return whether (v + psi_1, v + psi_2) is beyond a saddle's stable direction.

        y = (v + psi_1, v + psi_2) obeys dy/dD = A y - kappa (1, 1).  The determinant of A is
        -(Dc/Dc2) c with c = (b + b2)/a - 1, so c > 0 means a saddle.  The left eigenvector of its
        positive eigenvalue gives the side to which y runs away, and V grows on one side of the
        right eigenvector.  Other motions are followed to speeds at which only runaway is possible.
        """
        b1, b2, r = p.b / p.a, p.b2 / p.a, p.Dc / p.Dc2
        c = b1 + b2 - 1.0
        positive_c = where(c > 0.0, c, 1.0)
        half = 0.5 * (b1 - 1.0 + r * (b2 - 1.0))
        growth = half + sqrt(half * half + r * positive_c)
        steady = kappa / positive_c
        y1, y2 = v + psi[0] - steady, v + psi[1] - steady / r
        # each eigenvector has two forms, of which one does not vanish
        m1, m2 = growth - b1 + 1.0, growth - r * (b2 - 1.0)
        by_m1 = (b1 * y1 + m1 * y2) * (b1 * b1 + m1 * r * b2)
        by_m2 = (m2 * y1 + r * b2 * y2) * (b1 * m2 + r * r * b2 * b2)
        side = where(abs(m1) > abs(m2), by_m1, by_m2)
        return ((c > 0.0) & (side >= 0.0)) | ((c <= 0.0) & (v > 6000.0))


#: the built-in laws, the default law first
BUILT_IN = (
    SlipLaw(),
    AgingLaw(),
    FlashHeatingLaw(),
    KatoTullisLaw(),
    NagataLaw(),
    PRZLaw(),
    TwoStateAgingLaw(),
    TwoStateSlipLaw(),
)
