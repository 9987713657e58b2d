"""Peaks, troughs, times and slip rates of falls, in a noisy record and in a run.

In a record everything is counted from the middle of a fall, where stress is steep and time well
known.

A run has no noise.  Between its samples tau is the cubic that has its values and slopes, dtau/dt =
K (V_lp - V), at both: its extremes and the middle of a fall are found on that.  What a cubic
through every second sample gives differently is taken for the error: the error of few samples does
not yet fall as h^4.
"""

import itertools
import math

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.ndimage import uniform_filter1d

from .between_samples import ANYWHERE, NEAR, middles, with_spikes
from .detection import is_whole
from .extremes import Window, chosen_window, extremes
from .lines import speed_groups

#: what is measured of a fall; each has an error
NAMES = ("tau_max", "event_start", "tau_min", "event_end", "event_time", "fall_rate")
COLUMNS = 2 * len(NAMES) + 2
#: scatter of rough drops, as a part of their median, beyond which events have windows of their own
ALIKE = 0.1
#: the same in standard deviations of the noise, which changes rough drops
BY_NOISE = 3.0
#: shortest loading beside an event, as a part of the median, of events that share windows
CLOSE = 0.5
#: extents of windows on the side of the loading, as parts of the time of loading; least [samples]
LOADING, SHORTEST = np.geomspace(0.02, 0.85, 9), 6.0
#: ends of windows on the side of the fall, as parts of the time from its middle to the extreme; and
#: in samples from the middle
FALL, NEAREST = (0.1, 0.25, 0.4, 0.6, 0.8, 0.9, 0.95, 1.0), (0.5, 1.0, 1.5, 2.0, 3.0)
#: least ends of windows on the side of the fall, in samples, or as a part of the time of loading if
#: that is less: noise can hide a sample that is still in the fall
LEAST, OF_LOADING = 1.0, 0.05
#: half extents of windows for the slip rate, as parts of the time of the fall
STEEP = np.geomspace(0.2, 3.2, 8)
#: samples in the middle half of a fall below which its mean slope there is taken, a lower bound
SPARSE = 8
#: fewest samples of a fall through which a line is drawn
LINE = 3
#: standard errors of a mean of samples by which the middle of a fall is within a quarter drop
CLEAR = 4.0
#: times that windows are placed about what the last ones gave
ROUNDS = 2
#: error of tau in a run, as a part of the drop, from which a fall has too few samples; and samples
COARSE, SPARSE_RUN = 5e-4, 5
#: relative error of a run's steepest fall from which they are too few
ROUGH = 0.1
#: farthest that an extreme of a run may be from a sample, as a part of the drop
FAR = 0.01


def measured_falls(series, falls, gaps, noise):
    """Each of `NAMES` -> values (m,) and errors (m,) of falls; "samples", "sparse" -> (m,).

    NaN for a fall that the record cuts, but for the time it has, and if samples are missing in it.
    ``samples`` is their number in the fall, ``sparse`` whether they are too few for the slip rate.

    gaps : (m,) whether samples are missing
    """
    # the columns are values and errors of `NAMES` in turn, samples and sparse
    whole, table = is_whole(falls), np.full((len(falls), COLUMNS), math.nan)
    table[:, -2:] = 0.0
    for name, samples in zip(("event_start", "event_end"), falls.T, strict=True):
        cut = ~whole & (samples >= 0)
        table[cut, 2 * NAMES.index(name)] = series.t[samples[cut]]
    spans, rows = spans_of(series, falls), np.flatnonzero(whole & ~gaps)
    if series.V is not None:
        rate = series.K * (series.V_lp - series.V)
        for row in rows:
            table[row] = _in_run(series, rate, *falls[row])
    else:
        for group in _groups(series, spans, rows, noise):
            table[group] = _in_record(series, spans[group], noise)
    found: dict = {name: tuple(table[:, 2 * i : 2 * i + 2].T) for i, name in enumerate(NAMES)}
    return found | {"samples": table[:, -2].astype(int), "sparse": table[:, -1] > 0.0}


def spans_of(series, falls):
    """(m, 4) samples of the last trough, of a fall's peak and trough, and of the next peak."""
    last = np.maximum(np.append(0, falls[:, 1])[:-1], 0)
    following = np.append(falls[:, 0], series.t.size - 1)[1:]
    return np.column_stack([last, falls, following])


def _groups(series, spans, whole, noise):
    """Rows of events that are alike: at one V_lp, with much the same drop; else each by itself.

    spans : (m, 4) of `spans_of`; whole : rows of whole events
    """
    if not whole.size:
        return []
    t, (peaks, troughs) = series.t, spans[whole, 1:3].T
    drop = series.tau[peaks] - series.tau[troughs]
    # (loading that the record cuts does not count)
    beside = np.diff(t[spans[whole]], axis=1)[:, ::2]
    is_end = (whole == 0) | (whole == len(spans) - 1)
    loading = np.where(is_end, beside.max(axis=1), beside.min(axis=1))
    speed = speed_groups(series.at(0.5 * (t[peaks] + t[troughs]), series.V_lp))
    groups = []
    for number in range(speed.max() + 1):
        at = np.flatnonzero(speed == number)
        off = np.abs(drop[at] - np.median(drop[at]))
        near = off <= math.hypot(ALIKE * np.median(drop[at]), BY_NOISE * noise.sd)
        near &= loading[at] > CLOSE * np.median(loading[at])
        groups += [whole[at[near]]] if near.any() else []
        groups += [whole[[i]] for i in at[~near]]
    return groups


def _in_record(series, spans, noise):
    """(m, COLUMNS) rows of the table of falls, for a group of them."""
    t, y = series.t, series.tau
    begins, peaks, troughs, ends = spans.T
    drop = float(np.median(y[peaks] - y[troughs]))
    # in means of so many samples noise does not hide the middles of falls
    width = math.ceil((CLEAR * noise.sd / (NEAR * drop)) ** 2 * noise.inflation)
    width = min(width, max(int(np.min(troughs - peaks)) // 2, 1))
    means = uniform_filter1d(y, width) if width > 1 else y
    nothing = np.zeros(peaks.size)
    middle, _ = middles(t, means, peaks, troughs, means[peaks], means[troughs], nothing, noise)
    sides = []
    for sign, samples, edge in ((1, peaks, begins), (-1, troughs, ends)):
        loading = float(np.median(sign * (t[samples] - t[edge])))
        one = _stress_extremes(t, y, middle, t[samples], sign, loading, noise)
        value, error, time, time_error = with_spikes(t, y, middle, one, sign, noise)
        error = np.hypot(error, series.resolution)
        sides.append((value, error, time, np.hypot(time_error, series.t_resolution)))
    (high, high_error, start, _), (low, low_error, end, _) = sides
    first, last = np.searchsorted(t, start), np.searchsorted(t, end)
    if width > 1:  # (a sample far from the fall may pass its middle by noise)
        peaks, troughs = np.maximum(peaks, first - width), np.minimum(troughs, last + width)
    level_error = 0.5 * np.hypot(high_error, low_error)
    middle, error = middles(t, y, peaks, troughs, high, low, level_error, noise)
    slope, slope_error, few = _slopes(t, y, middle, peaks, troughs, noise)
    error, samples = np.hypot(error, series.t_resolution), np.maximum(last - first, 0)
    return np.column_stack([*sides[0], *sides[1], middle, error, slope, slope_error, samples, few])


def _stress_extremes(t, y, middle, at, sign, loading, noise):
    """Value, error, time, time error (m,) of peaks (sign 1) or troughs (-1).

    at : (m,) rough times of these
    """
    for _ in range(ROUNDS):
        offset = float(np.median(at - middle))
        windows = list(_windows(offset, loading, float(np.median(np.diff(t))), sign))
        window = chosen_window(t, y, middle, windows, 0, sign, noise)
        if window is None:
            return np.full((4, middle.size), math.nan)
        found = extremes(t, y, middle, window, 0, sign, noise)
        at = np.where(np.isfinite(found.time), found.time, middle + offset)
    # (a peak is always before the middle of its fall; noise may place it after)
    time = sign * np.minimum(sign * found.time, sign * middle)
    return np.array([found.value, found.biased_error, time, found.time_error])


def _windows(offset, loading, spacing, sign):
    """`Window`s that have an extreme this long after the middle of the fall (peaks: < 0)."""
    reach, least = abs(offset), min(LEAST * spacing, OF_LOADING * loading)
    nears = [part * reach for part in FALL]
    nears += [j * spacing for j in NEAREST if j * spacing <= reach + spacing]
    nears = sorted({max(near, least) for near in nears})
    for extent, near in itertools.product(LOADING * loading, nears):
        far = max(reach + extent, near + SHORTEST * spacing)
        if far < reach + loading:  # (beyond is the next fall)
            yield Window(-far, -near, 1) if sign > 0 else Window(near, far, -1)


def _slopes(t, y, middle, peaks, troughs, noise):
    """Steepest fall (m,) [Pa/s], its error, and whether samples are too few for it."""
    spacing = np.median(np.diff(t))
    fall = max(float(np.median(t[troughs] - t[peaks])), spacing)
    halves = [_middle_half(t, y, i, j) for i, j in zip(peaks, troughs, strict=True)]
    times, means, widths = np.array(halves).T
    time, few, window = float(np.median(times - middle)), widths < SPARSE * spacing, None
    for _ in range(ROUNDS if not few.all() else 0):
        extents = np.unique(np.clip(STEEP * float(np.median(widths)), 3.5 * spacing, fall))
        windows = [Window(time - a, time + b, 0) for a, b in itertools.product(extents, extents)]
        window = chosen_window(t, y, middle, windows, 1, -1, noise)
        if window is None:
            break
        found = extremes(t, y, middle, window, 1, -1, noise)
        time = float(np.nanmedian(found.time - middle))
    if window is None:
        return means, np.full(means.size, math.nan), np.ones(means.size, bool)
    slope = np.where(few, means, -found.value)
    return slope, np.where(few, math.nan, found.biased_error), few | ~np.isfinite(slope)


def _middle_half(t, y, peak, trough):
    """Time, mean fall [Pa/s], and time taken of the middle half of a fall.

    By the line through its samples; through those on both sides of the middle if they are few.
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
    """(COLUMNS,) row of the table of falls, for one of a run.

    rate : (n,) dtau/dt [Pa/s]
    """
    t, tau, K, drop = series.t, series.tau, series.K, series.tau[peak] - series.tau[trough]
    high, low = (_extreme(series, rate, i, sign, drop) for i, sign in ((peak, 1), (trough, -1)))
    level = 0.5 * (high[0] + low[0])
    after = peak + int(np.argmax(tau[peak : trough + 1] < level))
    rows = np.array([after - 1, after])
    middle = straight = float(np.interp(-level, -tau[rows], t[rows]))
    error = ANYWHERE * (t[after] - t[after - 1])
    curve = CubicHermiteSpline(t[rows] - t[after - 1], tau[rows] - level, rate[rows])
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
    few = trough - peak < SPARSE_RUN or slope_error > ROUGH * abs(slope)
    few |= math.hypot(high[1], low[1]) > COARSE * (high[0] - low[0])
    return [*high, *low, middle, error, slope, slope_error, trough - peak, few]


def _extreme(series, rate, i, sign, drop):
    """Value, error, time and time error of the extreme next to sample i of a run.

    Far from the sample a cubic misses a bend, and the extreme is half a sample on at the slower of
    the slopes.
    """
    t, tau = series.t, series.tau
    found = []
    for step in (1, 2):
        rows = np.unique(np.clip([i - step, i, i + step], 0, t.size - 1))
        curve = CubicHermiteSpline(
            t[rows] - t[i], tau[rows] - tau[i], rate[rows], extrapolate=False
        )
        turns = curve.derivative().roots(extrapolate=False)
        at = np.concatenate([curve.x, turns[np.isfinite(turns)]])
        best = int(np.argmax(sign * curve(at)))
        found.append(np.array([curve(at[best]), at[best]]))
    (value, time), (other, other_time) = found
    error, time_error = abs(value - other), abs(time - other_time)
    if abs(value) > FAR * drop:
        around = slice(max(i - 1, 0), i + 2)
        time, time_error = 0.0, 0.5 * float(np.diff(t[around]).max())
        error = np.abs(rate[around]).min() * time_error
        value = sign * error
    return tau[i] + value, math.hypot(error, series.resolution), t[i] + time, time_error
