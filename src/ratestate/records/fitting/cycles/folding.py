"""Find segments of a record that oscillate, cut them into cycles and average the cycles."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy

from ...messages import fitting as sentences
from ...raw_record import constant_speeds_of, raw_record

# Fewest samples of a segment that is used.
FEWEST = 20
# Largest relative scatter of regular periods.  An amplitude belongs to a transient if it differs
# from the typical one by this many standard deviations and by this fraction.
IRREGULAR, TRANSIENT, DEVIATION = 0.2, 6.0, 0.05
# Fewest cycles, and fewest samples in a cycle.
FEWEST_CYCLES, FEWEST_SAMPLES = 3, 6
# Noise is smoothed over a period divided by this number before cycles are cut.
SMOOTH = 12
# Excursion to both sides of the middle that makes a crossing, divided by the smoothed amplitude.
EXCURSION = 0.2
# Significance level of an oscillation in the spectrum.
CHANCE = 1e-4
# Numbers of samples, in all and in a cycle, beyond which neighbours are averaged.
MANY, PLENTY = 20_000, 256
# Most averaged samples: the bootstrap folds all of them many times.
MOST = 200_000


class Segment(NamedTuple):
    """A part of a record at one load-point speed."""

    t: np.ndarray  # (samples,) [s]
    y: np.ndarray  # (samples,) tau/sigma
    V_lp: float  # [m/s]


class Cycles(NamedTuple):
    """The cycles of a segment, averaged into one cycle of m bins."""

    cuts: np.ndarray  # (n + 1,) times at which tau falls through its middle [s]
    phase: np.ndarray  # (samples,) cycles since the first cut; < 0 or >= n outside
    profile: np.ndarray  # (m,) mean tau/sigma in each bin, trend removed
    leave_one_out: np.ndarray  # (n, m) profiles without one of the cycles
    means: np.ndarray  # (n,) mean tau/sigma of each cycle less that of the profile
    slope: float  # [1/s] trend removed, about the middle of the cycles

    @property
    def n(self):
        return self.cuts.size - 1

    @property
    def inside(self):
        """Whether samples (samples,) are between the first and the last cut."""
        return (self.phase >= 0.0) & (self.phase < self.n)

    @property
    def middle(self):
        """Time midway between the first and the last cut [s]."""
        return 0.5 * (self.cuts[0] + self.cuts[-1])

    @property
    def period(self):
        """Slope of the cuts against their number [s], which averages their noise."""
        number = np.arange(self.cuts.size) - 0.5 * self.n
        return float(number @ self.cuts / (number @ number))


def periodic(profile, phase):
    """Return a profile of m bins at phases in cycles, linear between middles of bins."""
    m = profile.size
    middles = (np.arange(-1, m + 1) + 0.5) / m
    return np.interp(phase % 1.0, middles, profile[np.arange(-1, m + 1) % m])


def sliding_segments(record, slider, loading):
    """Return the `Segment`s (list) of a record with the load point at one speed each."""
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
        raise sentences.refusal("cycles.no_segment", fewest=FEWEST)
    return segments


def main_period(t, y):
    """Return the period [s] of the strongest oscillation about a record's trend."""
    grid, even = _resampled(t, y)
    power = np.abs(np.fft.rfft(even * np.hanning(even.size))[1:-1]) ** 2
    best = int(np.argmax(power))
    span = grid[-1] - grid[0]
    period = span / (best + 1)
    # lines of the spectrum of white noise are exponential; the window correlates them: 1.5
    if power[best] < 1.5 * np.log(power.size / CHANCE) * power.mean():
        raise sentences.refusal("cycles.no_oscillation", span=span)
    if best + 1 < FEWEST_CYCLES:
        raise sentences.refusal("cycles.few", fewest=FEWEST_CYCLES, period=period, span=span)
    if period < FEWEST_SAMPLES * float(np.median(np.diff(t))):
        raise sentences.refusal("cycles.sparse", period=period, fewest=FEWEST_SAMPLES)
    return period


def thinned(segment, period):
    """Return a `Segment`, with neighbouring samples averaged if it has very many."""
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
    """Return times [s] at which tau falls through its middle, about once in a period.

    The smoothed record, less its mean over a period, must pass from well above its middle to well
    below, so that noise makes no cut.  There may be no cut.
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
    """Return n + 1 times [s] that cut a segment into n cycles, and notes (tuple).

    Notes are on cycles left out.  ParameterError if there are too few cycles, or if their periods
    scatter by more than `IRREGULAR`.
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
    """Return the number of first cycles with amplitudes (n,) unlike the later ones."""
    late = amplitude[amplitude.size // 2 :]
    typical = float(np.median(late))
    spread = 1.4826 * max(float(np.median(np.abs(x - np.median(x)))) for x in (late, amplitude))
    is_unlike = np.abs(amplitude - typical) > max(TRANSIENT * spread, DEVIATION * typical)
    return int(np.argmin(is_unlike))


def fold(t, y, cuts, bins):
    """Return the `Cycles` of a record with these cuts, without trend between cycles.

    The trend is 0 for fewer than `FEWEST_CYCLES`.  Empty bins are interpolated.
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
    """Return a record less its line of regression, at times of even spacing."""
    flat = y - _slope(t, y) * (t - t[0])
    step = float(np.median(np.diff(t)))
    grid = np.linspace(t[0], t[-1], max(int((t[-1] - t[0]) / step), 1) + 1)
    return grid, np.interp(grid, t, flat - flat.mean())


def _slope(t, y):
    u = t - t.mean()
    return float(u @ y / (u @ u))


def _moving_average(y, width):
    """Return means over 2 (width//2) + 1 samples; near the ends the last such mean."""
    half = min(round(width) // 2, (y.size - 1) // 2)
    if half < 1:
        return y
    return np.pad(scipy.ndimage.uniform_filter1d(y, 2 * half + 1)[half:-half], half, mode="edge")


def _filled(total, count):
    """Return means of bins (..., m); empty bins are interpolated."""
    mean = np.asarray(total / np.maximum(count, 1))
    at = np.arange(mean.shape[-1])
    for row, filled in zip(np.atleast_2d(mean), np.atleast_2d(count > 0), strict=True):
        if filled.any():
            row[~filled] = np.interp(at[~filled], at[filled], row[filled], period=at.size)
    return mean
