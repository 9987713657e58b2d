"""Which run is shown: from which start, under which load, and for how long."""

import dataclasses
from typing import Any

import numpy as np

from ...dynamics.simulation.simulate import simulate_call
from ...model.loading import Loading
from ...model.slider import SpringSlider

RTOL = 1e-6
# Speed of the steady sliding in which a run begins, over V_lp: that of `limit_cycle`.
START = 0.1
# Cycles shown: at least, at most; and how often a disturbance falls to a tenth meanwhile.
FEWEST, MOST, SETTLED = 6.0, 40.0, 1.5
# Saved points of the cycles shown, at most.
MOST_POINTS = 12000
# Slip shown where the motion has no time of its own, in Dc.
SLIP = 100.0
# Of the time shown, what is shown before a step; at most this many cycles.
LEAD, LEAD_CYCLES = 0.2, 3


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """A run that `simulate` does: what is shown, and what is downloaded."""

    slider: SpringSlider
    settings: dict[str, Any]  # keyword arguments of `simulate`, in SI
    t_step: float  # s: when the load point steps to the speed that is shown, shown as time 0

    def call(self, t_end=None):
        """The `SimulateCall`, perhaps with an earlier end."""
        unused = dict.fromkeys(("V_start", "initial", "times", "dt"))
        asked = unused | {"rtol": RTOL, "method": "rodas5p"} | self.settings
        return simulate_call(self.slider, **asked | ({} if t_end is None else {"t_end": t_end}))


def plan_of(found, turn, before=None):
    """The run that shows what a slider does.

    Parameters
    ----------
    found : Verdict
        At the speed shown.
    turn : Dataset or None
        Its limit cycle, from `orbit`.
    before : tuple of (V_from, Dataset or None), optional
        The speed before, and the limit cycle there: the motion from which the load point steps.
        Without it the run begins in steady sliding at `START` of the speed, as `limit_cycle`.
    """
    time = _rounded(min(_times(found, turn)))
    if before is None:
        loading = Loading.constant(found.V_lp)
        settings = {"loading": loading, "t_end": time, "V_start": START * found.V_lp}
        return Plan(found.slider, settings, 0.0)
    V_from, cycle = before
    start, lead = _start(found.slider, V_from, cycle, LEAD * time)
    loading = Loading.steps(V_from, (lead, found.V_lp))
    settings = {"loading": loading, "t_end": _rounded(lead + time), **start}
    return Plan(found.slider, settings, lead)


def unsettled(found, turn):
    """A sentence where the motion is not shown until it has settled; else ""."""
    settled, most = _times(found, turn)
    if settled <= most:
        return ""
    turns = most * (1.0 / found.period if found.period else found.omega / (2.0 * np.pi))
    what = "cycles" if found.period else "swings"
    return f"The run shown is {turns:.3g} {what} long, and has not settled by then."


def _times(found, turn):
    """How long the motion takes to settle [s], and how long until its cycles no longer part."""
    if found.period:
        most = max(min(MOST, MOST_POINTS / turn.sizes["time"]), 2.0)
        settled = max(SETTLED * found.fade, min(FEWEST, most))
        return found.period * settled, found.period * most
    if found.amplitude is not None and found.growth_rate < 0.0:
        settled = 3.0 * SETTLED * np.log(10.0) / -found.growth_rate
        rings = MOST * 2.0 * np.pi / found.omega if found.omega > 0.0 else np.inf
        return settled, rings
    time = SLIP * found.slider.Dc / found.V_lp
    return time, time


def _start(slider, V_from, cycle, lead):
    """Where a run begins that steps from a motion, as settings of `simulate`; and when it steps.

    From a cycle it steps at the stress maximum.
    """
    if cycle is None or cycle.sizes["time"] < 2:
        return {"V_start": V_from}, _rounded(lead)
    times = cycle.time.values
    period = times[-1]
    lead = min(lead, LEAD_CYCLES * period)
    i = int(np.argmin(np.abs(times[:-1] - (-lead) % period)))
    names = ("V", "theta", "tau") if slider.M > 0.0 else ("V", "theta")
    initial = {name: float(cycle[name][i]) for name in names}
    whole = np.floor(lead / period) * period
    return {"initial": initial}, _rounded(whole + (period - times[i] if i else 0.0) or period)


def _rounded(time):
    """A time [s] of few digits, for files that people read."""
    return float(f"{time:.6g}")
