"""Detection of stick-slip events: falls of the shear stress that noise does not explain.

An event is the part of a series between a maximum and the next minimum, if the series departs from
each by more than a threshold.  The threshold is the largest range that noise reaches in a series of
this length, so that noise alone has no event.

Noise that wanders falls as slowly as it rises, and at irregular times.  Stick-slip falls faster
than the load point loads the spring, or it is regular.

A fall is a row (peak, trough) of an array of samples (m, 2).  A peak or trough that lies outside
the record is -1.
"""

import math

import numpy as np
import scipy

from ..kit.sample_noise import SampleNoise, noise_of_residuals, sample_noise
from ..load_point.splits import gaps_in

#: smallest event of a run, as a multiple of the solver's error per step
LEAST = 10.0
#: most samples of an outlier; number of samples on either side with which it is compared
LONGEST_OUTLIER, SIDE = 2, 2
#: least distance of an outlier from these samples, in standard deviations of the noise
MIN_OUTLIER = 5.0
#: part of a loading phase whose residuals give the noise; degree of the polynomial fitted there
QUIET_PART, SMOOTH = (0.2, 0.6), 3
#: fewest samples of one such part, and number of samples that is enough in all
FEWEST_CALM, ENOUGH = 12, 20000
#: noise of the loading, as a multiple of the white noise, from which events are detected again
LARGER = 1.2
#: range of the record divided by the noise, from which samples are not smoothed
CLEAR = 40.0
#: longest moving average, as a fraction of the record's samples
LONGEST = 0.01
#: standard deviations of the noise added to its expected range
MARGIN = 3.0
#: slope of stress against displacement, as a multiple of the median, that is too steep for loading
STEEP = 3.0
#: number of steps on either side with which a gap is compared, and least ratio of the gap to them
#: and to the median step of the series
GAP_NEIGHBOURS, GAP_RATIO = 20, 10.0
#: significance level of the test that falls are shorter than rises
CHANCE = 0.02
#: fewest falls for this test.  If there are fewer, each fall must last less than this fraction of
#: the rise before it.  Its duration is twice that of its middle half, because its ends are round.
FEWEST, SHORTER = 4, 0.1
#: largest standard deviation of regular intervals between falls, divided by their mean: for fewer
#: than `MANY_FALLS` falls, and for more
REGULAR, MANY_FALLS = (0.1, 0.25), 8


def detected(series):
    """Return a series without outliers, its falls, their `SampleNoise`, and the threshold [Pa]."""
    if series.V is not None:
        falls, threshold = rough_falls(series.tau, SampleNoise(LEAST * series.resolution))
        return series, falls, SampleNoise(0.0), threshold
    white = max(sample_noise(series.tau), series.resolution)
    series = series._replace(tau=without_outliers(series.tau, white))
    noise = SampleNoise(white)
    falls, threshold = _falls_beyond(series, noise)
    for _ in range(2):
        noise = loading_noise(series.t, series.tau, loading_phases(series, falls), white)
        if noise.sd < LARGER * white:
            break
        falls, threshold = _falls_beyond(series, noise)
    return series, falls if is_stick_slip(series, falls) else falls[:0], noise, threshold


def _falls_beyond(series, noise):
    falls, threshold = rough_falls(series.tau, noise)
    return without_rebounds(series.tau, series.delta_lp, falls), threshold


def is_whole(falls):
    """Return whether the record has both the peak and the trough of each fall (m,)."""
    return (falls >= 0).all(axis=1)


def loading_phases(series, falls):
    """Return the loading phases between falls at one V_lp: [(first, last sample)]."""
    pairs = [(i, j) for i, j in zip(falls[:-1, 1], falls[1:, 0], strict=True) if min(i, j) >= 0]
    return [(i, j) for i, j in pairs if not series.speed_varies(series.t[i], series.t[j])]


def without_outliers(y, noise):
    """Replace each outlier of a series (n,) by a line; noise is the standard deviation.

    The samples on both sides of an outlier differ less from each other than from the outlier.
    After a stress drop, or during steep loading, they differ more.
    """
    y = y.copy()
    for length in range(1, LONGEST_OUTLIER + 1):
        padded = np.pad(y, SIDE, mode="edge")
        parts = np.lib.stride_tricks.sliding_window_view(padded, length + 2 * SIDE)
        sides, inside = np.delete(parts, np.s_[SIDE:-SIDE], axis=1), parts[:, SIDE:-SIDE]
        low, high = sides.min(axis=1), sides.max(axis=1)
        excess = np.maximum(inside.min(axis=1) - high, low - inside.max(axis=1))
        for i in np.flatnonzero((excess > MIN_OUTLIER * noise) & (excess > high - low)):
            y[i : i + length] = np.linspace(padded[i + 1], padded[i + 2 + length], length + 2)[1:-1]
    return y


def loading_noise(t, y, phases, white):
    """Return the `SampleNoise` in loading phases [(first, last sample)]; `white` if too short."""
    residuals: list[np.ndarray] = []
    for first, last in phases:
        rows = slice(*(round(first + part * (last - first)) for part in QUIET_PART))
        if rows.stop - rows.start >= FEWEST_CALM and sum(map(len, residuals)) <= ENOUGH:
            curve = np.polynomial.Polynomial.fit(t[rows], y[rows], SMOOTH)
            residuals.append(y[rows] - curve(t[rows]))
    if not any(map(np.any, residuals)):
        return SampleNoise(white)
    return noise_of_residuals(residuals, SMOOTH + 1)


def rough_falls(y, noise):
    """Return the falls (m, 2) of a series that exceed a threshold, also cut ones; the threshold."""
    spread = float(np.subtract(*np.percentile(y, (99.0, 1.0))))
    width = 1
    if noise.sd > 0.0 and spread > 0.0:
        width = min(math.ceil((CLEAR * noise.sd / spread) ** 2), max(int(LONGEST * y.size), 1))
    smooth = scipy.ndimage.uniform_filter1d(y, width, mode="nearest") if width > 1 else y
    expected = 2.0 * math.sqrt(2.0 * math.log(max(y.size / width, 2.0)))
    threshold = (expected + MARGIN) * noise.sd * math.sqrt(min(noise.inflation / width, 1.0))
    turns = turning_points(smooth, threshold)
    samples = [i for i, _ in turns]
    if turns and turns[0][1] < 0:
        samples.insert(0, -1)
    if len(samples) % 2:
        samples.append(-1)
    return np.array(samples, int).reshape(-1, 2), threshold


def turning_points(y, threshold):
    """Return the turning points [(sample, +1 for a maximum, -1 for a minimum)] of a series.

    Maxima and minima alternate, and each differs from the next by more than the threshold.
    """
    extremes = []
    for sign in (1, -1):
        _, shape = scipy.signal.find_peaks(sign * y, prominence=threshold, plateau_size=1)
        first = shape["left_edges"][shape["prominences"] > threshold]
        extremes += [(i, sign) for i in first.tolist()]
    turns: list[tuple[int, int]] = []
    for i, sign in sorted(extremes):
        if not turns or turns[-1][1] != sign:  # (keep the first of equal extremes)
            turns.append((i, sign))
    return turns


def without_rebounds(y, displacement, falls):
    """Merge falls (m, 2) between which the stress only swings back.

    A rise is a rebound if it is steeper than the spring can load the block elsewhere in the record.

    displacement : (n,) of the load point [m]
    """
    rises, distances = (x[falls[1:, 0]] - x[falls[:-1, 1]] for x in (y, displacement))
    if rises.size < 2 or not (distances > 0.0).all():
        return falls
    stiffness, order = rises / distances, np.argsort(rises / distances)
    middle = np.searchsorted(np.cumsum(rises[order]), 0.5 * rises.sum())
    is_steep = stiffness > STEEP * stiffness[order][middle]
    kept = [falls[0]]
    for fall, too_steep in zip(falls[1:], is_steep, strict=True):
        last = kept[-1]
        if too_steep and min(*last, fall[1]) >= 0 and y[fall[0]] < y[last[0]]:
            lower = last[1] if y[last[1]] <= y[fall[1]] else fall[1]
            kept[-1] = np.array([last[0], lower])
        else:
            kept.append(fall)
    return np.array(kept)


def in_gaps(t, falls):
    """Return whether samples are missing in falls (m,), from before peak to after trough."""
    steps = np.diff(t)
    gaps = np.array(gaps_in(t, GAP_RATIO, GAP_NEIGHBOURS), int) - 1  # the steps
    gaps = gaps[steps[gaps] > GAP_RATIO * np.median(steps)]
    inside = [bool(((gaps >= peak - 1) & (gaps <= trough)).any()) for peak, trough in falls]
    return is_whole(falls) & np.array(inside, bool)


def is_stick_slip(series, falls):
    """Return whether falls are so short or so regular that they are not noise."""
    entire = falls[is_whole(falls)]
    peaks, troughs = series.t[entire].T
    starts = np.concatenate([series.t[:1], troughs[:-1]])[: peaks.size]
    # a rise begins after the last change of V_lp, to which stress responds by itself
    changes = np.append(-math.inf, series.t[1:][np.diff(series.V_lp) != 0.0])
    changed = changes[np.searchsorted(changes, peaks, side="right") - 1]
    durations, rises = troughs - peaks, peaks - np.maximum(starts, changed)
    if (
        len(entire) >= FEWEST
        and scipy.stats.mannwhitneyu(durations, rises, alternative="less").pvalue < CHANCE
    ):
        return True
    intervals = np.diff(0.5 * (peaks + troughs))
    regular = REGULAR[len(entire) >= MANY_FALLS]
    if intervals.size > 1 and intervals.std() < regular * intervals.mean():
        return True
    halves = np.array([_middle_half_duration(series, *fall) for fall in entire])
    return 0 < len(entire) < FEWEST and bool((2.0 * halves < SHORTER * rises).all())


def _middle_half_duration(series, peak, trough):
    """Return how long the middle half of the drop takes [s]: at least one step."""
    t, y = (x[peak : trough + 1] for x in (series.t, series.tau))
    below, quarter = 0.5 * (y[0] + y[-1]) - y, 0.25 * (y[0] - y[-1])
    middle = int(np.argmax(below > 0.0))
    spacing = np.gradient(t)
    return max(float(spacing[np.abs(below) < quarter].sum()), float(t[middle] - t[middle - 1]))
