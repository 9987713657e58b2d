"""Peaks, troughs, times and slip rates of falls, in a noisy record or in a run.

In a record times are relative to the middle of a fall.  There the stress is steep, and its time is
well known.

A run has no noise.  Between two samples tau is the cubic with the values and the slopes, dtau/dt =
K (V_lp - V), of both.  Extremes and the middle of a fall are found on this cubic.  The error is the
difference from a cubic through every second sample, because with few samples the error is not yet
proportional to the fourth power of the step.
"""

import itertools
import math

import numpy as np
import scipy

from .between_samples import FITTED_PART, UNIFORM_SD, corrected_for_spikes, middles
from .detection import is_whole
from .extremes import FallWindow, chosen_window, extremes
from .lines import speed_groups

#: measured quantities of a fall; each has an error
NAMES = ("tau_max", "event_start", "tau_min", "event_end", "event_time", "fall_rate")
COLUMNS = 2 * len(NAMES) + 2
#: largest deviation from the median drop of events that share windows: as a fraction, and in
#: standard deviations of the noise
SIMILARITY, BY_NOISE = 0.1, 3.0
#: shortest loading next to an event, as a fraction of the median, of events that share windows
MIN_LOADING = 0.5
#: extents of windows into the loading, as fractions of its duration; shortest window [samples]
LOADING, SHORTEST = np.geomspace(0.02, 0.85, 9), 6.0
#: ends of windows next to the fall: as fractions of the time from its middle to the extreme, and in
#: samples from the middle
FALL, NEAREST = (0.1, 0.25, 0.4, 0.6, 0.8, 0.9, 0.95, 1.0), (0.5, 1.0, 1.5, 2.0, 3.0)
#: least distance of these ends from the middle, because noise can hide that a sample is in the
#: fall: in samples, or as a fraction of the duration of loading if that is less
LEAST, OF_LOADING = 1.0, 0.05
#: half extents of windows for the slip rate, as fractions of the duration of the fall
STEEP = np.geomspace(0.2, 3.2, 8)
#: fewest samples in the middle half of a fall for its steepest slope; else the mean slope is used
SPARSE = 8
#: fewest samples in the middle half of a fall for a line through them
LINE = 3
#: a quarter of the drop, in standard errors of a moving average, for a clear middle of a fall
CLEAR_DROP = 4.0
#: number of times that windows are placed relative to the last estimates
ROUNDS = 2
#: in a run: largest error of tau, as a fraction of the drop, and fewest samples of a resolved fall
COARSE, SPARSE_RUN = 5e-4, 5
#: largest relative error of the steepest slope of a resolved fall in a run
ROUGH = 0.1
#: largest distance of an extreme of a run from a sample, as a fraction of the drop
MAX_DISTANCE = 0.01


def measured_falls(series, falls, gaps, noise):
    """Measure falls: each of `NAMES` -> values and errors (m,); "samples", "sparse" -> (m,).

    Values are NaN if samples are missing in the fall, or if the record cuts it; then only the time
    of the recorded end is known.  ``samples`` is the number of samples in the fall.  ``sparse``
    means that they are too few for the slip rate.

    gaps : (m,) whether samples are missing
    """
    # the columns are value and error of each of `NAMES`, then samples and sparse
    complete, table = is_whole(falls), np.full((len(falls), COLUMNS), math.nan)
    table[:, -2:] = 0.0
    for name, samples in zip(("event_start", "event_end"), falls.T, strict=True):
        cut = ~complete & (samples >= 0)
        table[cut, 2 * NAMES.index(name)] = series.t[samples[cut]]
    spans, rows = spans_of(series, falls), np.flatnonzero(complete & ~gaps)
    if series.V is not None:
        rate = series.K * (series.V_lp - series.V)
        for row in rows:
            table[row] = _in_run(series, rate, *falls[row])
    else:
        for group in _groups(series, spans, rows, noise):
            table[group] = _in_record(series, spans[group], noise)
    columns: dict = {name: tuple(table[:, 2 * i : 2 * i + 2].T) for i, name in enumerate(NAMES)}
    return columns | {"samples": table[:, -2].astype(int), "sparse": table[:, -1] > 0.0}


def spans_of(series, falls):
    """Return samples (m, 4) of last trough, peak and trough of the fall, and next peak."""
    last = np.maximum(np.append(0, falls[:, 1])[:-1], 0)
    following = np.append(falls[:, 0], series.t.size - 1)[1:]
    return np.column_stack([last, falls, following])


def _groups(series, spans, rows, noise):
    """Group rows of whole events with one V_lp and similar drops, and each other event by itself.

    spans : (m, 4) from `spans_of`
    """
    if not rows.size:
        return []
    t, (peaks, troughs) = series.t, spans[rows, 1:3].T
    drop = series.tau[peaks] - series.tau[troughs]
    # (ignore loading that the record cuts)
    loadings = np.diff(t[spans[rows]], axis=1)[:, ::2]
    is_end = (rows == 0) | (rows == len(spans) - 1)
    loading = np.where(is_end, loadings.max(axis=1), loadings.min(axis=1))
    speed = speed_groups(series.at(0.5 * (t[peaks] + t[troughs]), series.V_lp))
    groups = []
    for number in range(speed.max() + 1):
        at = np.flatnonzero(speed == number)
        distance = np.abs(drop[at] - np.median(drop[at]))
        is_similar = distance <= math.hypot(SIMILARITY * np.median(drop[at]), BY_NOISE * noise.sd)
        is_similar &= loading[at] > MIN_LOADING * np.median(loading[at])
        groups += [rows[at[is_similar]]] if is_similar.any() else []
        groups += [rows[[i]] for i in at[~is_similar]]
    return groups


def _in_record(series, spans, noise):
    t, y = series.t, series.tau
    begins, peaks, troughs, ends = spans.T
    drop = float(np.median(y[peaks] - y[troughs]))
    # the moving average is so wide that noise does not hide the middles of falls
    width = math.ceil((CLEAR_DROP * noise.sd / (FITTED_PART * drop)) ** 2 * noise.inflation)
    width = min(width, max(int(np.min(troughs - peaks)) // 2, 1))
    means = scipy.ndimage.uniform_filter1d(y, width) if width > 1 else y
    zeros = np.zeros(peaks.size)
    middle, _ = middles(t, means, peaks, troughs, means[peaks], means[troughs], zeros, noise)
    sides = []
    for sign, samples, edge in ((1, peaks, begins), (-1, troughs, ends)):
        loading = float(np.median(sign * (t[samples] - t[edge])))
        extreme = _stress_extremes(t, y, middle, t[samples], sign, loading, noise)
        value, error, time, time_error = corrected_for_spikes(t, y, middle, extreme, sign, noise)
        error = np.hypot(error, series.resolution)
        sides.append((value, error, time, np.hypot(time_error, series.t_resolution)))
    (high, high_error, start, _), (low, low_error, end, _) = sides
    first, last = np.searchsorted(t, start), np.searchsorted(t, end)
    if width > 1:  # (due to noise, a sample far from the fall may cross the middle level)
        peaks, troughs = np.maximum(peaks, first - width), np.minimum(troughs, last + width)
    level_error = 0.5 * np.hypot(high_error, low_error)
    middle, error = middles(t, y, peaks, troughs, high, low, level_error, noise)
    *slopes, sparse = _slopes(t, y, middle, peaks, troughs, noise)
    error, samples = np.hypot(error, series.t_resolution), np.maximum(last - first, 0)
    return np.column_stack([*sides[0], *sides[1], middle, error, *slopes, samples, sparse])


def _stress_extremes(t, y, middle, at, sign, loading, noise):
    """Return value, error, time and time error (4, m) of peaks (sign 1) or troughs (-1).

    middle : (m,) times of the middles of falls
    at : (m,) rough times of the extremes
    """
    for _ in range(ROUNDS):
        offset = float(np.median(at - middle))
        windows = list(_windows(offset, loading, float(np.median(np.diff(t))), sign))
        window = chosen_window(t, y, middle, windows, 0, sign, noise)
        if window is None:
            return np.full((4, middle.size), math.nan)
        result = extremes(t, y, middle, window, 0, sign, noise)
        at = np.where(np.isfinite(result.time), result.time, middle + offset)
    # (a peak is before the middle of its fall, though noise may place it after)
    time = sign * np.minimum(sign * result.time, sign * middle)
    return np.array([result.value, result.biased_error, time, result.time_error])


def _windows(offset, loading, spacing, sign):
    """Generate `FallWindow`s for an extreme at this time after a fall's middle (peaks: < 0)."""
    reach, least = abs(offset), min(LEAST * spacing, OF_LOADING * loading)
    distances = [part * reach for part in FALL]
    distances += [j * spacing for j in NEAREST if j * spacing <= reach + spacing]
    distances = sorted({max(start, least) for start in distances})
    for extent, start in itertools.product(LOADING * loading, distances):
        end = max(reach + extent, start + SHORTEST * spacing)
        if end < reach + loading:  # (the next fall lies beyond)
            yield FallWindow(-end, -start, 1) if sign > 0 else FallWindow(start, end, -1)


def _slopes(t, y, middle, peaks, troughs, noise):
    """Return the steepest slopes (m,) [Pa/s], their errors, and whether samples are too few."""
    spacing = np.median(np.diff(t))
    fall = max(float(np.median(t[troughs] - t[peaks])), spacing)
    halves = [_middle_half(t, y, i, j) for i, j in zip(peaks, troughs, strict=True)]
    times, means, widths = np.array(halves).T
    time, sparse, window = float(np.median(times - middle)), widths < SPARSE * spacing, None
    for _ in range(ROUNDS if not sparse.all() else 0):
        extents = np.unique(np.clip(STEEP * float(np.median(widths)), 3.5 * spacing, fall))
        pairs = itertools.product(extents, extents)
        windows = [FallWindow(time - a, time + b, 0) for a, b in pairs]
        window = chosen_window(t, y, middle, windows, 1, -1, noise)
        if window is None:
            break
        result = extremes(t, y, middle, window, 1, -1, noise)
        time = float(np.nanmedian(result.time - middle))
    if window is None:
        return means, np.full(means.size, math.nan), np.ones(means.size, bool)
    slope = np.where(sparse, means, -result.value)
    return slope, np.where(sparse, math.nan, result.biased_error), sparse | ~np.isfinite(slope)


def _middle_half(t, y, peak, trough):
    """Return mean time, slope [Pa/s] and duration of the middle half of a fall.

    The slope belongs to a line through its samples, or if they are too few through the two samples
    next to the middle.
    """
    drop, level = y[peak] - y[trough], 0.5 * (y[peak] + y[trough])
    rows = peak + np.flatnonzero(np.abs(y[peak : trough + 1] - level) < 0.25 * drop)
    width = float(np.ptp(t[rows])) if rows.size else 0.0
    if rows.size < LINE:
        below = peak + max(int(np.argmax(y[peak : trough + 1] < level)), 1)
        rows = np.array([below - 1, below])
    x = t[rows] - t[rows].mean()
    return float(t[rows].mean()), -float(x @ y[rows]) / float(x @ x), width


def _in_run(series, rate, peak, trough):
    """Return the row (COLUMNS,) of the table for a fall in a run with this dtau/dt (n,)."""
    t, tau, K, drop = series.t, series.tau, series.K, series.tau[peak] - series.tau[trough]
    high, low = (_extreme(series, rate, i, sign, drop) for i, sign in ((peak, 1), (trough, -1)))
    level = 0.5 * (high[0] + low[0])
    after = peak + int(np.argmax(tau[peak : trough + 1] < level))
    rows = np.array([after - 1, after])
    middle = straight = float(np.interp(-level, -tau[rows], t[rows]))
    error = UNIFORM_SD * (t[after] - t[after - 1])
    curve = scipy.interpolate.CubicHermiteSpline(
        t[rows] - t[after - 1], tau[rows] - level, rate[rows]
    )
    crossings = curve.roots(extrapolate=False)
    if np.isfinite(crossings).any():
        middle = float(crossings[np.isfinite(crossings)][0] + t[after - 1])
        error = abs(middle - straight)
    # the largest slip rate is on the parabola through ln V at the three largest samples
    i = peak + int(np.argmax(series.V[peak : trough + 1]))
    rows = np.arange(max(i - 1, 0), min(i + 2, t.size))
    V, V_max = series.V[rows], series.V[i]
    if rows.size == 3 and (V > 0.0).all():
        c = np.polynomial.polynomial.polyfit(t[rows] - t[i], np.log(V), 2)
        if c[2] < 0.0:
            V_max = max(V_max, math.exp(c[0] - 0.25 * c[1] ** 2 / c[2]))
    slope, slope_error = K * (V_max - series.V_lp[i]), K * abs(V_max - series.V[i]) / 4.0
    sparse = trough - peak < SPARSE_RUN or slope_error > ROUGH * abs(slope)
    sparse |= math.hypot(high[1], low[1]) > COARSE * (high[0] - low[0])
    return [*high, *low, middle, error, slope, slope_error, trough - peak, sparse]


def _extreme(series, rate, i, sign, drop):
    """Return value, error, time and time error of the extreme next to sample i of a run.

    If the cubic's extreme is far from the sample, the cubic misses a bend.  The value then follows
    from the smallest slope nearby, over half a step.
    """
    t, tau = series.t, series.tau
    estimates = []
    for step in (1, 2):
        rows = np.unique(np.clip([i - step, i, i + step], 0, t.size - 1))
        curve = scipy.interpolate.CubicHermiteSpline(
            t[rows] - t[i], tau[rows] - tau[i], rate[rows], extrapolate=False
        )
        turns = curve.derivative().roots(extrapolate=False)
        at = np.concatenate([curve.x, turns[np.isfinite(turns)]])
        best = int(np.argmax(sign * curve(at)))
        estimates.append(np.array([curve(at[best]), at[best]]))
    (value, time), (other, other_time) = estimates
    error, time_error = abs(value - other), abs(time - other_time)
    if abs(value) > MAX_DISTANCE * drop:
        neighbours = slice(max(i - 1, 0), i + 2)
        time, time_error = 0.0, 0.5 * float(np.diff(t[neighbours]).max())
        error = np.abs(rate[neighbours]).min() * time_error
        value = sign * error
    return tau[i] + value, math.hypot(error, series.resolution), t[i] + time, time_error
