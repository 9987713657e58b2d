"""Peaks, troughs, times and slip rates of events in a run without noise.

Between samples tau is the cubic that has its values and slopes, dtau/dt = K (V_load - V), at both:
its extremes and the middle of a fall are found on that.  What a cubic through every second sample
gives differently is taken for the error: the error of few samples does not yet fall as h^4.
"""

import math

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from .recorded import Found

#: error of tau at a sample's time over the drop, from which a fall has too few samples; and samples
COARSE, SPARSE = 5e-4, 5
#: relative error of the steepest fall from which they are too few
ROUGH = 0.1
#: farthest that an extreme may be from a sample, over the drop
FAR = 0.01


def found_events(series, rough):
    """`Found` for the whole `Rough` events (m) of a run."""
    t, tau, V = series.t, series.tau, series.V
    rate = series.K * (series.load.V - V)
    most = [FAR * (tau[one.peak] - tau[one.trough]) for one in rough]
    pairs = [*zip(rough, most, strict=True)]
    peaks = np.array([_extreme(t, tau, rate, one.peak, 1, far) for one, far in pairs])
    troughs = np.array([_extreme(t, tau, rate, one.trough, -1, far) for one, far in pairs])
    for rows in (peaks, troughs):
        rows[:, 1] = np.hypot(rows[:, 1], series.resolution)
    middle, slope, few = [], [], []
    for (peak, trough), top, bottom in zip(rough, peaks[:, 0], troughs[:, 0], strict=True):
        middle.append(_middle(t, tau, rate, peak, trough, 0.5 * (top + bottom)))
        slope.append(_steepest(t, series.K, V, series.load.V, peak, trough))
        few.append(trough - peak < SPARSE or slope[-1][1] > ROUGH * abs(slope[-1][0]))
    samples = np.array([trough - peak for peak, trough in rough])
    drop = peaks[:, 0] - troughs[:, 0]
    coarse = np.hypot(peaks[:, 1], troughs[:, 1]) > COARSE * drop
    few = np.array(few) | coarse
    return Found(peaks, troughs, np.array(middle), np.array(slope), samples, few)


def _extreme(t, tau, rate, i, sign, most):
    """Value, error, time and time error of the extreme next to sample i.

    most : farthest that an extreme may be from the sample; beyond, a cubic misses a bend, and the
        extreme is half a sample on at the slower of the slopes
    """
    value, time = _between(t, tau, rate, [i - 1, i, i + 1], sign)
    if abs(value - tau[i]) > most:
        around = slice(max(i - 1, 0), i + 2)
        beyond = 0.5 * np.abs(rate[around]).min() * np.diff(t[around]).max()
        half = 0.5 * float(np.diff(t[around]).max())
        return tau[i] + sign * beyond, beyond, t[i], half
    other, at = _between(t, tau, rate, [i - 2, i, i + 2], sign)
    return value, abs(value - other), time, abs(time - at)


def _between(t, tau, rate, samples, sign):
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
    origin = t[after - 1]
    curve = CubicHermiteSpline(t[rows] - origin, tau[rows] - level, rate[rows], extrapolate=False)
    at = curve.roots(extrapolate=False)
    at = at[np.isfinite(at)]
    straight = float(np.interp(-level, -tau[rows], t[rows]))
    if not at.size:
        return straight, (t[after] - t[after - 1]) / math.sqrt(12.0)
    return float(at[0] + origin), abs(float(at[0] + origin) - straight)


def _steepest(t, K, V, V_load, peak, trough):
    """Largest K (V - V_load) in a fall, between samples too, and its error.

    By the parabola through ln V at the three largest samples (of V where one is not above 0).
    """
    i = peak + int(np.argmax(V[peak : trough + 1]))
    rows = np.arange(max(i - 1, 0), min(i + 2, t.size))
    V_max = V[i]
    if rows.size == 3 and (V[rows] > 0.0).all():
        c = np.polynomial.polynomial.polyfit(t[rows] - t[i], np.log(V[rows]), 2)
        if c[2] < 0.0:
            V_max = max(V_max, math.exp(c[0] - 0.25 * c[1] ** 2 / c[2]))
    return K * (V_max - V_load[i]), K * abs(V_max - V[i]) / 4.0
