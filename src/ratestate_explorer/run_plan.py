"""The run that is shown: its initial state, its loading and its duration."""

import dataclasses
from typing import Any, NamedTuple

import numpy as np

import ratestate as rs

RTOL = 1e-6  # of the run shown
# Tolerance of the motion up to the start of a run, and most cycles before time 0.
LEAD_RTOL, LEAD_CYCLES = 1e-9, 3
# Speed of the steady sliding in which a run begins, as a multiple of V_lp: as for `limit_cycle`.
START = 0.1
# Fewest and most cycles shown; decades by which a disturbance decays meanwhile.
FEWEST_CYCLES, MOST_CYCLES, DECAYS = 6.0, 40.0, 1.5
# Most saved points of the cycles shown.
MOST_POINTS = 12000
# Slip shown if the motion has no time scale of its own, as a multiple of the longest Dc.
SLIP = 100.0


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """A run of `simulate`, which is shown and can be downloaded."""

    slider: rs.SpringSlider
    settings: dict[str, Any]  # keyword arguments of `simulate`, in SI
    changes: tuple[float, ...]  # s: starts of the parts of an experiment; time 0 on the page first

    def run(self, **other):
        """Return the result of `simulate`, perhaps with other settings; it raises as `simulate`."""
        return rs.simulate(self.slider, **{"rtol": RTOL, **self.settings, **other})


class Settled(NamedTuple):
    """A slider on its limit cycle, or in steady sliding, before time 0."""

    slider: rs.SpringSlider
    V_lp: float
    orbit: Any = None  # Dataset of the cycle, from its stress maximum on; or None, or one point

    @property
    def on_cycle(self):
        """Whether it is on a cycle."""
        return self.orbit is not None and self.orbit.sizes["time"] > 1

    def start(self, lead):
        """Return settings of a run that starts `lead` [s] or less before time 0, and that time.

        The time is rounded.  A cycle has its stress maximum at time 0.
        """
        if not self.on_cycle:
            return {"V_start": self.V_lp}, rounded(lead)
        period = float(self.orbit.time[-1])
        lead = rounded(min(lead, LEAD_CYCLES * period))
        after_maximum = -lead % period  # time from the maximum before the start to the start
        run = rs.simulate(
            self.slider,
            rs.Loading.constant(self.V_lp),
            after_maximum or period,
            initial=self._state_of(self.orbit, 0),
            times=[after_maximum],
            rtol=LEAD_RTOL,
        )
        return {"initial": self._state_of(run, -1)}, lead

    def kicked(self, factor, sigma):
        """Return the slider at time 0, and settings of a run that starts then, its V multiplied.

        sigma : normal stress from then on [Pa]; if it steps, V is the speed after the step
        """
        if sigma != self.slider.sigma:
            initial = self._after_stress_step(sigma)
        elif self.on_cycle:
            initial = self._state_of(self.orbit, 0)
        else:
            initial = {"V": self.V_lp}  # the rest is steady sliding at V_start
        initial["V"] *= factor
        return self.slider.replace(sigma=sigma), {"V_start": self.V_lp, "initial": initial}

    def _after_stress_step(self, sigma):
        """Return the state at time 0, a dict, at which the normal stress steps to sigma [Pa]."""
        start, lead = self.start(self.slider.Dc / self.V_lp)
        loading = rs.Loading.constant(self.V_lp).sigma_step(lead, sigma)
        run = rs.simulate(self.slider, loading, 2.0 * lead, times=[lead], rtol=LEAD_RTOL, **start)
        return self._state_of(run, -1)

    def _state_of(self, run, k):
        """Return a run's state at its k-th time, a dict, as `initial` of `simulate`.

        Without mass the stress follows from the other values.
        """
        stress = ("tau",) if self.slider.M > 0.0 else ()
        symbols = ("V", *self.slider.friction_law.states, *stress)
        return {symbol: float(run[symbol][k]) for symbol in symbols}


def plan_of(verdict, orbit):
    """Return the `Plan` of the run that shows a slider's motion: its `Verdict` and its orbit.

    It begins in steady sliding at `START` times the speed, as for `limit_cycle`.
    """
    time = rounded(min(durations(verdict, orbit)))
    start = float(f"{START * verdict.V_lp:.12g}")  # (0.1 times 0.2 is 0.020000000000000004)
    settings = {"loading": rs.Loading.constant(verdict.V_lp), "t_end": time, "V_start": start}
    return Plan(verdict.slider, settings, (0.0,))


def transient_note(verdict, orbit):
    """Return a sentence if the run ends before the transient has decayed; else ""."""
    decay, longest = durations(verdict, orbit)
    if decay <= longest:
        return ""
    cycles = longest * (1.0 / verdict.period if verdict.period else verdict.omega / (2.0 * np.pi))
    unit = "cycles" if verdict.period else "oscillations"
    return f"The run shown is {cycles:.3g} {unit} long. Its transient has not decayed by then."


def durations(verdict, orbit):
    """Return the duration of the transient [s], and the longest that shows single cycles [s]."""
    if verdict.period:
        longest = max(min(MOST_CYCLES, MOST_POINTS / orbit.sizes["time"]), 2.0)
        decay = max(DECAYS * verdict.fade, min(FEWEST_CYCLES, longest))
        return verdict.period * decay, verdict.period * longest
    if verdict.amplitude is not None and verdict.growth_rate < 0.0:
        decay = 3.0 * DECAYS * np.log(10.0) / -verdict.growth_rate
        rings = MOST_CYCLES * 2.0 * np.pi / verdict.omega if verdict.omega > 0.0 else np.inf
        return decay, rings
    slider = verdict.slider
    time = SLIP * max(map(slider.values.get, slider.friction_law.lengths)) / verdict.V_lp
    return time, time


def rounded(time):
    """Return a time [s] rounded to few digits, for files that people read."""
    return float(f"{time:.6g}")
