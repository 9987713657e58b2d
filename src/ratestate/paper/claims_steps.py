"""Claims on steps across the critical velocity: Fig. 2, section 3.1."""

import numpy as np
import xarray

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..dynamics.steady_sliding import stability
from ..model.loading import Loading
from .claim import by_scheme, exact, pair
from .parameters import FIG2, FIG2_DURATION, FIG2_SPEEDS, FIG2_START
from .scheme_map import FINER, LARGEST, critical_velocity, step_response

# Of the slip law alone, with which the paper's runs were made.
STABLE_IN_THE_PAPER = (
    ": the paper's runs find it stable, so by this form of the scheme took smaller steps."
)
FINER_STEPS = " Steps near omega dt = 0.01 give the paper's range and its stable 3.1 mm/s."
LAST = 0.1  # s at the end of a run in which its oscillation is measured


def on_steps(law):
    """The claims of Fig. 2."""
    slider = FIG2.replace(law=law)
    rates = [float(stability(slider, V).growth_rate) for V in FIG2_SPEEDS]
    at_V_c = abs(float(stability(slider, slider.V_c).growth_rate))
    slope = (rates[2] - rates[1]) / (FIG2_SPEEDS[2] - FIG2_SPEEDS[1])
    V_c = {
        "converged": (1e3 * slider.V_c,),
        "error": 1e3 * max(at_V_c / slope, 1e-15 * slider.V_c),
        "error_from": "growth rate of the linear modes at V_c, over its slope",
        **by_scheme(lambda od: 1e3 * critical_velocity(slider, od), slider, LARGEST, FINER),
    }
    measured = {
        "K_c_qs": exact(1e-6 * slider.K_c_qs),
        "V_c": V_c,
        "K_c_of_steps": exact(*(1e-6 * slider.K_c(V) for V in FIG2_SPEEDS[1:])),
        "first_swing": pair(lambda rtol: _swing(slider, rtol)),
        "growth_rates": exact(*rates),
        **{f"step_to_{1e3 * V:g}": _fate(slider, V) for V in FIG2_SPEEDS},
        "cycle_range": _cycle(slider, FIG2_SPEEDS[-1]),
    }
    texts = {
        "largest": LARGEST,
        "slip_stable": STABLE_IN_THE_PAPER if law == "slip" else ".",
        "slip_range": FINER_STEPS if law == "slip" else "",
    }
    return {name: row | {"texts": texts} for name, row in measured.items()}


def _swing(slider, rtol):
    """Largest V/V_lp after each step."""
    V_lp = xarray.DataArray(FIG2_SPEEDS, dims="V_lp")
    run = simulate(slider, Loading.constant(V_lp), 1.0, V_start=FIG2_START, rtol=rtol)
    return run.V_max.values / V_lp.values


def _by_scheme(measure, slider, V_lp):
    """What measure(run) gives of the end of the step to V_lp, by the scheme."""

    def of_step(omega_dt):
        return measure(step_response(slider, FIG2_START, V_lp, FIG2_DURATION, omega_dt, last=LAST))

    return by_scheme(of_step, slider, LARGEST, FINER)


def _fate(slider, V_lp):
    """Whether the oscillation after the step to V_lp has died out."""
    loading, times = Loading.constant(V_lp), FIG2_DURATION + np.linspace(-LAST, 0.0, 2001)

    def end_of_step(rtol):
        end = {"V_start": FIG2_START, "times": times, "rtol": rtol}
        return last_amplitude(simulate(slider, loading, FIG2_DURATION, **end))

    return pair(end_of_step) | _by_scheme(last_amplitude, slider, V_lp)


def last_amplitude(run):
    """Max - min of tau/sigma over what was saved."""
    return float(run.tau.max() - run.tau.min()) / FIG2.sigma


def _cycle(slider, V_lp):
    """Smallest and largest velocity [mm/s] of the limit cycle."""

    def measure(rtol):
        cycle = limit_cycle(slider, V_lp, rtol=rtol)
        return 1e3 * cycle.V_min, 1e3 * cycle.V_max

    return pair(measure) | _by_scheme(
        lambda run: (1e3 * run.V.min(), 1e3 * run.V.max()), slider, V_lp
    )
