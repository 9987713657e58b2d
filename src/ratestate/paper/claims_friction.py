"""Claims on friction itself: Fig. 1 and section 2.2."""

import math

import numpy as np

from ..dynamics.simulation.simulate import simulate
from ..model.loading import Loading
from .parameters import FIG1

STIFFNESS = 1e5  # 1/m, the paper's K/sigma
NO_MASS = "The paper's scheme needs a mass, and has no part in this figure."
AGING = (
    "Exact for the slip law and, in small steps, for the aging law. In an e-fold step the aging "
    "law leaves b ln(1 + (e - 1) exp(-x/Dc)), which is 1/e of the fall at x = 1.35 Dc."
)


def on_friction(law):
    """The claims of Fig. 1: friction of a rigidly driven slider after an e-fold step."""
    slider = FIG1.replace(law=law)
    mu, distance = _response(slider)
    start, end = mu[0], mu[-1]
    rise, fall, net = start - slider.mu0, start - end, end - slider.mu0
    peak = _peak(slider.replace(K=STIFFNESS * slider.sigma)) - slider.mu0
    exact = (
        slider.Dc if law == "slip" else slider.Dc * math.log((math.e - 1) / math.expm1(1 / math.e))
    )
    values = {
        "direct_effect": (rise, slider.a),
        "evolution_effect": (fall, slider.b),
        "evolution_distance": (1e6 * distance, 1e6 * exact),
        "net_change": (net, slider.a - slider.b),
    }
    texts = {"peak": peak, "no_mass": NO_MASS, "distance": AGING if law == "aging" else NO_MASS}
    return {
        name: {
            "converged": (float(value),),
            "error": abs(float(value) - truth),
            "error_from": "against the closed form of a rigid drive",
            "texts": texts,
        }
        for name, (value, truth) in values.items()
    }


def _run(slider, reach, rtol):
    """An e-fold step from V0 at even slips of the load point up to `reach` [m]."""
    V = math.e * slider.V0
    times = np.linspace(0.0, reach / V, 4001)
    return simulate(
        slider, Loading.constant(V), times[-1], V_start=slider.V0, times=times, rtol=rtol
    )


def _response(slider):
    """Friction after the step, and the slip [m] at which 1/e of the fall is left."""
    reach = 30 * slider.Dc  # exp(-30) of the fall is rounding
    mu = _run(slider, reach, rtol=1e-10).mu.values
    left = (mu - mu[-1]) / (mu[0] - mu[-1])
    slip = np.linspace(0.0, reach, left.size)
    begin = slip < 2 * slider.Dc
    return mu, np.interp(1.0, -np.log(left[begin]), slip[begin])


def _peak(slider):
    return float(_run(slider, 10 * slider.Dc, rtol=1e-10).mu.max())
