"""Peaks and troughs between samples, which a polynomial beside the fall does not see.

Stress may overshoot at the end of a fast fall, for less than a step between samples.  The line
through the samples beyond the fall, back to where it meets the line of the fall, tells how far it
may be between samples.  That, or its mean over all events, is the standard error too, since stress
may bend within a step.
"""

import math

import numpy as np

#: how far bounds exceed extremes by noise: their mean, and standard deviation of one, in those of
#: a sample; standard errors of the mean excess from which it is not by noise
BY_NOISE, SPREAD, SURE = 1.7, 2.0, 4.0


def with_spikes(t, y, middle, found, sign, noise):
    """Extremes (m, 4) of `_stress_extremes`, or the middle between the last sample and its bound.

    They are kept if the bounds exceed them by no more than noise in the mean of all events, or if
    some are unknown.
    """
    rows = np.array([_bound(t, sign * y, int(i), -sign) for i in np.searchsorted(t, middle)])
    excess = rows[:, 1] - sign * found[:, 0]
    error = math.sqrt(np.mean((SPREAD * noise.sd) ** 2 + found[:, 1] ** 2) / excess.size)
    if not np.mean(excess) > BY_NOISE * noise.sd + SURE * error:
        return found
    low = np.maximum(rows[:, 0], sign * found[:, 0])
    beyond = np.maximum(rows[:, 1] - low, 0.0)
    error = np.hypot(np.maximum(beyond, np.sqrt(np.mean(beyond**2))), noise.sd)
    return np.column_stack([sign * (low + 0.5 * beyond), error, rows[:, 2], rows[:, 3]])


def _bound(t, y, middle, away):
    """Largest sample next to a fall, bound of what is beside it, time, and half of its range.

    y : (n,) of which a maximum is sought
    middle : first sample after the middle of the fall
    away : -1 if the maximum is before the fall, 1 if it is after
    """
    i = middle - (away < 0)
    while 1 < i + away < t.size - 2 and y[i + away] > y[i]:
        i += away
    if not 2 <= i <= t.size - 3:
        return y[i], -math.inf, t[i], 0.0
    bounds = [_crossing(t, y, i - away, away), _crossing(t, y, i, away)]
    return y[i], max(bounds), t[i], 0.5 * (t[i + 1] - t[i - 1])


def _crossing(t, y, i, away):
    """Where the lines on both sides of the step from sample i meet; if they do not, the far one."""
    j = i + away
    near = (y[i] - y[i - away]) / (t[i] - t[i - away])
    far = (y[j + away] - y[j]) / (t[j + away] - t[j])
    start = y[j] + far * (t[i] - t[j])  # of the line beyond, at sample i
    until = (start - y[i]) / (near - far) if near != far else math.inf
    return y[i] + near * until if 0.0 <= until / (t[j] - t[i]) <= 1.0 else max(start, y[j])
