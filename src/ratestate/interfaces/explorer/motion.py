"""The run that is shown: its initial state, its loading and its duration."""

import dataclasses
from typing import Any

import numpy as np

from ...dynamics.simulation.simulate import simulate, simulate_call
from ...model.loading import Loading
from ...model.slider import SpringSlider

RTOL, RTOL_BEFORE = 1e-6, 1e-9  # of the run shown, and of the motion up to its start
# Speed of the steady sliding in which a run begins, over V_lp: as for `limit_cycle`.
START = 0.1
# Cycles shown: at least, at most; and by how many decades a disturbance decays meanwhile.
FEWEST_CYCLES, MOST_CYCLES, DECAYS = 6.0, 40.0, 1.5
# Saved points of the cycles shown, at most.
MOST_POINTS = 12000
# Slip shown where the motion has no time scale of its own, in the longest distance of a state.
SLIP = 100.0
# Part of the shown time that comes before a step; at most this many cycles.
LEAD, LEAD_CYCLES = 0.2, 3


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """A run of `simulate`, which is shown and can be downloaded."""

    slider: SpringSlider
    settings: dict[str, Any]  # keyword arguments of `simulate`, in SI
    t_step: float  # s: of the step to the speed and normal stress shown; time 0 on the page

    def call(self, t_end=None):
        """The `SimulateCall`, up to t_end [s] or, by default, the whole run."""
        arguments: dict[str, Any] = dict.fromkeys(("V_start", "initial", "times", "dt"))
        arguments |= {"rtol": RTOL, "method": "rodas5p"} | self.settings
        if t_end is not None:
            arguments["t_end"] = t_end
        return simulate_call(self.slider, **arguments)


def plan_of(verdict, orbit, before=None):
    """The `Plan` of the run that shows a slider's motion: its `Verdict` and its cycle's orbit.

    before : the slider and the speed before the step, and the orbit of the cycle there, or None;
        without it the run begins in steady sliding at `START` of the speed, as for `limit_cycle`
    """
    time = _rounded(min(_durations(verdict, orbit)) + _reloading(verdict, before))
    if before is None:
        loading = Loading.constant(verdict.V_lp)
        start = float(f"{START * verdict.V_lp:.12g}")  # (0.1 times 0.2 is 0.020000000000000004)
        settings = {"loading": loading, "t_end": time, "V_start": start}
        return Plan(verdict.slider, settings, 0.0)
    slider, V_from, cycle = before
    start, lead = _start_settings(slider, V_from, cycle, time * LEAD / (1.0 - LEAD))
    loading = Loading.constant(V_from)
    if verdict.V_lp != V_from:
        loading = loading.step(lead, verdict.V_lp)
    if verdict.slider.sigma != slider.sigma:
        loading = loading.sigma_step(lead, verdict.slider.sigma)
    settings = {"loading": loading, "t_end": _rounded(lead + time), **start}
    return Plan(slider, settings, lead)


def _reloading(verdict, before):
    """Time [s] in which the load point brings the spring to a higher steady stress after a step."""
    if before is None or np.isinf(verdict.slider.K):
        return 0.0
    motions = before[:2], (verdict.slider, verdict.V_lp)
    earlier, later = (slider.sigma * steady_stress(slider, V) for slider, V in motions)
    return max(later - earlier, 0.0) / (verdict.slider.K * verdict.V_lp)


def steady_stress(slider, V):
    """tau/sigma in steady sliding at a speed."""
    columns = {symbol: np.atleast_1d(x) for symbol, x in slider.values.items()}
    return slider.friction_law.steady_tau(np.array([V]), columns).item()


def transient_note(verdict, orbit):
    """A sentence if the shown run ends before the transient has decayed; else ""."""
    decay, most = _durations(verdict, orbit)
    if decay <= most:
        return ""
    cycles = most * (1.0 / verdict.period if verdict.period else verdict.omega / (2.0 * np.pi))
    what = "cycles" if verdict.period else "oscillations"
    return f"The run shown is {cycles:.3g} {what} long, and its transient has not decayed by then."


def _durations(verdict, orbit):
    """Duration of the transient [s], and the longest in which single cycles can be seen [s]."""
    if verdict.period:
        most = max(min(MOST_CYCLES, MOST_POINTS / orbit.sizes["time"]), 2.0)
        decay = max(DECAYS * verdict.fade, min(FEWEST_CYCLES, most))
        return verdict.period * decay, verdict.period * most
    if verdict.amplitude is not None and verdict.growth_rate < 0.0:
        decay = 3.0 * DECAYS * np.log(10.0) / -verdict.growth_rate
        rings = MOST_CYCLES * 2.0 * np.pi / verdict.omega if verdict.omega > 0.0 else np.inf
        return decay, rings
    slider = verdict.slider
    time = SLIP * max(map(slider.values.get, slider.friction_law.states.values())) / verdict.V_lp
    return time, time


def _start_settings(slider, V_from, cycle, lead):
    """Settings of a run that starts in steady sliding or on a cycle; the time of the step.

    A cycle, whose orbit begins at its stress maximum, starts where it has that at the step.
    """
    if cycle is None or cycle.sizes["time"] < 2:
        return {"V_start": V_from}, _rounded(lead)
    period = float(cycle.time[-1])
    lead = _rounded(min(lead, LEAD_CYCLES * period))
    names = ("V", *slider.friction_law.states, *(("tau",) if slider.M > 0.0 else ()))
    initial = {name: float(cycle[name][0]) for name in names}
    since = -lead % period  # time from the maximum before the start to the start
    run = simulate(
        slider,
        Loading.constant(V_from),
        since or period,
        initial=initial,
        times=[since],
        rtol=RTOL_BEFORE,
    )
    return {"initial": {name: float(run[name][-1]) for name in names}}, lead


def _rounded(time):
    """A time [s] rounded to few digits, for files that people read."""
    return float(f"{time:.6g}")
