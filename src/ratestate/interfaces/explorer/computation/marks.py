"""The critical values that the page marks on its sliders."""

import numpy as np

from ....friction.stability import eta

#: field -> the critical values of its quantity, attributes of the `Verdict`
OF_VERDICT = {"K": ("K_c", "K_fold"), "V_lp": ("V_c", "V_c_upper")}

#: fields on whose sliders values are marked
MARKED = (*OF_VERDICT, "M")


def marks(verdict):
    """Field -> [[name, value in SI], ...] of those that exist, in rising order.

    M_c, the mass at which K = K_c, is there where eq. 6 gives it: for laws of one length.
    """
    found = {
        field: [[name, getattr(verdict, name)] for name in names]
        for field, names in OF_VERDICT.items()
    }
    found["M"] = [["M_c", _critical_mass(verdict.slider, verdict.V_lp)]]
    return {field: [row for row in rows if _exists(row[1])] for field, rows in found.items()}


def _critical_mass(slider, V_lp):
    """The mass per area [kg/m^2] at which K = K_c; None where it has no closed form or place."""
    if not slider.friction_law.one_length or slider.b <= slider.a:
        return None
    of_unit_mass = eta(V_lp, a=slider.a, Dc=slider.Dc, sigma=slider.sigma, M=1.0)
    return (slider.K / slider.K_c_qs - 1.0) / of_unit_mass


def _exists(value):
    return value is not None and np.isfinite(value) and value > 0.0
