"""Falls of the shear stress that are stick-slip events: beyond noise, and not noise that wanders.

What is between a maximum of a series and the next minimum is an event, if the series moves away
from each turning point by more than a threshold.  The threshold is the largest range that noise
alone reaches in a series of this length, so that noise makes no event.

Noise has no direction of time: it falls as slowly as it rises, and at any time.  Stick-slip falls
faster than the load point loads the spring, or it is regular.

A fall is a row (peak, trough) of an array of samples (m, 2); -1 stands for a peak or trough that
the record does not have.
"""

import math

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import find_peaks
from scipy.stats import mannwhitneyu

from ..kit.sample_noise import SampleNoise, noise_of_residuals, sample_noise

#: smallest event of a run, as a multiple of the solver's error per step
LEAST = 10.0
#: most samples of an outlier; samples on either side of it that it stands out of
LONGEST_OUTLIER, SIDE = 2, 2
#: standard deviations of the noise by which it stands out of them
OUT = 5.0
#: part of the rise of stress, in time, whose residuals are the noise; degree of the curve there
CALM, SMOOTH = (0.2, 0.6), 3
#: fewest samples there, and most of them from which the noise is found, in all
FEWEST_CALM, ENOUGH = 12, 20000
#: noise of the loading, as a multiple of the white one, from which events are detected anew
LARGER = 1.2
#: range of the record over the noise from which samples are used as they are; else means of some
CLEAR = 40.0
#: most samples in such a mean, over those of the record
LONGEST = 0.01
#: standard deviations beyond the expected range of the noise
MARGIN = 3.0
#: rise of stress for the load point's way, over the usual one, that is steeper than any spring's
STEEP = 3.0
#: steps between samples on either side of a gap, and how many times as long it is
BESIDE, LONG = 20, 10.0
#: probability of falls as short as these beside the rises, if they are noise, that is too small
CHANCE = 0.02
#: fewest falls for such a test; of fewer each must be this much shorter than the rise before it,
#: as steep as its middle half is: its ends are round, or lost in the noise
FEWEST, SHORTER = 4, 0.1
#: standard deviation of the times between falls, over their mean, of what is regular: of a few
#: falls, and from `MANY` on
REGULAR, MANY = (0.1, 0.25), 8


def detected(series):
    """Return a series without its outliers, its falls, its noise, and the threshold [Pa].

    There are no falls if stress merely wanders.  The `SampleNoise` is that of the loading, if it is
    larger than white noise.
    """
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
    """(m,) whether the record has both the peak and the trough of falls."""
    return (falls >= 0).all(axis=1)


def loading_phases(series, falls):
    """Loading phases between falls, at one V_lp: [(first, last sample)]."""
    pairs = [(i, j) for i, j in zip(falls[:-1, 1], falls[1:, 0], strict=True) if min(i, j) >= 0]
    return [(i, j) for i, j in pairs if not series.speed_varies(series.t[i], series.t[j])]


def without_outliers(y, noise):
    """A series (n,) with a line in place of each outlier beyond noise of this standard deviation.

    An outlier stands out of the samples on both its sides, by more than these differ: after a drop
    stress is not back where it was, and a steep loading moves on.
    """
    y = y.copy()
    for length in range(1, LONGEST_OUTLIER + 1):
        padded = np.pad(y, SIDE, mode="edge")
        parts = np.lib.stride_tricks.sliding_window_view(padded, length + 2 * SIDE)
        sides, inside = np.delete(parts, np.s_[SIDE:-SIDE], axis=1), parts[:, SIDE:-SIDE]
        low, high = sides.min(axis=1), sides.max(axis=1)
        out = np.maximum(inside.min(axis=1) - high, low - inside.max(axis=1))
        for i in np.flatnonzero((out > OUT * noise) & (out > high - low)):
            y[i : i + length] = np.linspace(padded[i + 1], padded[i + 2 + length], length + 2)[1:-1]
    return y


def loading_noise(t, y, phases, white):
    """`SampleNoise` about curves through phases [(first, last sample)], or the white one."""
    residuals: list[np.ndarray] = []
    for first, last in phases:
        rows = slice(*(round(first + part * (last - first)) for part in CALM))
        if rows.stop - rows.start >= FEWEST_CALM and sum(map(len, residuals)) <= ENOUGH:
            curve = np.polynomial.Polynomial.fit(t[rows], y[rows], SMOOTH)
            residuals.append(y[rows] - curve(t[rows]))
    if not any(map(np.any, residuals)):
        return SampleNoise(white)
    return noise_of_residuals(residuals, SMOOTH + 1)


def rough_falls(y, noise):
    """Falls (m, 2) of a series (n,) with this `SampleNoise`, and the threshold.

    One that the record's start or end cuts is among them.  Falls that are smaller than the
    threshold are not found.
    """
    spread = float(np.subtract(*np.percentile(y, (99.0, 1.0))))
    width = 1
    if noise.sd > 0.0 and spread > 0.0:
        width = min(math.ceil((CLEAR * noise.sd / spread) ** 2), max(int(LONGEST * y.size), 1))
    smooth = uniform_filter1d(y, width, mode="nearest") if width > 1 else y
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
    """Turning points [(sample, +1 for a maximum or -1)] of a series.

    In turn maxima and minima, each more than the threshold from the next; the ends of the series
    are none.
    """
    found = []
    for sign in (1, -1):
        _, shape = find_peaks(sign * y, prominence=threshold, plateau_size=1)
        first = shape["left_edges"][shape["prominences"] > threshold]
        found += [(i, sign) for i in first.tolist()]
    turns: list[tuple[int, int]] = []
    for i, sign in sorted(found):
        if not turns or turns[-1][1] != sign:  # (of extremes as high as each other the first)
            turns.append((i, sign))
    return turns


def without_rebounds(y, moved, falls):
    """Falls (m, 2) in which stress that swings back after a fall belongs to the same fall.

    Load point and spring load the block no faster than they do elsewhere.

    moved : (n,) displacement of the load point [m]
    """
    rises, way = (x[falls[1:, 0]] - x[falls[:-1, 1]] for x in (y, moved))
    if rises.size < 2 or not (way > 0.0).all():
        return falls
    stiffness, order = rises / way, np.argsort(rises / way)
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
    """(m,) whether samples are missing from before the peaks to after the troughs of falls.

    A step between samples is a gap if it is `LONG` times those on either side of it.
    """
    steps = np.diff(t)
    long = np.flatnonzero(steps > LONG * np.median(steps))

    def is_gap(i):
        sides = steps[max(i - BESIDE, 0) : i], steps[i + 1 : i + 1 + BESIDE]
        return all(side.size and steps[i] > LONG * np.median(side) for side in sides)

    inside = [long[(long >= peak - 1) & (long <= trough)] for peak, trough in falls]
    return is_whole(falls) & np.array([any(map(is_gap, some)) for some in inside], bool)


def is_stick_slip(series, falls):
    """Whether falls of a record are not noise, by how short or regular they are."""
    whole = falls[is_whole(falls)]
    peaks, troughs = series.t[whole].T
    starts = np.concatenate([series.t[:1], troughs[:-1]])[: peaks.size]
    # after a change of V_lp stress moves by itself
    changes = np.append(-math.inf, series.t[1:][np.diff(series.V_lp) != 0.0])
    changed = changes[np.searchsorted(changes, peaks, side="right") - 1]
    lasting, rises = troughs - peaks, peaks - np.maximum(starts, changed)
    if len(whole) >= FEWEST and mannwhitneyu(lasting, rises, alternative="less").pvalue < CHANCE:
        return True
    intervals = np.diff(0.5 * (peaks + troughs))
    regular = REGULAR[len(whole) >= MANY]
    if intervals.size > 1 and intervals.std() < regular * intervals.mean():
        return True
    halves = np.array([_half(series, *fall) for fall in whole])
    return 0 < len(whole) < FEWEST and bool((2.0 * halves < SHORTER * rises).all())


def _half(series, peak, trough):
    """How long the middle half of the drop of a fall takes [s]; a step at least."""
    t, y = (x[peak : trough + 1] for x in (series.t, series.tau))
    below, quarter = 0.5 * (y[0] + y[-1]) - y, 0.25 * (y[0] - y[-1])
    middle = int(np.argmax(below > 0.0))
    each = np.gradient(t)  # time that a sample stands for
    return max(float(each[np.abs(below) < quarter].sum()), float(t[middle] - t[middle - 1]))
