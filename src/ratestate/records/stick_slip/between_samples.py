"""Times of falls and peaks between samples, and events that samples merge or hide.

A fall is several events if it slows down and speeds up again: a single event has one fastest fall.

A peak or trough next to a fast fall may last less than a step between samples.  Its bound is the
point at which the line through the samples outside the fall meets the line through the fall.
Stress may bend within the step.  So the distance from the sample to the bound, or its mean over
all events if that is larger, is also the standard error.
"""

import math

import numpy as np
import scipy

#: fraction of the drop above and below the middle that is fitted; fewest samples for a cubic
FITTED_PART, FEWEST = 0.25, 6
#: Newton steps to the crossing of a cubic
NEWTON = 8
#: standard deviation of a time that is uniformly distributed within a step, in steps
UNIFORM_SD = 1.0 / math.sqrt(12.0)
#: mean and standard deviation by which bounds exceed extremes in noise, as multiples of the noise;
#: standard errors of the mean excess beyond which noise does not explain it
BY_NOISE, SPREAD, SIGNIFICANCE = 1.7, 2.0, 4.0
#: numbers of samples over which rates of fall are compared; the largest, as a fraction of a fall
LAGS, OF_FALL = (1, 2, 4, 8, 16, 32), 0.25
#: least slowing between two falls: standard deviations beyond the range of noise; fraction of drop
MARGIN, OF_DROP = 1.5, 0.15
#: number of independent rates of fall, as a multiple of samples divided by the lag
OVERLAP = 4.0
#: part of a loading phase, as fractions of its samples, that is searched for steps; numbers of
#: samples on either side of a step; degree of the polynomial that is subtracted first
LOADING, SIDES, SMOOTH = (0.02, 0.98), (4, 8, 16, 32, 64), 3
#: least step down: in standard errors, and as a fraction of the next event's drop
STEP, OF_NEXT = 6.0, 0.02


def middles(t, y, peaks, troughs, high, low, level_error, noise):
    """Return when stress falls through the middle of two levels, and its standard error (2, m).

    peaks, troughs : (m,) samples
    high, low, level_error : (m,) levels, or NaN, and the standard error of their middle
    """
    crossings = np.full((2, peaks.size), math.nan)
    for i in np.flatnonzero(np.isfinite(high + low)):
        level, margin = 0.5 * (high[i] + low[i]), FITTED_PART * (high[i] - low[i])
        fall = y[peaks[i] : troughs[i] + 1]
        above = np.flatnonzero(fall[:-1] > level + margin)  # (noise may raise the last sample)
        first = int(above[-1]) + 1 if above.size else 0
        below = np.flatnonzero(fall[first:] < level - margin)
        last = first + int(below[0]) if below.size else fall.size - 1
        crossing = _on_cubic if last - first >= FEWEST else _between_samples
        rows = np.arange(peaks[i] + first, peaks[i] + last + 1)
        crossings[:, i] = crossing(t, y, rows, level, level_error[i], noise)
    return crossings


def _between_samples(t, y, rows, level, level_error, noise):
    """Return when the line between two samples crosses the level, and its standard error.

    A curve with a second difference d deviates from the line by d/8 in the middle of a step.  If
    the second differences at the two ends of the step differ, the fall is sharp.  If they are -1
    and 1 falls, the whole fall lies within the step and may be anywhere in it.
    """
    below = np.append(y[rows[:-1]] < level, True)
    i = min(max(int(rows[np.argmax(below)]), 2), t.size - 2)
    step, fall = t[i] - t[i - 1], y[i - 1] - y[i]
    if not fall > 0.0:
        return 0.5 * (t[i - 1] + t[i]), step * UNIFORM_SD
    x, samples = t[i - 2 : i + 2], y[i - 2 : i + 2]
    second = np.diff(np.diff(samples) / np.diff(x)) * 2.0 / (x[2:] - x[:-2]) * step**2
    bends = np.clip(second / fall, -1.0, 1.0)
    bend_error = math.hypot(bends.mean() / 8.0, (0.5 * (bends[1] - bends[0])) ** 2 * UNIFORM_SD)
    noise_error = min(math.hypot(noise.sd, level_error) / fall, 1.0)
    part = min(max((y[i - 1] - level) / fall, 0.0), 1.0)
    return t[i - 1] + part * step, step * math.hypot(bend_error, noise_error)


def _on_cubic(t, y, rows, level, level_error, noise):
    """Return when a cubic fitted to all rows but the last crosses the level, and its error."""
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


def corrected_for_spikes(t, y, middle, found, sign, noise):
    """Return value, error, time and time error (4, m) of extremes that may be between samples.

    If the bounds exceed the extremes by more than noise explains, on the mean of all events, the
    extremes are placed halfway between sample and bound.  Otherwise `found` is returned.

    middle : (m,) times of the middles of falls
    found : (4, m) the same quantities without this correction
    """
    y = sign * y
    bounds = [_bound(t, y, int(i), -sign) for i in np.searchsorted(t, middle)]
    sample, bound, time, time_error = np.array(bounds).T
    excess = bound - sign * found[0]
    error = math.sqrt(np.mean((SPREAD * noise.sd) ** 2 + found[1] ** 2) / excess.size)
    if not np.mean(excess) > BY_NOISE * noise.sd + SIGNIFICANCE * error:
        return found
    low = np.maximum(sample, sign * found[0])
    beyond = np.maximum(bound - low, 0.0)
    error = np.hypot(np.maximum(beyond, np.sqrt(np.mean(beyond**2))), noise.sd)
    return np.array([sign * (low + 0.5 * beyond), error, time, time_error])


def _bound(t, y, middle, direction):
    """Return the largest sample next to a fall, a bound of nearby maxima, time and its error.

    y : (n,) stress, with the sign for which the extreme is a maximum
    middle : first sample after the middle of the fall
    direction : -1 if the maximum is before the fall, 1 if it is after
    """
    i = middle - (direction < 0)
    while 1 < i + direction < t.size - 2 and y[i + direction] > y[i]:
        i += direction
    if not 2 <= i <= t.size - 3:
        return y[i], -math.inf, t[i], 0.0
    bounds = [_crossing(t, y, i - direction, direction), _crossing(t, y, i, direction)]
    return y[i], max(bounds), t[i], 0.5 * (t[i + 1] - t[i - 1])


def _crossing(t, y, i, direction):
    """Return the value at which the lines on both sides of a step meet, or a bound of it."""
    j = i + direction
    near_slope = (y[i] - y[i - direction]) / (t[i] - t[i - direction])
    far_slope = (y[j + direction] - y[j]) / (t[j + direction] - t[j])
    start = y[j] + far_slope * (t[i] - t[j])  # the far line at sample i
    delay = (start - y[i]) / (near_slope - far_slope) if near_slope != far_slope else math.inf
    return y[i] + near_slope * delay if 0.0 <= delay / (t[j] - t[i]) <= 1.0 else max(start, y[j])


def has_several(y, span, noise):
    """Return whether stress in a fall slows down and speeds up again: more than one event.

    y : (n,) stress of the record
    span : samples of the last trough, of the fall's peak and trough, and of the next peak
    """
    last, peak, trough, following = span
    for lag in LAGS:
        if lag > max(OF_FALL * (trough - peak), 1):
            break
        part = y[max(peak - 2 * lag, last) : min(trough + 2 * lag, following) + 1]
        means = scipy.ndimage.uniform_filter1d(part, lag, origin=-(lag // 2))[: part.size - lag + 1]
        fall = means[:-lag] - means[lag:]
        if fall.size <= 2 * lag:
            continue
        before = np.maximum.accumulate(fall)[: -2 * lag]
        after = np.maximum.accumulate(fall[::-1])[::-1][2 * lag :]
        slack = np.minimum(before, after) - fall[lag:-lag]
        sd = noise.sd * math.sqrt(2.0 * min(noise.inflation / lag, 1.0))
        count = fall.size * min(OVERLAP / lag, 1.0)
        noise_limit = (2.0 * math.sqrt(2.0 * math.log(count)) + MARGIN) * sd
        if slack.max() > max(noise_limit, OF_DROP * (y[peak] - y[trough])):
            return True
    return False


def has_step_down(t, y, drop, noise):
    """Return whether stress (n,) steps down during loading, by more than noise explains.

    drop : stress drop of the next event [Pa]
    """
    begin, end = (round(part * t.size) for part in LOADING)
    t, y = t[begin:end], y[begin:end]
    if t.size < 2 * SIDES[0]:
        return False
    y = y - np.polynomial.Polynomial.fit(t, y, SMOOTH)(t)
    for side in SIDES:
        if 2 * side > t.size:
            break
        # the kernel gives the least-squares step in the middle of samples on a line
        line = np.arange(2 * side) - side + 0.5
        kernel = np.linalg.pinv(np.column_stack([line > 0.0, np.ones(2 * side), line]))[0]
        step = np.convolve(y, kernel[::-1], "valid").min()
        error = noise.sd * np.sqrt(noise.inflation * float(kernel @ kernel))
        if -step > max(STEP * error, OF_NEXT * drop):
            return True
    return False
