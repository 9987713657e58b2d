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
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.ndimage import uniform_filter1d

from .between_samples import NEAR, middles, with_spikes
from .extremes import Window, chosen_window, extremes

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
#: error of tau in a run over the drop, from which a fall has too few samples; and samples
COARSE, SPARSE_RUN = 5e-4, 5
#: relative error of a run's steepest fall from which they are too few
ROUGH = 0.1
#: farthest that an extreme of a run may be from a sample, over the drop
FAR = 0.01


class Found(NamedTuple):
    """What a record says of m falls; NaN where it says nothing."""

    peak: np.ndarray  # (m, 4) tau at the peak [Pa], its error, the time [s], its error
    trough: np.ndarray  # (m, 4) the same at the trough
    middle: np.ndarray  # (m, 2) time of the middle of the fall, its error [s]
    slope: np.ndarray  # (m, 2) steepest fall of tau [Pa/s], its error
    samples: np.ndarray  # (m,) in the fall, between peak and trough
    sparse: np.ndarray  # (m,) whether they are too few for the slip rate

    @classmethod
    def nothing(cls, m):
        """Nothing found of m falls."""
        peak, trough, middle, slope = (np.full((m, n), math.nan) for n in (4, 4, 2, 2))
        return cls(peak, trough, middle, slope, np.zeros(m, int), np.zeros(m, bool))


def found_in_record(series, falls, spans, noise):
    """`Found` for whole falls (m, 2) at one load-point velocity.

    spans : (m, 2) samples at which the loading before them begins, and that after them ends
    """
    t, y = series.t, series.tau
    peaks, troughs = falls.T
    spacing = float(np.median(np.diff(t)))
    means, width = _means(y, peaks, troughs, noise)
    rough_levels = np.stack([means[peaks], means[troughs]])
    middle = middles(t, means, peaks, troughs, rough_levels, np.zeros(peaks.size), noise)
    found = []
    for sign, samples, edge in zip((1, -1), falls.T, spans.T, strict=True):
        loading = float(np.median(sign * (t[samples] - t[edge])))
        one = _stress_extremes(t, y, middle[:, 0], t[samples], sign, loading, spacing, noise)
        found.append(with_spikes(t, y, middle[:, 0], one, sign, noise))
    at = [np.searchsorted(t, one[:, 2]) for one in found]
    if width > 1:  # (a sample far from the fall may pass its middle by noise)
        peaks, troughs = np.maximum(peaks, at[0] - width), np.minimum(troughs, at[1] + width)
    (high, high_error, *_), (low, low_error, *_) = (one.T for one in found)
    level_error = 0.5 * np.hypot(high_error, low_error)
    middle = middles(t, y, peaks, troughs, np.stack([high, low]), level_error, noise)
    middle[:, 1] = np.hypot(middle[:, 1], series.t_resolution)
    slope, few = _slopes(t, y, middle[:, 0], peaks, troughs, noise)
    for one in found:
        one[:, 1] = np.hypot(one[:, 1], series.resolution)
        one[:, 3] = np.hypot(one[:, 3], series.t_resolution)
    samples = np.maximum(at[1] - at[0], 0)
    return Found(found[0], found[1], middle, slope, samples, few)


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
    return np.column_stack([found.value, found.biased_error, time, found.time_error])


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
    halves = [_middle_half(t, y, i, j) for i, j in zip(peaks, troughs, strict=True)]
    times, means, widths = np.array(halves).T
    time, width = float(np.median(times - middle)), float(np.median(widths))
    few = widths < SPARSE * spacing
    bounds = np.column_stack([means, np.full(means.size, math.nan)])
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
        return bounds, np.ones(middle.size, bool)
    values = np.column_stack([-found.value, found.biased_error])
    result = np.where(few[:, None], bounds, values)
    return result, few | ~np.isfinite(result[:, 0])


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


def found_in_run(series, falls):
    """`Found` for the whole falls (m, 2) of a run."""
    rate = series.K * (series.V_lp - series.V)
    found = np.array([_in_run(series, rate, *fall) for fall in falls])
    peaks, troughs, middle, slope = np.split(found, [4, 8, 10], axis=1)
    drop, samples = peaks[:, 0] - troughs[:, 0], falls[:, 1] - falls[:, 0]
    few = (samples < SPARSE_RUN) | (slope[:, 1] > ROUGH * np.abs(slope[:, 0]))
    few |= np.hypot(peaks[:, 1], troughs[:, 1]) > COARSE * drop
    return Found(peaks, troughs, middle, slope, samples, few)


def _in_run(series, rate, peak, trough):
    """(12,) the columns of `Found` up to the slope, of one fall."""
    t, tau = series.t, series.tau
    most = FAR * (tau[peak] - tau[trough])
    high, low = (_extreme(t, tau, rate, i, sign, most) for i, sign in ((peak, 1), (trough, -1)))
    for one in (high, low):
        one[1] = math.hypot(one[1], series.resolution)
    middle = _middle(t, tau, rate, peak, trough, 0.5 * (high[0] + low[0]))
    return [*high, *low, *middle, *_steepest(series, peak, trough)]


def _extreme(t, tau, rate, i, sign, most):
    """Value, error, time and time error of the extreme next to sample i.

    most : farthest that an extreme may be from the sample; beyond, a cubic misses a bend, and the
        extreme is half a sample on at the slower of the slopes
    """
    value, time = _on_cubics(t, tau, rate, [i - 1, i, i + 1], sign)
    if abs(value - tau[i]) > most:
        around = slice(max(i - 1, 0), i + 2)
        half = 0.5 * float(np.diff(t[around]).max())
        beyond = np.abs(rate[around]).min() * half
        return [tau[i] + sign * beyond, beyond, t[i], half]
    other, at = _on_cubics(t, tau, rate, [i - 2, i, i + 2], sign)
    return [value, abs(value - other), time, abs(time - at)]


def _on_cubics(t, tau, rate, samples, sign):
    """Value and time of the extreme of the cubics through these samples."""
    rows = np.unique(np.clip(samples, 0, t.size - 1))
    level, origin = tau[rows[0]], t[rows[0]]
    x, y = t[rows] - origin, tau[rows] - level
    curve = CubicHermiteSpline(x, y, rate[rows], extrapolate=False)
    at = curve.derivative().roots(extrapolate=False)
    at = np.concatenate([x, at[np.isfinite(at)]])
    values = curve(at)
    best = int(np.argmax(sign * values))
    return float(values[best] + level), float(at[best] + origin)


def _middle(t, tau, rate, peak, trough, level):
    """Time at which tau falls through a level, and its error."""
    after = peak + int(np.argmax(tau[peak : trough + 1] < level))
    rows = np.array([after - 1, after])
    curve = CubicHermiteSpline(t[rows] - t[after - 1], tau[rows] - level, rate[rows])
    at = curve.roots(extrapolate=False)
    straight = float(np.interp(-level, -tau[rows], t[rows]))
    if not np.isfinite(at).any():
        return straight, (t[after] - t[after - 1]) / math.sqrt(12.0)
    time = float(at[np.isfinite(at)][0] + t[after - 1])
    return time, abs(time - straight)


def _steepest(series, peak, trough):
    """Largest K (V - V_lp) in a fall, between samples too, and its error.

    By the parabola through ln V at the three largest samples (of V if one is not above 0).
    """
    t, V, K = series.t, series.V, series.K
    i = peak + int(np.argmax(V[peak : trough + 1]))
    rows = np.arange(max(i - 1, 0), min(i + 2, t.size))
    V_max = V[i]
    if rows.size == 3 and (V[rows] > 0.0).all():
        c = np.polynomial.polynomial.polyfit(t[rows] - t[i], np.log(V[rows]), 2)
        if c[2] < 0.0:
            V_max = max(V_max, math.exp(c[0] - 0.25 * c[1] ** 2 / c[2]))
    return K * (V_max - series.V_lp[i]), K * abs(V_max - V[i]) / 4.0
