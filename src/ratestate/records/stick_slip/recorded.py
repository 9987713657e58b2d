"""Peaks, troughs, times and slip rates of events in a noisy record.

Everything is counted from the middle of an event's fall, where stress is steep and time well known.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from .crossings import NEAR, middles
from .polynomials import Window, extremes
from .spikes import with_spikes
from .windows import biased_errors, chosen_window

#: extents of windows on the side of the loading, over the time of loading; shortest [samples]
LOADING = np.geomspace(0.02, 0.85, 9)
SHORTEST = 6.0
#: ends of windows on the side of the fall, over the time from its middle to the extreme; and in
#: samples from the middle
FALL, CLOSE = (0.1, 0.25, 0.4, 0.6, 0.8, 0.9, 0.95, 1.0), (0.5, 1.0, 1.5, 2.0, 3.0)
#: least ends of windows on the side of the fall, in samples, or over the time of loading if that is
#: less: noise can hide a sample that is still in the fall
LEAST, OF_LOADING = 1.0, 0.05
#: half extents of windows for the slip rate, over the time of the fall
STEEP = np.geomspace(0.05, 0.8, 8)
#: samples in the middle half of a fall below which its mean slope there is taken, a lower bound
SPARSE = 8
#: fewest samples of a fall through which a line is drawn
LINE = 3
#: standard errors of a mean of samples by which the middle of a fall is within a quarter drop
CLEAR = 4.0
#: times that windows are placed about what the last ones gave
ROUNDS = 2


class Found(NamedTuple):
    """What a record says of m events; NaN where it says nothing."""

    peak: np.ndarray  # (m, 4) tau at the peak [Pa], its error, the time [s], its error
    trough: np.ndarray  # (m, 4) the same at the trough
    middle: np.ndarray  # (m, 2) time of the middle of the fall, its error [s]
    slope: np.ndarray  # (m, 2) steepest fall of tau [Pa/s], its error
    samples: np.ndarray  # (m,) in the fall, between peak and trough
    sparse: np.ndarray  # (m,) whether they are too few for the slip rate


def nothing(m):
    """`Found` with nothing found of m events."""
    four, two = np.full((m, 4), math.nan), np.full((m, 2), math.nan)
    return Found(four, four.copy(), two, two.copy(), np.zeros(m, int), np.zeros(m, bool))


def found_events(t, y, rough, spans, noise):
    """`Found` for the whole `Rough` events (m) of one load-point velocity.

    spans : (2, m) samples at which the loading before them begins, and that after them ends
    """
    before, after = spans
    peaks = np.array([one.peak for one in rough])
    troughs = np.array([one.trough for one in rough])
    spacing = float(np.median(np.diff(t)))
    means, width = _means(y, peaks, troughs, noise)
    rough_levels = np.stack([means[peaks], means[troughs]])
    middle = middles(t, means, peaks, troughs, rough_levels, np.zeros(peaks.size), noise)
    results = []
    for sign, at, loading in (
        (1, t[peaks], float(np.median(t[peaks] - t[before]))),
        (-1, t[troughs], float(np.median(t[after] - t[troughs]))),
    ):
        found = _stress_extremes(t, y, middle[:, 0], at, sign, loading, spacing, noise)
        results.append(with_spikes(t, y, middle[:, 0], found, sign, noise))
    if width > 1:  # (a sample far from the fall may pass its middle by noise)
        peaks = np.maximum(peaks, np.searchsorted(t, results[0][:, 2]) - width)
        troughs = np.minimum(troughs, np.searchsorted(t, results[1][:, 2]) + width)
    levels = np.stack([results[0][:, 0], results[1][:, 0]])
    level_error = 0.5 * np.hypot(results[0][:, 1], results[1][:, 1])
    middle = middles(t, y, peaks, troughs, levels, level_error, noise)
    inside = np.searchsorted(t, results[1][:, 2]) - np.searchsorted(t, results[0][:, 2])
    samples = np.maximum(inside, 0)
    slope, few = _slopes(t, y, middle[:, 0], peaks, troughs, noise)
    return Found(results[0], results[1], middle, slope, samples, few)


def _means(y, peaks, troughs, noise):
    """Running means of a series (n,) in which noise does not hide the middles of falls; width."""
    drop = float(np.median(y[peaks] - y[troughs]))
    width = math.ceil((CLEAR * noise.sd / (NEAR * drop)) ** 2 * noise.inflation)
    width = min(width, max(int(np.min(troughs - peaks)) // 2, 1))
    return (uniform_filter1d(y, width) if width > 1 else y), width


def _stress_extremes(t, y, middle, at, sign, loading, spacing, noise):
    """(m, 4) value, error, time, time error of peaks (sign 1) or troughs (-1).

    at : (m,) rough times of these
    """
    for _ in range(ROUNDS):
        offset = float(np.median(at - middle))
        windows = list(_windows(offset, loading, spacing, sign))
        window = chosen_window(t, y, middle, windows, 0, sign, noise)
        if window is None:
            return np.full((middle.size, 4), math.nan)
        found = extremes(t, y, middle, window, 0, sign, noise)
        at = np.where(np.isfinite(found.time), found.time, middle + offset)
    # (a peak is always before the middle of its fall; noise may place it after)
    time = sign * np.minimum(sign * found.time, sign * middle)
    return np.column_stack([found.value, biased_errors(found), time, found.time_error])


def _windows(offset, loading, spacing, sign):
    """`Window`s that have an extreme this long after the middle of the fall (peaks: < 0)."""
    reach, shortest = abs(offset), SHORTEST * spacing
    least = min(LEAST * spacing, OF_LOADING * loading)
    nears = [part * reach for part in FALL]
    nears += [j * spacing for j in CLOSE if j * spacing <= reach + spacing]
    nears = sorted({max(near, least) for near in nears})
    for extent, near in itertools.product(LOADING * loading, nears):
        far = max(reach + extent, near + shortest)
        if far < reach + loading:  # (beyond is the next fall)
            yield Window(-far, -near, 1) if sign > 0 else Window(near, far, -1)


def _slopes(t, y, middle, peaks, troughs, noise):
    """(m, 2) steepest fall [Pa/s] and its error; (m,) whether samples are too few for it."""
    spacing = np.median(np.diff(t))
    fall = max(float(np.median(t[troughs] - t[peaks])), spacing)
    rows = np.array([_fall(t, y, i, j) for i, j in zip(peaks, troughs, strict=True)])
    time, width = float(np.median(rows[:, 0] - middle)), float(np.median(rows[:, 2]))
    few = rows[:, 2] < SPARSE * spacing
    window = None
    for _ in range(ROUNDS if not few.all() else 0):
        extents = np.unique(np.clip(STEEP * width * 4.0, 3.5 * spacing, fall))
        windows = [Window(time - a, time + b, 0) for a, b in itertools.product(extents, extents)]
        window = chosen_window(t, y, middle, windows, 1, -1, noise)
        if window is None:
            break
        found = extremes(t, y, middle, window, 1, -1, noise)
        time = float(np.nanmedian(found.time - middle))
    if window is None:
        return np.column_stack([rows[:, 1], rows[:, 3]]), np.ones(middle.size, bool)
    values = np.column_stack([-found.value, biased_errors(found)])
    result = np.where(few[:, None], rows[:, [1, 3]], values)
    return result, few | ~np.isfinite(result[:, 0])


def _fall(t, y, peak, trough):
    """Time, slope, and time taken of the middle half of a fall, and no error of the slope, a bound.

    By the line through its samples; through those on both sides of the middle where they are few.
    """
    drop, level = y[peak] - y[trough], 0.5 * (y[peak] + y[trough])
    rows = peak + np.flatnonzero(np.abs(y[peak : trough + 1] - level) < 0.25 * drop)
    width = float(np.ptp(t[rows])) if rows.size else 0.0
    if rows.size < LINE:
        below = peak + max(int(np.argmax(y[peak : trough + 1] < level)), 1)
        rows = np.array([below - 1, below])
    x = t[rows] - t[rows].mean()
    return float(t[rows].mean()), -float(x @ y[rows]) / float(x @ x), width, math.nan
