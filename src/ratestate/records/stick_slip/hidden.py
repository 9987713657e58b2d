"""Events that the samples hide: several in one fall, and small ones in the loading.

D    fall of stress over so many samples
z    a step of stress divided by its standard error
"""

import math

import numpy as np
from scipy.ndimage import uniform_filter1d

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


def has_several(y, span, noise):
    """Whether stress in a fall slackens and gains speed again: more than one event.

    One event falls fastest once.

    y : (n,) of the record
    span : samples of the last trough, of the fall's peak and trough, and of the next peak
    """
    last, peak, trough, following = span
    for lag in LAGS:
        if lag > max(OF_FALL * (trough - peak), 1):
            break
        part = y[max(peak - 2 * lag, last) : min(trough + 2 * lag, following) + 1]
        means = uniform_filter1d(part, lag, origin=-(lag // 2))[: part.size - lag + 1]
        fall = means[:-lag] - means[lag:]  # D
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
    x = 2.0 * (t - t[0]) / (t[-1] - t[0]) - 1.0
    y = y - np.polynomial.Polynomial.fit(x, y, SMOOTH)(x)
    for side in SIDES:
        if 2 * side > t.size:
            break
        kernel = _step_kernel(side)
        step = np.convolve(y, kernel[::-1], "valid").min()
        error = noise.sd * np.sqrt(noise.inflation * float(kernel @ kernel))
        if -step > max(STEP * error, OF_NEXT * drop):
            return True
    return False


def _step_kernel(side):
    """Weights (2 side,) of the step in the middle of samples on a line, by least squares."""
    line = np.arange(2 * side) - side + 0.5
    design = np.column_stack([line > 0.0, np.ones(2 * side), line])
    return np.linalg.pinv(design)[0]
