"""Features of cycles: what a record that oscillates is measured by, and a model's cycle likewise.

Phase says nothing of friction, and has many peaks in a likelihood.  So a record is cut into its
cycles, these are folded into one, and of that profile six numbers are taken, with the four parts
of the period told by where tau/sigma crosses 1/4 and 3/4 of the way from its least to its largest:

    amplitude   largest less smallest tau/sigma         period
    rise        from 1/4 to 3/4, the spring loading     high   above 3/4
    drop        from 3/4 to 1/4, slip faster than V_lp  level  mean tau/sigma

The time below 1/4 is what these leave of the period.  Six features at one speed are as many as
the numbers a, b, Dc, K, M and mu0 that a cycle depends on.  Crossings are steep, where extremes
are flat, so that noise moves them little.
"""

from typing import NamedTuple

import numpy as np

from ..errors import ParameterError

FEATURES = ("amplitude", "period", "rise", "high", "drop", "level")
AMPLITUDE, PERIOD, RISE, HIGH, DROP, LEVEL = range(len(FEATURES))
# Of the amplitude, where the four parts of the period meet.
UPPER, LOWER = 0.75, 0.25
# Fewest cycles, and samples in a cycle, of which anything can be said.
FEWEST_CYCLES, FEWEST_SAMPLES = 3, 6
# Parts of a period over which noise is smoothed before cycles are cut.
SMOOTH = 12
# Of the amplitude of the smoothed record, the swing about its middle that counts as a crossing.
SWING = 0.2
# Chance by which a spectrum of noise alone passes for an oscillation.
CHANCE = 1e-4


class Cycles(NamedTuple):
    """A stretch of record, cut and folded into one cycle of m bins."""

    cuts: np.ndarray  # (n + 1,) [s] where tau falls through its middle
    phase: np.ndarray  # (samples,) cycles since the first cut; < 0 or >= n outside of all
    profile: np.ndarray  # (m,) mean tau/sigma in each bin, trend removed
    without: np.ndarray  # (n, m) the same, each time without one of the cycles
    means: np.ndarray  # (n,) tau/sigma of each cycle less that of the profile
    slope: float  # [1/s] trend removed, about the middle of the cycles

    @property
    def n(self):
        return self.cuts.size - 1

    @property
    def middle(self):
        return 0.5 * (self.cuts[0] + self.cuts[-1])

    @property
    def period(self):
        """Slope of the cuts against their number [s]: noise of single cuts matters least."""
        number = np.arange(self.cuts.size) - 0.5 * self.n
        return float(number @ self.cuts / (number @ number))

    def at(self, t):
        """Folded tau/sigma at times t [s] between the first and the last cut, with the trend."""
        phase = np.interp(t, self.cuts, np.arange(self.cuts.size))
        return periodic(self.profile, phase) + self.slope * (t - self.middle)


def periodic(profile, phase):
    """A profile of m bins, at phases in cycles; linear between the middles of bins."""
    m = profile.size
    middles = (np.arange(-1, m + 1) + 0.5) / m
    return np.interp(phase % 1.0, middles, profile[np.arange(-1, m + 1) % m])


def main_period(t, y):
    """Period [s] of the strongest oscillation about the line through a record.

    Raises
    ------
    ParameterError
        No oscillation that stands out of the noise, or fewer cycles or samples than it takes.
    """
    grid, even = _even(t, y)
    power = np.abs(np.fft.rfft(even * np.hanning(even.size))[1:-1]) ** 2
    best = int(np.argmax(power))
    span = grid[-1] - grid[0]
    period = span / (best + 1)
    # white noise: each line of the spectrum is exponential, and a window makes of 2 about 3
    if power[best] < 1.5 * np.log(power.size / CHANCE) * power.mean():
        raise ParameterError(
            f"no oscillation stands out of the noise of friction in the {span:.4g} s of the "
            f"record; fit it against time, or give a record of stick-slip or vibration"
        )
    if best + 1 < FEWEST_CYCLES:
        raise ParameterError(
            f"the record has fewer than {FEWEST_CYCLES} cycles (its slowest oscillation takes "
            f"{period:.4g} s of {span:.4g} s); give a longer one, or fit against time"
        )
    if period < FEWEST_SAMPLES * float(np.median(np.diff(t))):
        raise ParameterError(
            f"a cycle of {period:.4g} s has fewer than {FEWEST_SAMPLES} samples; give a record "
            f"sampled more often"
        )
    return period


def cut_cycles(t, y, period):
    """(n + 1,) times [s] at which tau falls through its middle, once in about a period.

    The record less its mean over a period, smoothed over a twelfth of one, must swing from well
    above to well below: noise in between makes no cut.
    """
    grid, even = _even(t, y)
    step = grid[1] - grid[0]
    smooth = _mean_over(even, period / SMOOTH / step) - _mean_over(even, period / step)
    low, high = np.percentile(smooth, (2.0, 98.0))
    middle, swing = 0.5 * (high + low), SWING * (high - low)
    side = np.where(smooth > middle + swing, 1, np.where(smooth < middle - swing, -1, 0))
    told = np.flatnonzero(side)
    falls = np.flatnonzero((side[told[:-1]] > 0) & (side[told[1:]] < 0))
    cuts = np.empty(falls.size)
    for k, (i, j) in enumerate(zip(told[falls], told[falls + 1], strict=True)):
        first = i + int(np.argmax(smooth[i : j + 1] < middle))
        above, below = smooth[first - 1] - middle, smooth[first] - middle
        cuts[k] = grid[first - 1] + step * above / (above - below)
    return cuts


def fold(t, y, cuts, bins):
    """`Cycles` of a record cut there, with the trend from one cycle to the next removed."""
    n = cuts.size - 1
    phase = np.interp(t, cuts, np.arange(n + 1.0), left=-1.0, right=n + 1.0)
    inside = (phase >= 0.0) & (phase < n)
    cycle, bin_ = phase[inside].astype(int), (phase[inside] % 1.0 * bins).astype(int)
    where = cycle * bins + np.minimum(bin_, bins - 1)
    count = np.bincount(where, minlength=n * bins).reshape(n, bins)
    slope = 0.0
    for _ in range(2):
        level = y[inside] - slope * (t[inside] - 0.5 * (cuts[0] + cuts[-1]))
        total = np.bincount(where, level, n * bins).reshape(n, bins)
        profile = _filled(total.sum(axis=0), count.sum(axis=0))
        left = level - periodic(profile, phase[inside])
        means = np.bincount(cycle, left, n) / np.maximum(np.bincount(cycle, minlength=n), 1)
        if n >= FEWEST_CYCLES:
            slope += float(np.polyfit(0.5 * (cuts[1:] + cuts[:-1]), means, 1)[0])
    without = _filled(total.sum(axis=0) - total, count.sum(axis=0) - count)
    return Cycles(cuts, phase, profile, without, means, slope)


def profile_features(profiles, period):
    """(n, 6) features of profiles (n, m) over one period (n,): logarithms, but for the level.

    A profile begins anywhere, and has one largest and one smallest value.
    """
    n, m = profiles.shape
    top = np.argmax(profiles, axis=1)
    # one turn, from maximum to maximum
    y = np.take_along_axis(profiles, (top[:, None] + np.arange(m + 1)) % m, axis=1)
    bottom = np.argmin(y, axis=1)
    least, row = y.min(axis=1), np.arange(n)
    amplitude = y[:, 0] - least
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
    """(n, m) profiles of waves (n, q) given at phases grid (q,), which begin at their maximum.

    Bins begin where a wave falls through its middle, as a record's do, and hold exact means of
    the wave, which is linear between the phases given.
    """
    n = len(waves)
    row = np.arange(n)
    step = np.diff(grid)
    sums = np.zeros_like(waves)
    np.cumsum(0.5 * step * (waves[:, 1:] + waves[:, :-1]), axis=1, out=sums[:, 1:])
    middle = 0.5 * (waves.max(axis=1) + waves.min(axis=1))
    i = np.maximum(np.argmax(waves < middle[:, None], axis=1), 1)
    part = (waves[row, i - 1] - middle) / (waves[row, i - 1] - waves[row, i])
    start = grid[i - 1] + part * step[i - 1]
    edges = start[:, None] + np.arange(bins + 1) / bins
    turns, within = np.divmod(edges, 1.0)
    j = np.clip(np.searchsorted(grid, within, side="right") - 1, 0, grid.size - 2)
    beyond = within - grid[j]
    left = np.take_along_axis(waves, j, axis=1)
    rate = (np.take_along_axis(waves, j + 1, axis=1) - left) / step[j]
    integral = np.take_along_axis(sums, j, axis=1) + beyond * (left + 0.5 * rate * beyond)
    return np.diff(turns * sums[:, -1:] + integral, axis=1) * bins


def _even(t, y):
    """A record without its line, at even times no closer than its typical ones."""
    line = np.polyfit(t - t[0], y, 1)
    step = float(np.median(np.diff(t)))
    grid = np.linspace(t[0], t[-1], max(int((t[-1] - t[0]) / step), 1) + 1)
    return grid, np.interp(grid, t, y - np.polyval(line, t - t[0]))


def _mean_over(y, width):
    """Mean over a window of so many samples about each; near the ends, that nearest to it."""
    half = min(int(round(width)) // 2, (y.size - 1) // 2)
    if half < 1:
        return y
    sums = np.concatenate([[0.0], np.cumsum(y)])
    wide = 2 * half + 1
    inner = (sums[wide:] - sums[:-wide]) / wide
    return np.pad(inner, half, mode="edge")


def _filled(total, count):
    """Means of bins (..., m); an empty one lies between its neighbours."""
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.asarray(total / count)
    for row, known in zip(np.atleast_2d(mean), np.atleast_2d(count > 0), strict=True):
        if not known.all() and known.any():
            at = np.arange(row.size)
            row[~known] = np.interp(at[~known], at[known], row[known], period=row.size)
    return mean
