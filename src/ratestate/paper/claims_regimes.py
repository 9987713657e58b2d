"""Claims on where inertia acts (Figs 4b, 4c), and on what makes slip unstable (section 5)."""

import numpy as np

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..dynamics.steady_sliding import stability
from ..model.loading import Loading
from .claim import exact, pair
from .parameters import FIG2, FIG2_SPEEDS, FIG4, FIG4_EXAMPLES
from .scheme_map import LARGEST, METHOD, step_response, time_step

CYCLES = 40  # after which the examples of Fig. 4 have settled
SHARE = 0.01  # of the amplitude, beyond which inertia counts as acting


def on_regimes(law):
    """The claims of Figs 4b and 4c, and of section 5."""
    return _inertia(law) | _conclusions(law)


def _inertia(law):
    slider = FIG4.replace(law=law)
    claims = {}
    for name, V_lp in FIG4_EXAMPLES.items():
        period = float(limit_cycle(slider, V_lp).period)

        def share(rtol, V_lp=V_lp, period=period):
            t_end = CYCLES * period
            run = simulate(slider, Loading.constant(V_lp), t_end, V_start=0.1 * V_lp, rtol=rtol)
            return (_share(run.sel(time=slice(t_end - period, None)), slider),)

        run = step_response(slider, 0.1 * V_lp, V_lp, CYCLES * period, LARGEST, METHOD[law], period)
        claims[f"inertia_in_{name}"] = pair(share) | {
            "scheme": {(LARGEST, time_step(slider, LARGEST)): (_share(run, slider),)},
            "texts": {"share": 100 * SHARE, "V_lp": V_lp},
        }
    return claims


def _share(run, slider):
    """Share of a run's time in which inertia acts; straight lines between its points."""
    stress = run.tau.values / slider.sigma
    excess = np.abs(stress - run.mu.values) - SHARE * (stress.max() - stress.min())
    low, high = np.sort([excess[:-1], excess[1:]], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(low >= 0, 1.0, np.where(high <= 0, 0.0, high / (high - low)))
    dt = np.diff(run.time.values)
    return float((part * dt).sum() / dt.sum())


def _conclusions(law):
    slider = FIG2.replace(law=law)
    rates = [
        float(stability(s, FIG2_SPEEDS[-1]).growth_rate) for s in (slider.replace(M=0.0), slider)
    ]
    stiff = [slider.replace(K=factor * slider.K_c_qs) for factor in (2.0, 10.0, 100.0)]
    growth = [float(stability(s, 1.01 * s.V_c).growth_rate) / s.V_c * s.Dc for s in stiff]
    strengthening = slider.replace(b=0.9 * slider.a, K=1e-3 * slider.K_c_qs)
    fading = max(float(stability(strengthening, V).growth_rate) for V in np.geomspace(1e-9, 10, 41))
    light = slider.replace(M=0.1 * slider.M)

    def frequencies(rtol):
        return [float(limit_cycle(s, 1.1 * s.V_c, rtol=rtol).frequency) for s in (light, slider)]

    mass = pair(lambda rtol: (light.V_c / slider.V_c, np.divide(*frequencies(rtol)).item()))
    return {
        "inertia_destabilises": exact(*rates),
        "any_stiffness": exact(*growth),
        "weakening_needed": exact(fading),
        "less_mass": mass,
    }
