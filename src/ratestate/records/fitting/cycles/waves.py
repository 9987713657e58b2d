"""Limit cycles of many sliders at once, as waves, and their features."""

from typing import NamedTuple

import numpy as np

from ....dynamics.cycles.attractor import find_attractors, steady_start
from ....dynamics.cycles.limit_cycle import WORST
from ....dynamics.cycles.measure import refine
from ....dynamics.cycles.system import state, system_of
from ....dynamics.simulation.engine_cases import MAX_STEPS
from ....engine.model import FINISHED, Loads
from ....formulas import mu_ss
from ....friction.composition import composed_law
from ..forward import cases_of, marched
from .features import FEATURES, profile_features, wave_profiles

# Phases of a wave, from its fall through the middle: evenly spaced, and geometric sequences on both
# sides of the fall, which may be very short.
_NEAR_FALL = np.geomspace(1e-7, 0.25, 110)
GRID = np.unique(np.concatenate([np.linspace(0.0, 1.0, 513), _NEAR_FALL, 1.0 - _NEAR_FALL]))
# Number of phases in the first and later rounds of the search for the fall; number of rounds.
COARSE, FINER, ROUNDS = 513, 129, 2
# Range of b/a: beyond it cycles converge slowly.  The upper end is ten times that of any measured
# friction; at the lower end steady sliding is nearly neutral.
WEAKEST, STRONGEST = 1.01, 50.0
# Tolerances of the cycle, and of the stored period, in x, ln V and psi.
RTOL, PERIOD_RTOL = 1e-7, 1e-8


class Waves(NamedTuple):
    """Limit cycles of n sliders; NaN without a cycle, or if b/a is out of range."""

    period: np.ndarray  # (n,) [s]
    x: np.ndarray  # (n, q) (tau/sigma - its value in steady sliding)/a at the phases `GRID`
    u: np.ndarray  # (n, 2) the cycle's point on the section of shooting.py, at the largest x


def limit_waves(law, values, V_lp, near=None):
    """Return the `Waves` of n sliders at speeds V_lp (n,).

    values : symbol -> (n,) of a, b > a, Dc, sigma, K, M > 0
    near : (n, 2) points from which to start, of similar sliders; else steady sliding at V_lp/10
    """
    system = system_of(law, **values, V_lp=V_lp)
    n = V_lp.size
    cycles = Waves(np.full(n, np.nan), np.full((n, GRID.size), np.nan), np.full((n, 2), np.nan))
    start = steady_start(system) if near is None else state(system, near)
    which = np.flatnonzero((system.beta > WEAKEST) & (system.beta < STRONGEST))
    attractors = find_attractors(system.at(which), start[which], RTOL, None)
    cyclic = (attractors.status == FINISHED) & (attractors.n_returns == 1)
    which, attractors = which[cyclic], attractors.at(cyclic)
    if not which.size:
        return cycles
    cycle = refine(system.at(which), attractors, RTOL)
    good = (cycle["error"] <= WORST) & (np.abs(cycle["multipliers"][:, 0]) < 1.0)
    which = which[good]
    u, period = cycle["u"][good], cycle["period"][good]
    cycles.x[which] = _waves_from_fall(system.at(which), u, period)
    cycles.period[which] = period * values["Dc"][which] / V_lp[which]
    cycles.u[which] = u
    return cycles


def wave_at(wave):
    """Return a wave at the phases `GRID` as a periodic function of phase."""
    return lambda phase: np.interp(phase % 1.0, GRID, wave)


def _waves_from_fall(system, u, period):
    """Return x (n, q), at phases `GRID` from the fall, on cycles through u."""
    low, high = np.zeros(period.size), np.ones(period.size)
    row, count = np.arange(period.size), COARSE
    middle = None
    for _ in range(ROUNDS):
        phases = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, count)
        x = _x_at_phases(system, u, period, phases)
        if middle is None:
            middle = 0.5 * (x.max(axis=1) + x.min(axis=1))
        i = np.maximum(np.argmax(x < middle[:, None], axis=1), 1)
        low, high, count = phases[row, i - 1], phases[row, i], FINER
    phases = (0.5 * (low + high)[:, None] + GRID[:-1]) % 1.0
    order = np.argsort(phases, axis=1)
    x = np.empty((period.size, GRID.size))
    saved = _x_at_phases(system, u, period, np.take_along_axis(phases, order, axis=1))
    np.put_along_axis(x, order, saved, axis=1)
    x[:, -1] = x[:, 0]
    return x


def _x_at_phases(system, u, period, phases):
    """Return x (n, m) at increasing phases (n, m); NaN if a run fails."""
    cases = cases_of(
        kappa=system.kappa,
        p=system.beta[:, None],
        eta0=system.eta,
        scale=1.0,
        V0=1.0,
        y=np.ascontiguousarray(state(system, u)),
        t_end=period,
        times=np.arange(period.size),
        rtol=PERIOD_RTOL,
        v_limit=system.v_limit,
        max_steps=MAX_STEPS,
    )
    loads = Loads(np.zeros(1), np.ones((1, 1)), np.zeros((1, 1)))
    times = np.ascontiguousarray(np.minimum(period[:, None] * phases, period[:, None]))
    return marched(composed_law(system.law), cases, loads, times)[..., 0]


class CycleModel:
    """Features of the cycles of many sliders, at speeds V_lp (s,) with bins (s,)."""

    def __init__(self, law, V_lp, bins, sigma, V0):
        self.law, self.V_lp, self.bins, self.sigma, self.V0 = law, V_lp, bins, sigma, V0

    # values far from all sliders overflow, and have no cycle
    @np.errstate(over="ignore", divide="ignore", invalid="ignore")
    def features(self, values, near=None):
        """Return features (n, s, 6) with mu0 = 0, points (n, s, 2) and waves (n, s, q).

        values : symbol -> (n,) of a, b, Dc, K, M [SI]
        near : (s, 2) points from which to start

        `profile_features` gives the features; they are NaN without a cycle.
        """
        n, s = values["a"].size, self.V_lp.size
        each = {symbol: np.repeat(value, s) for symbol, value in values.items()}
        each["sigma"] = np.full(n * s, self.sigma)
        V_lp = np.tile(self.V_lp, n)
        cycles = limit_waves(self.law, each, V_lp, None if near is None else np.tile(near, (n, 1)))
        steady = mu_ss(V_lp, a=each["a"], b=each["b"], mu0=0.0, V0=self.V0)
        waves = (steady[:, None] + each["a"][:, None] * cycles.x).reshape(n, s, -1)
        period = cycles.period.reshape(n, s)
        features = np.full((n, s, len(FEATURES)), np.nan)
        for j, bins in enumerate(self.bins):
            ok = np.isfinite(waves[:, j]).all(axis=1)
            profiles, extremes = wave_profiles(GRID, waves[ok, j], bins)
            features[ok, j] = profile_features(profiles, period[ok, j], extremes)
        features[~np.isfinite(features).all(axis=2)] = np.nan
        return features, cycles.u.reshape(n, s, 2), waves
