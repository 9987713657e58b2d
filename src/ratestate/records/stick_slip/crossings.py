"""When the stress of an event falls through the middle of its levels: where it is steep."""

import math

import numpy as np

#: part of the drop on either side of the middle whose samples are fitted; fewest for a cubic
NEAR, FEWEST = 0.25, 6
#: Newton steps to the crossing of a cubic
STEPS = 8
#: standard deviation of a time that may be anywhere in a step, in steps
ANYWHERE = 1.0 / math.sqrt(12.0)


def middles(t, y, peaks, troughs, levels, level_error, noise):
    """(m, 2) times at which stress falls through the middle of its levels (2, m), their errors;
    NaN where a level is unknown.

    peaks, troughs : (m,) samples
    level_error : (m,) standard error of the middle
    """
    rows = []
    for peak, trough, (top, bottom), error in zip(
        peaks, troughs, levels.T, level_error, strict=True
    ):
        level, near = 0.5 * (top + bottom), NEAR * (top - bottom)
        if not math.isfinite(level):
            rows.append((math.nan, math.nan))
            continue
        above = np.flatnonzero(y[peak : trough + 1] > level + near)
        first = peak + (int(above[-1]) + 1 if above.size else 0)
        below = np.flatnonzero(y[first : trough + 1] < level - near)
        last = first + (int(below[0]) if below.size else trough - first)
        crossing = _on_cubic if last - first >= FEWEST else _between_samples
        rows.append(crossing(t, y, first, last, level, error, noise))
    return np.array(rows)


def _between_samples(t, y, first, last, level, level_error, noise):
    """Time at which a line between two samples passes the level, and its error."""
    below = np.append(y[first:last] < level, True)
    i = min(max(first + int(np.argmax(below)), 2), t.size - 2)
    step, fall = t[i] - t[i - 1], y[i - 1] - y[i]
    if not fall > 0.0:
        return 0.5 * (t[i - 1] + t[i]), step * ANYWHERE
    part = min(max((y[i - 1] - level) / fall, 0.0), 1.0)
    of_noise = min(math.hypot(noise.sd, level_error) / fall, 1.0)
    of_line = _error_of_line(t[i - 2 : i + 2], y[i - 2 : i + 2])
    return t[i - 1] + part * step, step * math.hypot(of_line, of_noise)


def _error_of_line(t, y):
    """Error of a line between the middle two of four samples, in steps; stress bends between them.

    A curve with a second difference d is d/8 off the line in the middle of a step.  Where the
    difference at one end of the step is not that at the other, the fall is sharp: it may be
    anywhere in the step where all of it is in there, with differences of -1 and 1 falls.
    """
    step, fall = t[2] - t[1], y[1] - y[2]
    second = np.diff(np.diff(y) / np.diff(t)) * 2.0 / (t[2:] - t[:-2]) * step**2
    bends = np.clip(second / fall, -1.0, 1.0)
    sharp = 0.5 * float(bends[1] - bends[0])
    return math.hypot(float(bends.mean()) / 8.0, sharp**2 * ANYWHERE)


def _on_cubic(t, y, first, last, level, level_error, noise):
    """Time at which the cubic through samples first..last-1 passes the level, and its error."""
    origin, extent = t[first:last].mean(), t[last - 1] - t[first]
    u = (t[first:last] - origin) / extent
    q, r = np.linalg.qr(np.vander(u, 4, increasing=True))
    inverse = np.linalg.inv(r)
    cubic = np.polynomial.Polynomial(inverse @ (q.T @ (y[first:last] - level)))
    slope, at = cubic.deriv(), 0.0
    for _ in range(STEPS):
        if not slope(at) < 0.0:
            break
        at = min(max(at - float(cubic(at) / slope(at)), -0.5), 0.5)
    row = at ** np.arange(4.0) @ inverse
    error = math.hypot(noise.sd * math.sqrt(noise.inflation * float(row @ row)), level_error)
    return origin + at * extent, extent * min(error / max(-float(slope(at)), error, 1e-300), 1.0)
