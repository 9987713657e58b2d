"""What samples leave open: when stress falls through a level, peaks between samples, lost events.

A fall is several events if it slackens and gains speed again, for one event falls fastest once.

Stress may overshoot at the end of a fast fall, for less than a step between samples.  The line
through the samples beyond the fall, back to where it meets the line of the fall, tells how far it
may be between samples.  That, or its mean over all events, is the standard error too, since stress
may bend within a step.
"""

import math

import numpy as np
from scipy.ndimage import uniform_filter1d

#: part of the drop on either side of the middle whose samples are fitted; fewest for a cubic
NEAR, FEWEST = 0.25, 6
#: Newton steps to the crossing of a cubic
NEWTON = 8
#: standard deviation of a time that may be anywhere in a step, in steps
ANYWHERE = 1.0 / math.sqrt(12.0)
#: how far bounds exceed extremes by noise: their mean, and standard deviation of one, in those of
#: a sample; standard errors of the mean excess from which it is not by noise
BY_NOISE, SPREAD, SURE = 1.7, 2.0, 4.0
#: numbers of samples over which falls are compared, at most these parts of a fall
LAGS, OF_FALL = (1, 2, 4, 8, 16, 32), 0.25
#: least slackening between two falls: standard deviations beyond what noise does, part of the drop
MARGIN, OF_DROP = 1.5, 0.15
#: independent falls among those over so many overlapping samples, times that number
OVERLAP = 4.0
#: parts of a loading phase, in samples, in which steps are looked for; numbers of samples on either
#: side of a step; degree of the polynomial that is taken out before
LOADING, SIDES, SMOOTH = (0.02, 0.98), (4, 8, 16, 32, 64), 3
#: least step down: standard errors, and part of the next event's drop
STEP, OF_NEXT = 6.0, 0.02


def middles(t, y, peaks, troughs, high, low, level_error, noise):
    """Times (m,) at which stress falls through the middle of two levels (m,), and their errors.

    NaN where a level is unknown.

    peaks, troughs : (m,) samples
    level_error : (m,) standard error of the middle
    """
    found = np.full((2, peaks.size), math.nan)
    for i in np.flatnonzero(np.isfinite(high + low)):
        level, near = 0.5 * (high[i] + low[i]), NEAR * (high[i] - low[i])
        fall = y[peaks[i] : troughs[i] + 1]
        above = np.flatnonzero(fall > level + near)
        first = int(above[-1]) + 1 if above.size else 0
        below = np.flatnonzero(fall[first:] < level - near)
        last = first + int(below[0]) if below.size else fall.size - 1
        crossing = _on_cubic if last - first >= FEWEST else _between_samples
        rows = np.arange(peaks[i] + first, peaks[i] + last + 1)
        found[:, i] = crossing(t, y, rows, level, level_error[i], noise)
    return found


def _between_samples(t, y, rows, level, level_error, noise):
    """Time at which a line between two samples passes the level, and its error.

    A curve with a second difference d is d/8 off the line in the middle of a step.  Where the
    difference at one end of the step is not that at the other, the fall is sharp: it may be
    anywhere in the step where all of it is in there, with differences of -1 and 1 falls.
    """
    below = np.append(y[rows[:-1]] < level, True)
    i = min(max(int(rows[np.argmax(below)]), 2), t.size - 2)
    step, fall = t[i] - t[i - 1], y[i - 1] - y[i]
    if not fall > 0.0:
        return 0.5 * (t[i - 1] + t[i]), step * ANYWHERE
    x, around = t[i - 2 : i + 2], y[i - 2 : i + 2]
    second = np.diff(np.diff(around) / np.diff(x)) * 2.0 / (x[2:] - x[:-2]) * step**2
    bends = np.clip(second / fall, -1.0, 1.0)
    of_line = math.hypot(bends.mean() / 8.0, (0.5 * (bends[1] - bends[0])) ** 2 * ANYWHERE)
    of_noise = min(math.hypot(noise.sd, level_error) / fall, 1.0)
    part = min(max((y[i - 1] - level) / fall, 0.0), 1.0)
    return t[i - 1] + part * step, step * math.hypot(of_line, of_noise)


def _on_cubic(t, y, rows, level, level_error, noise):
    """Time at which the cubic through samples (but the last) passes the level, and its error."""
    x, values = t[rows[:-1]], y[rows[:-1]] - level
    origin, extent = x.mean(), x[-1] - x[0]
    c, covariance = np.polyfit((x - origin) / extent, values, 3, cov="unscaled")
    curve, at = np.poly1d(c), 0.0
    slope = curve.deriv()
    for _ in range(NEWTON):
        if slope(at) < 0.0:
            at = min(max(float(at - curve(at) / slope(at)), -0.5), 0.5)
    row = at ** np.arange(3.0, -1.0, -1.0)
    error = math.hypot(
        noise.sd * math.sqrt(noise.inflation * (row @ covariance @ row)), level_error
    )
    steep = max(-float(slope(at)), error, 1e-300)
    return origin + at * extent, extent * min(error / steep, 1.0)


def with_spikes(t, y, middle, found, sign, noise):
    """Value, error, time, time error (4, m) of extremes, or of the middle of sample and bound.

    The extremes are kept if the bounds exceed them by no more than noise in the mean of all events,
    or if some are unknown.
    """
    y = sign * y
    bounds = [_bound(t, y, int(i), -sign) for i in np.searchsorted(t, middle)]
    sample, bound, time, time_error = np.array(bounds).T
    excess = bound - sign * found[0]
    error = math.sqrt(np.mean((SPREAD * noise.sd) ** 2 + found[1] ** 2) / excess.size)
    if not np.mean(excess) > BY_NOISE * noise.sd + SURE * error:
        return found
    low = np.maximum(sample, sign * found[0])
    beyond = np.maximum(bound - low, 0.0)
    error = np.hypot(np.maximum(beyond, np.sqrt(np.mean(beyond**2))), noise.sd)
    return np.array([sign * (low + 0.5 * beyond), error, time, time_error])


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


def has_several(y, span, noise):
    """Whether stress in a fall slackens and gains speed again: more than one event.

    y : (n,) of the record
    span : samples of the last trough, of the fall's peak and trough, and of the next peak
    """
    last, peak, trough, following = span
    for lag in LAGS:
        if lag > max(OF_FALL * (trough - peak), 1):
            break
        part = y[max(peak - 2 * lag, last) : min(trough + 2 * lag, following) + 1]
        means = uniform_filter1d(part, lag, origin=-(lag // 2))[: part.size - lag + 1]
        fall = means[:-lag] - means[lag:]
        if fall.size <= 2 * lag:
            continue
        before = np.maximum.accumulate(fall)[: -2 * lag]
        after = np.maximum.accumulate(fall[::-1])[::-1][2 * lag :]
        slack = np.minimum(before, after) - fall[lag:-lag]
        sd = noise.sd * math.sqrt(2.0 * min(noise.inflation / lag, 1.0))
        many = fall.size * min(OVERLAP / lag, 1.0)
        by_noise = (2.0 * math.sqrt(2.0 * math.log(many)) + MARGIN) * sd
        if slack.max() > max(by_noise, OF_DROP * (y[peak] - y[trough])):
            return True
    return False


def has_step_down(t, y, drop, noise):
    """Whether stress (n,) falls by a step while it is loaded, beyond noise.

    drop : of the next event [Pa]
    """
    begin, end = (round(part * t.size) for part in LOADING)
    t, y = t[begin:end], y[begin:end]
    if t.size < 2 * SIDES[0]:
        return False
    y = y - np.polynomial.Polynomial.fit(t, y, SMOOTH)(t)
    for side in SIDES:
        if 2 * side > t.size:
            break
        # the step in the middle of samples on a line, by least squares
        line = np.arange(2 * side) - side + 0.5
        kernel = np.linalg.pinv(np.column_stack([line > 0.0, np.ones(2 * side), line]))[0]
        step = np.convolve(y, kernel[::-1], "valid").min()
        error = noise.sd * np.sqrt(noise.inflation * float(kernel @ kernel))
        if -step > max(STEP * error, OF_NEXT * drop):
            return True
    return False
