"""Compute limit cycles of many sliders at once, and the features of their waveforms.

The phase holds no information on friction, and would give the likelihood many peaks.  So a
record is cut into cycles, these are averaged into one profile, and six features of the profile
are measured.  The period has four parts, between the times at which tau/sigma crosses 1/4 and
3/4 of its range:

    amplitude   peak-to-peak tau/sigma                  period
    rise        from 1/4 to 3/4, the spring loading     high   above 3/4
    drop        from 3/4 to 1/4, slip faster than V_lp  level  mean tau/sigma

The time below 1/4 is the rest of the period.  Six features at one speed are as many as the
parameters a, b, Dc, K, M and mu0 of a cycle.  The curve is steep at the crossings and flat at
the extremes, so that noise moves the crossings little.
"""

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

FEATURES = ("amplitude", "period", "rise", "high", "drop", "level")
AMPLITUDE, PERIOD, RISE, HIGH, DROP, LEVEL = range(len(FEATURES))
# Number of phases of a model's profile.
FINE = 1024
# Bisections in the search for an extreme, to 1e-6 of the period.
HALVINGS = 11
# Fractions of the range at which the four parts of the period meet.
UPPER, LOWER = 0.75, 0.25
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


def profile_features(profiles, period, extremes=None):
    """Return features (n, 6) of profiles (n, m) over one period (n,).

    extremes : (n, 2) smallest and largest values, if known more precisely

    Features are logarithms, except the level.  A profile may begin anywhere, and must have one
    largest and one smallest value.  A part without length has -inf or NaN.
    """
    n, m = profiles.shape
    top = np.argmax(profiles, axis=1)
    # one period, from maximum to maximum
    y = np.take_along_axis(profiles, (top[:, None] + np.arange(m + 1)) % m, axis=1)
    bottom = np.argmin(y, axis=1)
    row = np.arange(n)
    least, most = (y.min(axis=1), y[:, 0]) if extremes is None else extremes.T
    amplitude = most - least
    after = np.arange(m + 1) > bottom[:, None]

    def crossing(part, down):
        level = (least + part * amplitude)[:, None]
        i = np.argmax(y < level if down else (y >= level) & after, axis=1)
        i = np.maximum(i, 1)
        before, behind = y[row, i - 1], y[row, i]
        with np.errstate(divide="ignore", invalid="ignore"):
            return i - 1.0 + (level[:, 0] - before) / (behind - before)

    falls = crossing(UPPER, down=True), crossing(LOWER, down=True)
    rises = crossing(LOWER, down=False), crossing(UPPER, down=False)
    rise, drop = rises[1] - rises[0], falls[1] - falls[0]
    high = m - rises[1] + falls[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = [np.log(part / m * period) for part in (rise, high, drop)]
        columns = [np.log(amplitude), np.log(period), *parts, profiles.mean(axis=1)]
    return np.stack(columns, axis=1)


def wave_profiles(grid, waves, bins):
    """Return profiles (n, FINE) and extremes (n, 2) of waves (n, q).

    grid : (q,) phases of the waves from 0 to 1, between which they are linear

    Values are means of the wave over the width of a bin.  There are more values than bins, so that
    features change smoothly with parameters.
    """
    step = np.diff(grid)
    sums = np.zeros_like(waves)
    np.cumsum(0.5 * step * (waves[:, 1:] + waves[:, :-1]), axis=1, out=sums[:, 1:])
    half = 0.5 / bins
    middles = np.arange(FINE) / FINE
    ends = np.concatenate([middles - half, middles + half])[None]
    before, after = np.split(_integrals(grid, waves, sums, ends), 2, axis=1)
    profiles = (after - before) * bins
    extremes = np.empty((len(waves), 2))
    for side, index in enumerate((np.argmin(profiles, axis=1), np.argmax(profiles, axis=1))):
        at = _extremum(grid, waves, index / FINE, half, 1.0 if side else -1.0)
        ends = np.stack([at - half, at + half], axis=1)
        extremes[:, side] = np.diff(_integrals(grid, waves, sums, ends))[:, 0] * bins
    return profiles, extremes


def _extremum(grid, waves, near, half, sign):
    """Return phases (n,) at which means are largest (sign 1) or smallest (-1).

    There a wave has equal values at both ends of the window.  Bisection finds them: kinks between
    the phases of the profile would mislead a parabola.
    """
    low, high = near - 1.0 / FINE, near + 1.0 / FINE
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        ends = np.stack([middle - half, middle + half], axis=1) % 1.0
        j, left, rate = _pieces(grid, waves, ends)
        value = left + rate * (ends - grid[j])
        before = sign * (value[:, 1] - value[:, 0]) > 0.0
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return 0.5 * (low + high)


def _pieces(grid, waves, within):
    """Return indices, values, slopes of a wave's linear pieces at phases (n or 1, e)."""
    j = np.clip(np.searchsorted(grid, within, side="right") - 1, 0, grid.size - 2)
    j = np.broadcast_to(j, (len(waves), j.shape[1]))
    left = np.take_along_axis(waves, j, axis=1)
    return j, left, (np.take_along_axis(waves, j + 1, axis=1) - left) / (grid[j + 1] - grid[j])


def _integrals(grid, waves, sums, ends):
    """Return integrals (n, e) of periodic waves from phase 0 to phases (n or 1, e)."""
    periods, within = np.divmod(ends, 1.0)
    j, left, rate = _pieces(grid, waves, within)
    beyond = within - grid[j]
    before = np.take_along_axis(sums, j, axis=1)
    return periods * sums[:, -1:] + before + beyond * (left + 0.5 * rate * beyond)


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


# values far from all sliders overflow, and have no cycle
@np.errstate(over="ignore", divide="ignore", invalid="ignore")
def cycle_features(law, values, V_lp, bins, V0, near=None):
    """Return features (n, s, 6) with mu0 = 0, points (n, s, 2) and waves (n, s, q) of cycles.

    values : symbol -> (n,) of a, b, Dc, sigma, K, M [SI]
    V_lp, bins : (s,) speeds, and numbers of bins of the record's cycles
    near : (s, 2) points from which to start

    `profile_features` gives the features; they are NaN without a cycle.
    """
    n, s = values["a"].size, V_lp.size
    values, V_lp = {name: np.repeat(x, s) for name, x in values.items()}, np.tile(V_lp, n)
    cycles = limit_waves(law, values, V_lp, None if near is None else np.tile(near, (n, 1)))
    steady = mu_ss(V_lp, a=values["a"], b=values["b"], mu0=0.0, V0=V0)
    waves = (steady[:, None] + values["a"][:, None] * cycles.x).reshape(n, s, -1)
    period = cycles.period.reshape(n, s)
    features = np.full((n, s, len(FEATURES)), np.nan)
    for j, count in enumerate(bins):
        ok = np.isfinite(waves[:, j]).all(axis=1)
        profiles, extremes = wave_profiles(GRID, waves[ok, j], count)
        features[ok, j] = profile_features(profiles, period[ok, j], extremes)
    features[~np.isfinite(features).all(axis=2)] = np.nan
    return features, cycles.u.reshape(n, s, 2), waves
