"""Strong weakening at seismic speeds, where contacts flash-heat: slip law, steady friction cut."""

from types import MappingProxyType

from ..functions import log, sinh
from ..law import FrictionLaw, Parameter


class FlashHeatingLaw(FrictionLaw):
    """d Psi/dt = -(V/Dc) (Psi - Psi_ss), with mu = a asinh(V/(2 V0) exp(Psi/a)).

    Psi_ss is such that in steady sliding mu is

        mu_ss = mu_w + (mu_lv - mu_w)/(1 + (V/V_w)^8)^(1/8),    mu_lv = mu0 - (b - a) ln(V/V0).

    Psi = mu0 + b ln(V0 theta/Dc) defines theta, and friction is that of the regularized form.
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
        """-(theta/b) (V/Dc) (Psi - Psi_ss), by d Psi = (b/theta) d theta."""
        mu_lv = p.mu0 - (p.b - p.a) * log(V / p.V0)
        mu_ss = p.mu_w + (mu_lv - p.mu_w) / (1.0 + (V / p.V_w) ** 8) ** 0.125
        Psi_ss = p.a * log(2.0 * p.V0 / V * sinh(mu_ss / p.a))
        Psi = p.mu0 + p.b * log(p.V0 * theta / p.Dc)
        return -(theta / p.b) * (V / p.Dc) * (Psi - Psi_ss)

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
