"""Claims on steps across the critical velocity: Fig. 2, section 3.1."""

import numpy as np
import xarray

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..dynamics.steady_sliding import stability
from ..model.loading import Loading
from .claim import exact, pair
from .parameters import FIG2, FIG2_DURATION, FIG2_SPEEDS, FIG2_START
from .scheme_map import FINER, LARGEST, METHOD, critical_velocity, step_response, time_step

# Of the slip law alone, with which the paper's runs were made.
STABLE_IN_THE_PAPER = (
    ": the paper's runs find it stable, so by this form of the scheme took smaller steps."
)
FINER_STEPS = " Steps near omega dt = 0.01 give the paper's range and its stable 3.1 mm/s."
LAST = 0.1  # s at the end of a run in which its oscillation is measured


def on_steps(law):
    """The claims of Fig. 2."""
    slider = FIG2.replace(law=law)
    below, above = (1e-6 * slider.K_c(V) for V in FIG2_SPEEDS[1:])
    steps = {od: (od, time_step(slider, od)) for od in (LARGEST, FINER)}
    scheme_V_c = {
        step: (1e3 * critical_velocity(slider, od, METHOD[law]),) for od, step in steps.items()
    }
    rates = [float(stability(slider, V).growth_rate) for V in FIG2_SPEEDS]
    at_V_c = abs(float(stability(slider, slider.V_c).growth_rate))
    slope = (rates[2] - rates[1]) / (FIG2_SPEEDS[2] - FIG2_SPEEDS[1])
    V_c = {
        "converged": (1e3 * slider.V_c,),
        "error": 1e3 * max(at_V_c / slope, 1e-15 * slider.V_c),
        "error_from": "growth rate of the linear modes at V_c, over its slope",
        "scheme": scheme_V_c,
    }
    fates = {f"step_to_{1e3 * V:g}": _fate(slider, V, steps) for V in FIG2_SPEEDS}
    return {
        "K_c_qs": exact(1e-6 * slider.K_c_qs),
        "V_c": V_c,
        "K_c_of_steps": exact(below, above),
        "first_swing": pair(lambda rtol: _swing(slider, rtol)),
        "growth_rates": exact(*rates),
        **fates,
        "cycle_range": _cycle(slider, steps),
    }


def _fate(slider, V_lp, steps):
    """Whether the oscillation after the step to V_lp has died out."""
    scheme = {
        (od, dt): last_amplitude(
            step_response(slider, FIG2_START, V_lp, FIG2_DURATION, od, METHOD[slider.law], LAST)
        )
        for od, dt in steps.values()
    }
    stable = STABLE_IN_THE_PAPER if slider.law == "slip" else "."
    measured = pair(lambda rtol: _end_of_step(slider, V_lp, rtol))
    return measured | {"scheme": scheme, "texts": {"largest": LARGEST, "slip_stable": stable}}


def _swing(slider, rtol):
    """Largest V/V_lp after each step."""
    V_lp = xarray.DataArray(FIG2_SPEEDS, dims="V_lp")
    run = simulate(slider, Loading.constant(V_lp), 1.0, V_start=FIG2_START, rtol=rtol)
    return tuple((run.V_max.values / V_lp.values).tolist())


def _end_of_step(slider, V_lp, rtol):
    times = FIG2_DURATION + np.linspace(-LAST, 0.0, 2001)
    return last_amplitude(
        simulate(
            slider,
            Loading.constant(V_lp),
            FIG2_DURATION,
            V_start=FIG2_START,
            times=times,
            rtol=rtol,
        )
    )


def last_amplitude(run):
    """Max - min of tau/sigma over what was saved."""
    return (float(run.tau.max() - run.tau.min()) / FIG2.sigma,)


def _cycle(slider, steps):
    V_lp = FIG2_SPEEDS[-1]

    def measure(rtol):
        cycle = limit_cycle(slider, V_lp, rtol=rtol)
        return 1e3 * float(cycle.V_min), 1e3 * float(cycle.V_max)

    runs = {
        (od, dt): step_response(
            slider, FIG2_START, V_lp, FIG2_DURATION, od, METHOD[slider.law], LAST
        )
        for od, dt in steps.values()
    }
    scheme = {step: (1e3 * float(r.V.min()), 1e3 * float(r.V.max())) for step, r in runs.items()}
    finer = FINER_STEPS if slider.law == "slip" else ""
    return pair(measure) | {"scheme": scheme, "texts": {"slip_range": finer}}
