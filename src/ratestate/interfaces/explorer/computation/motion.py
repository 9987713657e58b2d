"""The run that is shown: its initial state, its loading and its duration."""

import dataclasses
from typing import Any

import numpy as np

from ....dynamics.simulation.simulate import simulate_call
from ....model.loading import Loading
from ....model.slider import SpringSlider
from .settled import rounded

RTOL = 1e-6  # of the run shown
# Speed of the steady sliding in which a run begins, over V_lp: as for `limit_cycle`.
START = 0.1
# Cycles shown: at least, at most; and by how many decades a disturbance decays meanwhile.
FEWEST_CYCLES, MOST_CYCLES, DECAYS = 6.0, 40.0, 1.5
# Saved points of the cycles shown, at most.
MOST_POINTS = 12000
# Slip shown where the motion has no time scale of its own, in the longest distance of a state.
SLIP = 100.0


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """A run of `simulate`, which is shown and can be downloaded."""

    slider: SpringSlider
    settings: dict[str, Any]  # keyword arguments of `simulate`, in SI
    changes: tuple[float, ...]  # s: starts of the parts of an experiment; time 0 on the page first

    def call(self, t_end=None, times=None):
        """The `SimulateCall`, up to t_end [s] or, by default, the whole run."""
        arguments: dict[str, Any] = dict.fromkeys(("V_start", "initial"))
        arguments |= {"rtol": RTOL, "method": "auto", "times": times} | self.settings
        if t_end is not None:
            arguments["t_end"] = t_end
        return simulate_call(self.slider, **arguments)


def plan_of(verdict, orbit):
    """The `Plan` of the run that shows a slider's motion: its `Verdict` and its cycle's orbit.

    It begins in steady sliding at `START` of the speed, as for `limit_cycle`.
    """
    time = rounded(min(durations(verdict, orbit)))
    start = float(f"{START * verdict.V_lp:.12g}")  # (0.1 times 0.2 is 0.020000000000000004)
    settings = {"loading": Loading.constant(verdict.V_lp), "t_end": time, "V_start": start}
    return Plan(verdict.slider, settings, (0.0,))


def steady_stress(slider, V):
    """tau/sigma in steady sliding at a speed."""
    columns = {symbol: np.atleast_1d(x) for symbol, x in slider.values.items()}
    return slider.friction_law.steady_tau(np.array([V]), columns).item()


def transient_note(verdict, orbit):
    """A sentence if the shown run ends before the transient has decayed; else ""."""
    decay, most = durations(verdict, orbit)
    if decay <= most:
        return ""
    cycles = most * (1.0 / verdict.period if verdict.period else verdict.omega / (2.0 * np.pi))
    what = "cycles" if verdict.period else "oscillations"
    return f"The run shown is {cycles:.3g} {what} long, and its transient has not decayed by then."


def durations(verdict, orbit):
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
    time = SLIP * max(map(slider.values.get, slider.friction_law.lengths)) / verdict.V_lp
    return time, time
