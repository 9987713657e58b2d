"""Stick-slip of random sliders, of which the limit cycle is known exactly."""

from typing import NamedTuple

import numpy as np
import xarray

import ratestate as rs
from ratestate.dynamics.cycles.limit_cycle import orbit


class Cycle(NamedTuple):
    """A slider on its limit cycle at V_lp, and the truth about each event."""

    slider: rs.SpringSlider
    V_lp: float  # [m/s]
    start: dict  # the state at the beginning
    drop: float  # [Pa]
    period: float  # [s]
    V_max: float  # [m/s]

    def run(self, periods, samples=None):
        """The run over so many periods, at the solver's own steps or so many samples a period."""
        end = periods * self.period
        times = None if samples is None else np.linspace(0.0, end, round(periods * samples) + 1)
        loading, start = rs.Loading.constant(self.V_lp), {"initial": self.start}
        V_start = {"V_start": 0.5 * self.V_lp}
        return rs.simulate(self.slider, loading, end, times=times, rtol=1e-8, **start, **V_start)

    def record(self, periods, samples, noise, rng, correlation=0.0):
        """What a laboratory records: tau with noise of this part of the drop, and delta_lp."""
        run = self.run(periods, samples)
        z = rng.normal(size=run.sizes["time"])
        for i in range(1, z.size if correlation else 0):
            z[i] = correlation * z[i - 1] + np.sqrt(1.0 - correlation**2) * z[i]
        columns = {"tau": ("time", run.tau.values + noise * self.drop * z)}
        columns["delta_lp"] = ("time", run.delta_lp.values)
        return xarray.Dataset(columns, {"time": run.time.values})


def drawn(seed):
    """A `Cycle` with one return a period, drawn from a wide range; None where there is none.

    Ranges: either law, a 0.003 to 0.016, b/a 1.3 to 3, Dc 1 to 100 um, sigma 2 to 50 MPa, K 0.2 to
    0.9 K_c_qs, V_lp 0.1 um/s to 1 mm/s, eta 1e-6 to 3, so with inertia from none to all there is.
    """
    rng = np.random.default_rng(5000 + seed)
    a, Dc, sigma = 10 ** rng.uniform((-2.5, -6, 6.3), (-1.8, -4, 7.7))
    b = a * rng.uniform(1.3, 3.0)
    K = rng.uniform(0.2, 0.9) * sigma * (b - a) / Dc
    V_lp = 10 ** rng.uniform(-7, -3)
    eta = 10 ** rng.uniform(-6, 0.5)
    law = ("slip", "aging")[int(rng.integers(2))]
    M = eta * a * sigma * Dc / V_lp**2
    slider = rs.SpringSlider(a=a, b=b, Dc=Dc, sigma=sigma, K=K, M=M, V0=1e-6, law=law)
    try:
        cycle = rs.limit_cycle(slider, V_lp)
        if int(cycle.status) or int(cycle.returns) != 1:
            return None
        whole = orbit(slider, V_lp)
    except rs.SolverError:
        return None
    first = {name: float(whole[name][0]) for name in ("V", "theta", "tau")}
    truth = float(cycle.amplitude) * sigma, float(cycle.period), float(cycle.V_max)
    known = Cycle(slider, V_lp, first, *truth)
    # (half a period on, while the spring is loaded: no event at the record's start)
    half = known.run(0.5, 2).isel(time=-1)
    return known._replace(start={name: float(half[name]) for name in first})


def cycles(number, first=0):
    """So many `Cycle`s, from this seed on."""
    seed, found = first, []
    while len(found) < number:
        if (one := drawn(seed)) is not None:
            found.append(one)
        seed += 1
    return found


class Sawtooth(NamedTuple):
    """A record of stress that the load point raises evenly and events lower, and its truth."""

    record: xarray.Dataset
    times: np.ndarray  # (m,) middles of the falls [s]
    drops: np.ndarray  # (m,) [Pa]
    durations: np.ndarray  # (m,) [s]
    K: float  # [Pa/m]


def sawtooth(starts, drops, width, rng, noise=0.0, end=None, uneven=0.0, V_lp=1e-5):
    """A `Sawtooth` with one sample a second, in noise of this standard deviation [Pa].

    Stress falls by half a cosine: from starts (m,) on, by drops (m,) in `width` [s].  A sample is
    up to `uneven` / 2 seconds early or late.
    """
    starts, drops = np.asarray(starts, float), np.asarray(drops, float)
    end = starts[-1] + 0.5 * float(np.mean(np.diff(starts))) if end is None else end
    rate = drops.sum() / end

    def stress(t):
        u = np.clip((t[:, None] - starts) / width, 0.0, 1.0)
        return 2e6 + rate * t - (0.5 - 0.5 * np.cos(np.pi * u)) @ drops

    # stress falls where the cosine's slope is beyond the rate, so a little inside the width
    inner = np.arcsin(np.minimum(rate * 2.0 * width / (np.pi * drops), 1.0)) / np.pi * width
    times, durations = starts + 0.5 * width, width - 2.0 * inner
    own = stress(times - 0.5 * durations) - stress(times + 0.5 * durations)
    t = np.arange(0.0, end)
    t = t + uneven * rng.uniform(-0.5, 0.5, t.size)
    columns = {"tau": ("time", stress(t) + noise * rng.normal(size=t.size))}
    columns["delta_lp"] = ("time", V_lp * t)
    record = xarray.Dataset(columns, {"time": t})
    return Sawtooth(record, times, own, durations, rate / V_lp)
