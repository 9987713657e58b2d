"""Strong weakening at seismic speeds, where contacts flash-heat: slip law, steady friction cut."""

from types import MappingProxyType

from ..elementary import sinh
from ..expressions import log
from ..functions import coth, flash, log_2_sinh, logistic
from ..law import FrictionLaw, Parameter


class FlashHeatingLaw(FrictionLaw):
    """d Psi/dt = -(V/Dc) (Psi - Psi_ss), with mu = a asinh(V/(2 V0) exp(Psi/a)).

    Psi_ss is such that in steady sliding mu is

        mu_ss = mu_w + (mu_lv - mu_w)/(1 + (V/V_w)^8)^(1/8),    mu_lv = mu0 - (b - a) ln(V/V0).

    Psi = mu0 + b ln(V0 theta/Dc) defines theta, and friction is that of the regularized form.
    p = (b/a, mu_w/a, ln(V_w/V_ref), mu_lv(V_ref)/a).

    Source: Noda, Dunham & Rice (2009) doi:10.1029/2008JB006143; benchmark TPV104 of SCEC.
    """

    name = "flash-heating"
    label = "flash-heating law"
    synonyms = ("flash",)
    form = "regularized"
    of_slider = ("mu0", "V0")
    parameters = MappingProxyType(
        {
            "V_w": Parameter("m/s", "speed from which contacts flash-heat", "> 0", "'0.1 m/s'"),
            "mu_w": Parameter("1", "friction at seismic speeds", ">= 0", "0.2"),
        }
    )

    def evolution(self, V, theta, p):
        """-(theta/b) (V/Dc) (Psi - Psi_ss), by d Psi = (b/theta) d theta."""
        mu_lv = p.mu0 - (p.b - p.a) * log(V / p.V0)
        mu_ss = p.mu_w + (mu_lv - p.mu_w) / (1.0 + (V / p.V_w) ** 8) ** 0.125
        Psi_ss = p.a * log(2.0 * p.V0 / V * sinh(mu_ss / p.a))
        Psi = p.mu0 + p.b * log(p.V0 * theta / p.Dc)
        return -(theta / p.b) * (V / p.Dc) * (Psi - Psi_ss)

    def coefficients(self, V_ref, slider):
        """p = (b/a, mu_w/a, ln(V_w/V_ref), mu_lv(V_ref)/a)."""
        import numpy as np

        a, beta = slider.a, slider.b / slider.a
        low_speed = slider.mu0 / a - (beta - 1.0) * np.log(V_ref / slider.V0)
        return beta, slider.mu_w / a, np.log(slider.V_w / V_ref), low_speed

    def rescaled(self, p, ratio):
        """p for V_ref times `ratio`."""
        import numpy as np

        beta, weak, v_w, low_speed = p
        return beta, weak, v_w - np.log(ratio), low_speed - (beta - 1.0) * np.log(ratio)

    def complaint(self, slider):
        """Of b <= 0, by which the state is counted; of no friction; of heat that strengthens."""
        import numpy as np

        if np.any(slider.b <= 0.0):
            return "b must be > 0, as theta is counted by it; give another b"
        slow = slider.mu0 - (slider.b - slider.a) * np.log(slider.V_w / slider.V0)
        if np.any(slow <= 0.0):
            return (
                f"steady friction mu0 - (b - a) ln(V/V0) would be {float(np.min(slow)):.3g} at "
                "V_w, without any heat; give a larger mu0, or a smaller b or V_w"
            )
        excess = slider.mu_w - slider.mu0
        if np.any(excess > 0.0):
            i = np.argmax(np.ravel(excess))
            mu_w, mu0 = (np.ravel(x + 0.0 * excess)[i] for x in (slider.mu_w, slider.mu0))
            return (
                f"mu_w = {mu_w:.6g} must be <= mu0 = {mu0:.6g}, for it is the friction of contacts "
                "that heat has weakened; give a smaller mu_w, or a larger mu0"
            )
        return ""

    def steady_variables(self, p):
        """psi in steady sliding at V_ref."""
        return (self._steady(0.0, p),)

    def _friction(self, v, p):
        """mu_ss/a in steady sliding at this v."""
        return p[1] + (p[3] - (p[0] - 1.0) * v - p[1]) * flash(v - p[2])

    def _friction_partials(self, v, p):
        """Derivatives of `_friction` by v: first, second and third."""
        c, excess = p[0] - 1.0, p[3] - (p[0] - 1.0) * v - p[1]
        F, hot = flash(v - p[2]), logistic(8.0 * (v - p[2]))
        bend = hot * (1.0 - hot)
        first, second = -F * hot, F * (hot * hot - 8.0 * bend)
        third = F * (24.0 * hot * bend - hot * hot * hot - 64.0 * bend * (1.0 - 2.0 * hot))
        by_v, by_vv = excess * first - c * F, excess * second - 2.0 * c * first
        return by_v, by_vv, excess * third - 3.0 * c * second

    def _steady(self, v, p):
        """psi in steady sliding at this v."""
        return (log_2_sinh(self._friction(v, p)) - v - p[3]) / p[0]

    def _steady_partials(self, v, p):
        """Derivatives of `_steady` by v: first, second and third."""
        one, two, three = self._friction_partials(v, p)
        slope = coth(self._friction(v, p))
        fall = slope * slope - 1.0  # of the slope
        third = slope * three - 3.0 * fall * one * two + 2.0 * slope * fall * one * one * one
        return (
            (slope * one - 1.0) / p[0],
            (slope * two - fall * one * one) / p[0],
            third / p[0],
        )

    def rates(self, v, w, psi, e, p):
        """d psi/dT = -w (psi - psi_ss)."""
        return (-w * (psi[0] - self._steady(v, p)),)

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of `rates` by v and by psi."""
        off, one = psi[0] - self._steady(v, p), self._steady_partials(v, p)[0]
        return (-w * (off - one),), (-w,)

    def rate_partials_2(self, v, w, psi, e, p):
        """Second derivatives of `rates`: vv, v psi, psi psi."""
        off, steady = psi[0] - self._steady(v, p), self._steady_partials(v, p)
        return (-w * (off - 2.0 * steady[0] - steady[1]),), (-w,), (0.0,)

    def rate_partials_3(self, v, w, psi, e, p):
        """Third derivatives of `rates`: vvv, vv psi, v psi psi, psi psi psi."""
        off, steady = psi[0] - self._steady(v, p), self._steady_partials(v, p)
        by_vvv = -w * (off - 3.0 * steady[0] - 3.0 * steady[1] - steady[2])
        return (by_vvv,), (-w,), (0.0,), (0.0,)
