"""The motion that has settled before time 0, and how a run begins in it."""

from typing import Any, NamedTuple

from ....dynamics.simulation.simulate import SimulateCall, simulate
from ....model.initial_state import initial_values
from ....model.loading import Loading
from ....model.slider import SpringSlider

RTOL = 1e-9  # of the motion up to the start of a run
# Cycles before time 0, at most.
LEAD_CYCLES = 3


class Settled(NamedTuple):
    """A slider on its limit cycle, or in steady sliding."""

    slider: SpringSlider
    V_lp: float
    orbit: Any = None  # Dataset of the cycle, from its stress maximum on; or None, or one point

    @property
    def on_cycle(self):
        """Whether it is on a cycle."""
        return self.orbit is not None and self.orbit.sizes["time"] > 1

    @property
    def symbols(self):
        """Symbols of what fixes a state; without mass the stress follows from the others."""
        stress = ("tau",) if self.slider.M > 0.0 else ()
        return ("V", *self.slider.friction_law.states, *stress)

    def start(self, lead):
        """Settings of a run that starts `lead` [s] or less before time 0, and that time, rounded.

        A cycle has its stress maximum at time 0.
        """
        if not self.on_cycle:
            return {"V_start": self.V_lp}, rounded(lead)
        period = float(self.orbit.time[-1])
        lead = rounded(min(lead, LEAD_CYCLES * period))
        since = -lead % period  # time from the maximum before the start to the start
        run = simulate(
            self.slider,
            Loading.constant(self.V_lp),
            since or period,
            initial=self._state_of(self.orbit, 0),
            times=[since],
            rtol=RTOL,
        )
        return {"initial": self._state_of(run, -1)}, lead

    def kicked(self, factor, sigma):
        """The slider at time 0, and settings of a run that starts then, its V multiplied.

        sigma : normal stress from then on [Pa]; where it is another, V is that after its change
        """
        if sigma != self.slider.sigma:
            initial = self._after_stress_step(sigma)
        elif self.on_cycle:
            initial = self._state_of(self.orbit, 0)
        else:
            initial = {"V": self.V_lp}  # the rest is that of steady sliding at V_start
        initial["V"] *= factor
        return self.slider.replace(sigma=sigma), {"V_start": self.V_lp, "initial": initial}

    def _after_stress_step(self, sigma):
        """dict of the state at time 0, where the normal stress steps to sigma [Pa]."""
        start, lead = self.start(self.slider.Dc / self.V_lp)
        loading = Loading.constant(self.V_lp).sigma_step(lead, sigma)
        settings = {"times": [lead], "rtol": RTOL, "V_start": start.get("V_start")}
        initial = initial_values(start.get("initial"), self.slider.friction_law)
        call = SimulateCall(self.slider, loading, 2.0 * lead, initial=initial, **settings)
        return self._state_of(call.result(), -1)

    def _state_of(self, run, k):
        """dict of a run's state at its k-th time, as `initial` of `simulate`."""
        return {symbol: float(run[symbol][k]) for symbol in self.symbols}


def rounded(time):
    """A time [s] rounded to few digits, for files that people read."""
    return float(f"{time:.6g}")
