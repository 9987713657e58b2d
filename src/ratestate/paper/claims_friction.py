"""Claims on friction itself: Fig. 1 and section 2.2."""

import math

import numpy as np

from .. import Loading, simulate
from .claim import TIGHT
from .parameters import FIG1

STIFFNESS = 1e5  # 1/m, the paper's K/sigma
POINTS = 4001


def on_friction(law):
    """The claims of Fig. 1: friction of a rigidly driven slider after an e-fold step."""
    slider = FIG1.replace(law=law)
    a, b, Dc, mu0 = slider.a, slider.b, slider.Dc, slider.mu0
    reach = 30 * Dc  # exp(-30) of the fall is rounding
    mu, slip = _friction(slider, reach), np.linspace(0.0, reach, POINTS)
    left = (mu - mu[-1]) / (mu[0] - mu[-1])
    begin = slip < 2 * Dc
    distance = np.interp(1.0, -np.log(left[begin]), slip[begin])
    exact = Dc if law == "slip" else Dc * math.log((math.e - 1) / math.expm1(1 / math.e))
    values = {
        "direct_effect": (mu[0] - mu0, a),
        "evolution_effect": (mu[0] - mu[-1], b),
        "evolution_distance": (1e6 * distance, 1e6 * exact),
        "net_change": (mu[-1] - mu0, a - b),
    }
    peak = _friction(slider.replace(K=STIFFNESS * slider.sigma), 10 * Dc).max() - mu0
    return {
        name: {
            "converged": (float(value),),
            "error": abs(float(value) - truth),
            "error_from": "against the closed form of a rigid drive",
            "texts": {"peak": peak},
        }
        for name, (value, truth) in values.items()
    }


def _friction(slider, reach):
    """mu after an e-fold step from V0, at even slips of the load point up to `reach` [m]."""
    V = math.e * slider.V0
    times = np.linspace(0.0, reach / V, POINTS)
    step = {"V_start": slider.V0, "times": times, "rtol": TIGHT}
    return simulate(slider, Loading.constant(V), times[-1], **step).mu.values
