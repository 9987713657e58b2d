"""The segments of a record that oscillate, cut into their cycles and folded into one."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from ...loading import constant_speeds_of
from ...messages import fitting as sentences
from ...raw_record import raw_record

# Fewest samples of a segment that is used.
FEWEST = 20
# Scatter of the periods beyond which cycles do not repeat.  An amplitude counts as a transient's if
# it is off by so many standard deviations and by this part of the typical one.
IRREGULAR, TRANSIENT, DEVIATION = 0.2, 6.0, 0.05
# Fewest cycles, and samples in a cycle, that can be used.
FEWEST_CYCLES, FEWEST_SAMPLES = 3, 6
# Parts of a period over which noise is smoothed before cycles are cut.
SMOOTH = 12
# Excursion to both sides of the middle, over the smoothed amplitude, that makes a crossing.
EXCURSION = 0.2
# Probability that the spectrum of mere noise passes for an oscillation.
CHANCE = 1e-4
# Samples, in all and in a cycle, beyond which neighbours are averaged.
MANY, PLENTY = 20_000, 256
# Most samples, so averaged: the bootstrap folds all of them many times.
MOST = 200_000


class Segment(NamedTuple):
    """A part of a record at one load-point speed."""

    t: np.ndarray  # (samples,) [s]
    y: np.ndarray  # (samples,) tau/sigma
    V_lp: float  # [m/s]


class Cycles(NamedTuple):
    """A segment of record, cut and folded into one cycle of m bins."""

    cuts: np.ndarray  # (n + 1,) [s] where tau falls through its middle
    phase: np.ndarray  # (samples,) cycles since the first cut; < 0 or >= n outside of all
    profile: np.ndarray  # (m,) mean tau/sigma in each bin, trend removed
    leave_one_out: np.ndarray  # (n, m) such profiles, each without one of the cycles
    means: np.ndarray  # (n,) tau/sigma of each cycle less that of the profile
    slope: float  # [1/s] trend removed, about the middle of the cycles

    @property
    def n(self):
        """Number of cycles."""
        return self.cuts.size - 1

    @property
    def inside(self):
        """(samples,) whether a sample is between the first and the last cut."""
        return (self.phase >= 0.0) & (self.phase < self.n)

    @property
    def middle(self):
        """Time midway between the first and the last cut [s]."""
        return 0.5 * (self.cuts[0] + self.cuts[-1])

    @property
    def period(self):
        """Slope of the cuts against their number [s]: least sensitive to noise of single cuts."""
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


def segments_of(record, slider, loading):
    """list of `Segment`s of a record, in each of which the load point moves at one speed.

    ParameterError as of `raw_record` and `constant_speeds_of`, for a record of mu, and if
    no segment has `FEWEST` samples.
    """
    raw = raw_record(record, slider)
    if raw.kind != "tau":
        raise sentences.refusal("cycles.of_mu")
    loading, t = constant_speeds_of(raw, loading), raw.t
    segments = []
    for start, end, V_lp in zip(loading.t, [*loading.t[1:], np.inf], loading.V, strict=True):
        rows = (t >= start) & (t < end)
        if V_lp > 0.0 and rows.sum() >= FEWEST:
            segments.append(Segment(raw.time[rows], raw.friction[rows], float(V_lp)))
    if not segments:
        raise sentences.refusal("cycles.no_stretch", fewest=FEWEST)
    return segments


def main_period(t, y):
    """Period [s] of the strongest oscillation about a record's trend.

    ParameterError for mere noise, and for too few cycles, or samples in one.
    """
    grid, even = _resampled(t, y)
    power = np.abs(np.fft.rfft(even * np.hanning(even.size))[1:-1]) ** 2
    best = int(np.argmax(power))
    span = grid[-1] - grid[0]
    period = span / (best + 1)
    # white noise: each line of the spectrum is exponential, and a window makes of 2 about 3
    if power[best] < 1.5 * np.log(power.size / CHANCE) * power.mean():
        raise sentences.refusal("cycles.no_oscillation", span=span)
    if best + 1 < FEWEST_CYCLES:
        raise sentences.refusal("cycles.few", fewest=FEWEST_CYCLES, period=period, span=span)
    if period < FEWEST_SAMPLES * float(np.median(np.diff(t))):
        raise sentences.refusal("cycles.sparse", period=period, fewest=FEWEST_SAMPLES)
    return period


def thinned(segment, period):
    """A `Segment` with neighbouring samples averaged, if it has more than are needed.

    ParameterError if it still has more than `MOST`.
    """
    n = segment.t.size
    dense = period / float(np.median(np.diff(segment.t)))
    every = int(min(n / MANY, dense / PLENTY))
    if every > 1:
        rows = n // every * every
        t, y = (column[:rows].reshape(-1, every).mean(axis=1) for column in segment[:2])
        segment = segment._replace(t=t, y=y)
    if segment.t.size > MOST:
        cycles = (segment.t[-1] - segment.t[0]) / period
        raise sentences.refusal("cycles.many", samples=segment.t.size, most=MOST, cycles=cycles)
    return segment


def cut_cycles(t, y, period):
    """(n + 1,) times [s] at which tau falls through its middle, once in about a period.

    The record less its mean over a period, smoothed over a twelfth of one, must pass from well
    above to well below: noise in between makes no cut.  There may be no cut at all.
    """
    grid, even = _resampled(t, y)
    step = grid[1] - grid[0]
    smooth = _moving_average(even, period / SMOOTH / step) - _moving_average(even, period / step)
    low, high = np.percentile(smooth, (2.0, 98.0))
    middle, excursion = 0.5 * (high + low), EXCURSION * (high - low)
    side = np.where(smooth > middle + excursion, 1, np.where(smooth < middle - excursion, -1, 0))
    sided = np.flatnonzero(side)
    falls = np.flatnonzero((side[sided[:-1]] > 0) & (side[sided[1:]] < 0))
    cuts = np.empty(falls.size)
    for k, (i, j) in enumerate(zip(sided[falls], sided[falls + 1], strict=True)):
        first = i + int(np.argmax(smooth[i : j + 1] < middle))
        above, below = smooth[first - 1] - middle, smooth[first] - middle
        cuts[k] = grid[first - 1] + step * above / (above - below)
    return cuts


def regular_cuts(segment, period):
    """(n + 1,) times [s] to cut a segment into n cycles, and notes (tuple) on cycles left out.

    ParameterError if there are too few, or their periods scatter by more than `IRREGULAR`.
    """
    t, y, V_lp = segment
    cuts = cut_cycles(t, y, period)
    if cuts.size <= FEWEST_CYCLES:
        raise sentences.refusal("cycles.few_whole", V_lp=V_lp, fewest=FEWEST_CYCLES)
    amplitude = np.array(
        [np.ptp(np.percentile(y[(t >= i) & (t < j)], (1, 99))) for i, j in pairwise(cuts)]
    )
    left_out: tuple = ()
    first = _transient(amplitude)
    if first and cuts.size - first > FEWEST_CYCLES:
        which = "first cycle" if first == 1 else f"first {first} cycles"
        left_out = (sentences("cycles.transient", cycles=which, V_lp=V_lp),)
        cuts = cuts[first:]
    periods = np.diff(cuts)
    if (scatter := float(periods.std() / periods.mean())) > IRREGULAR:
        raise sentences.refusal(
            "cycles.irregular", V_lp=V_lp, scatter=100 * scatter, most=100 * IRREGULAR
        )
    return cuts, left_out


def _transient(amplitude):
    """Number of first cycles whose amplitude (n,) is unlike that of the later ones."""
    late = amplitude[amplitude.size // 2 :]
    typical = float(np.median(late))
    spread = 1.4826 * max(float(np.median(np.abs(x - np.median(x)))) for x in (late, amplitude))
    is_unlike = np.abs(amplitude - typical) > max(TRANSIENT * spread, DEVIATION * typical)
    return int(np.argmin(is_unlike))


def fold(t, y, cuts, bins):
    """`Cycles` of a record with these cuts, the trend from cycle to cycle removed.

    Of fewer than `FEWEST_CYCLES` none is.  Empty bins are interpolated.
    """
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
        residual = level - periodic(profile, phase[inside])
        means = np.bincount(cycle, residual, n) / np.maximum(np.bincount(cycle, minlength=n), 1)
        if n >= FEWEST_CYCLES:
            slope += _slope(0.5 * (cuts[1:] + cuts[:-1]), means)
    leave_one_out = _filled(total.sum(axis=0) - total, count.sum(axis=0) - count)
    return Cycles(cuts, phase, profile, leave_one_out, means, slope)


def _resampled(t, y):
    """A record less its line of regression, interpolated to even times of its usual spacing."""
    flat = y - _slope(t, y) * (t - t[0])
    step = float(np.median(np.diff(t)))
    grid = np.linspace(t[0], t[-1], max(int((t[-1] - t[0]) / step), 1) + 1)
    return grid, np.interp(grid, t, flat - flat.mean())


def _slope(t, y):
    """Slope of the line of regression of a record."""
    u = t - t.mean()
    return float(u @ y / (u @ u))


def _moving_average(y, width):
    """Means over a window of this width [samples] about each sample; edge values near the ends."""
    half = min(round(width) // 2, (y.size - 1) // 2)
    if half < 1:
        return y
    return np.pad(uniform_filter1d(y, 2 * half + 1)[half:-half], half, mode="edge")


def _filled(total, count):
    """Means of bins (..., m); those of empty bins are interpolated."""
    mean = np.asarray(total / np.maximum(count, 1))
    at = np.arange(mean.shape[-1])
    for row, filled in zip(np.atleast_2d(mean), np.atleast_2d(count > 0), strict=True):
        if filled.any():
            row[~filled] = np.interp(at[~filled], at[filled], row[filled], period=at.size)
    return mean
