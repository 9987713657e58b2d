"""Claims on friction itself: Fig. 1 and section 2.2."""

import math

import numpy as np

from ..dynamics.simulation.simulate import simulate
from ..model.loading import Loading
from .claim import Claim, to_digits
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
    rows = [
        (
            "direct_effect",
            "At an e-fold step in velocity friction rises at once by a.",
            ("a = 0.003", 0.003, 0.0001, ""),
            (rise, slider.a),
            f"With the paper's K/sigma = 1e5 1/m instead of a rigid drive: {peak:.5f}. {NO_MASS}",
        ),
        (
            "evolution_effect",
            "Friction then falls by b.",
            ("b = 0.004", 0.004, 0.0001, ""),
            (fall, slider.b),
            NO_MASS,
        ),
        (
            "evolution_distance",
            "Of this fall, 1/e is left after a slip of Dc.",
            ("Dc = 10 um", 10.0, 1.0, "um"),
            (1e6 * distance, 1e6 * exact),
            AGING if law == "aging" else NO_MASS,
        ),
        (
            "net_change",
            "From one steady state to the next friction changes by a - b.",
            ("a - b = -0.001", -0.001, 0.0001, ""),
            (net, slider.a - slider.b),
            NO_MASS,
        ),
    ]
    return [
        Claim(
            id=name,
            where="sec. 2.2, Fig. 1",
            claim=claim,
            paper=paper,
            unit=unit,
            converged=(float(value),),
            error=abs(float(value) - truth),
            error_from="against the closed form of a rigid drive",
            covers=(to_digits(number, digit),),
            note=note,
        )
        for name, claim, (paper, number, digit, unit), (value, truth), note in rows
    ]


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
