"""An extreme of a noisy series, or of its slope: value, time and their standard errors.

The largest of many noisy samples is too large.  So a polynomial is fitted to a window around the
extreme, which the fall of the stress may bound closely on one side.  All events at one load-point
velocity share the window, counted from the middles of their falls: the widest in which a polynomial
of the lowest degree with an extreme is not contradicted by one two degrees higher, in value and
slope.  The latter's value is then taken, at the place that the former gives: a bias that cannot be
seen in the lower degree is far below the error of the higher one.  (Lepskii 1991,
doi:10.1137/1135065, chooses windows by such comparisons.)

At its own vertex a fitted polynomial is too extreme by var(slope)/(2 |curvature|), which is
subtracted.  Where the window has no vertex, as after a fall that ends at once, the extreme lies
where samples begin to leave the polynomial for the fall.

    k    order of the derivative whose extreme is sought: 0 of the stress, 1 of its slope
    u    time from the window's origin over its extent
    c    coefficients of a polynomial, from the constant on, C their covariance
"""

import math
from typing import NamedTuple

import numpy as np

#: events from which a window is chosen, at most
MOST = 16
#: standard errors of the mean difference between both degrees that do not contradict
AGREE = 1.5
#: standard deviations of a sample from a polynomial that it has left
LEFT = 4.0
#: samples from a window in which it must be left
BEYOND = 4
#: standard deviations of the sum of squares that a window may have too much
ROUGH = 4.0
#: samples in a window of which means are taken from twice as many on
PLENTY = 300
#: error at a vertex over that at an edge, up to which the vertex is preferred
PREFERRED = 3.0
#: excess of what cannot be
NEVER = 1e6
#: degree over that with an extreme
MORE = 2


class Noise(NamedTuple):
    """White or first-order correlated noise: standard deviation, and what it does to a mean."""

    sd: float
    correlation: float = 0.0  # of neighbouring samples

    @property
    def inflation(self):
        """Variance of a mean over that with white noise."""
        return (1.0 + self.correlation) / (1.0 - self.correlation)


class Window(NamedTuple):
    """A window from two times after the middle of a fall, and which side of it is the fall."""

    start: float  # [s]
    end: float  # [s]
    fall: int  # -1: the fall is before the window, +1: after it, 0: the window is in the fall


class Extreme(NamedTuple):
    """The extreme of a series, or its slope, in a window."""

    time: float
    value: float
    error: float
    time_error: float
    difference: float  # of the degrees; nan where there are too few samples
    variance: float  # of that
    turn: float  # difference of the degrees' slopes there, and its variance
    turn_variance: float
    inside: float  # 1.0 for a vertex in the window, 0.0 for its edge
    excess: float  # sum of squares over its expectation, in standard deviations


NOTHING = Extreme(*[math.nan] * len(Extreme._fields))


def chosen_window(t, y, middles, windows, k, sign, noise):
    """The `Window` among these in which an extreme is least uncertain and not contradicted.

    One in which most events have a vertex is preferred.  Where all are contradicted, the one that
    is so least; None where none has samples enough.
    """
    some = middles[:: math.ceil(middles.size / MOST)]
    best: list = [(math.inf, None), (math.inf, None)]  # at an edge, at a vertex
    least = (math.inf, None)
    for window in windows:
        found = [extreme(t, y, middle, window, k, sign, noise) for middle in some]
        found = [one for one in found if math.isfinite(one.value)]
        if len(found) < 0.8 * len(some):
            continue
        column = dict(zip(Extreme._fields, np.array(found).T, strict=True))
        against = _contradiction(column)
        least = min(least, (against, window))
        if against <= 1.0:
            inside = int(column["inside"].mean() > 0.5)
            error = math.sqrt(float(np.mean(column["error"] ** 2)))
            best[inside] = min(best[inside], (error, window))
    edge, vertex = best
    chosen = vertex if vertex[0] <= PREFERRED * edge[0] and vertex[1] else edge
    return chosen[1] or least[1]


def _contradiction(column):
    """How far the degrees are apart, and samples from them, over what is allowed.

    column : field of `Extreme` -> (events,) numbers
    """
    excess = column["excess"]
    parts = [excess.sum() / ROUGH / math.sqrt(excess.size)]
    for off, variance in (("difference", "variance"), ("turn", "turn_variance")):
        spread = math.sqrt(max(column[variance].sum(), 1e-300))
        parts.append(abs(column[off].sum()) / AGREE / spread)
    return float(max(parts))


def extremes(t, y, middles, window, k, sign, noise):
    """list of `Extreme` of all events in one window.

    Where most have a vertex, those that noise leaves without one are taken where the others are.
    """
    found = [extreme(t, y, middle, window, k, sign, noise) for middle in middles]
    inside = np.array([one.inside == 1.0 for one in found])
    if not 0.5 < inside.mean() < 1.0:
        return found
    after = np.array([one.time for one in found])[inside] - middles[inside]
    place = float(np.median(after)), float(after.std())
    for i in np.flatnonzero(~inside):
        found[i] = extreme(t, y, middles[i], window, k, sign, noise, place)
    return found


def extreme(t, y, middle, window, k, sign, noise, place=None):
    """The `Extreme` of the k-th derivative, of sign +1 a maximum, in a window after `middle`.

    place : time after `middle`, and its error, of an extreme without a vertex
    """
    first, last = np.searchsorted(t, (middle + window.start, middle + window.end))
    low, high = k + 2, k + 2 + MORE
    if last - first < high + 1:
        return NOTHING
    origin, scale, level = 0.5 * (t[first] + t[last - 1]), t[last - 1] - t[first], y[first]
    means, values, variance = _means(t[first:last], y[first:last] - level, noise)
    (c, C), (c_high, C_high), squares = _fits((means - origin) / scale, values, low, high)
    curve = np.array([math.perm(k + j, k) * c[k + j] for j in range(3)])
    ends = (t[first] - origin) / scale, (t[last - 1] - origin) / scale
    at, bias, spread = _vertex(curve, C, k, sign, variance, ends)
    edge, inside, left = 0.0, at is not None, True
    if not inside and place:
        at, spread = (middle + place[0] - origin) / scale, place[1] / scale
    elif not inside:
        here = (t, y, first, last, origin, scale, level)
        at, step, left = _edge(here, c, window.fall, curve, sign, noise)
        slope = abs(curve[1] + 2.0 * curve[2] * at)
        edge, spread, bias = slope * step / math.sqrt(12.0), step / math.sqrt(12.0), 0.0
    value, of_high, difference, more = _compared(_row(at, high, k), c, C, c_high, C_high)
    _, _, turn, turn_more = _compared(_row(at, high, k + 1), c, C, c_high, C_high)
    degrees = max(means.size - high - 1, 1)
    excess = (squares / variance - degrees) / math.sqrt(2.0 * degrees)
    per = scale**k
    return Extreme(
        time=origin + scale * at,
        value=(value - sign * bias) / per + (level if k == 0 else 0.0),
        error=math.sqrt(variance * of_high + 2.0 * bias**2 + edge**2) / per,
        time_error=scale * spread,
        difference=difference / per,
        variance=variance * more / per**2,
        turn=turn,
        turn_variance=variance * turn_more,
        inside=float(inside),
        excess=min(excess, NEVER) if left else NEVER,
    )


def _compared(row, c, C, c_high, C_high):
    """A linear form of the higher degree, its variance; what it is off the lower, and variance."""
    n = c.size
    of_high, of_low = row @ C_high @ row, row[:n] @ C @ row[:n]
    value = row @ c_high
    return value, of_high, value - row[:n] @ c, max(of_high - of_low, 0.0)


def _means(t, y, noise):
    """Times and values of a window, means of some where it has many; variance of one."""
    block = t.size // PLENTY
    variance = max(noise.sd, 1e-300) ** 2 * noise.inflation
    if block < 2:
        return t, y, variance
    rows = t.size // block * block
    return (*(x[:rows].reshape(-1, block).mean(axis=1) for x in (t, y)), variance / block)


def _fits(u, y, low, high):
    """Least squares in both degrees: (coefficients, covariance for unit variance); squares."""
    q, r = np.linalg.qr(np.vander(u, high + 1, increasing=True))
    projected = q.T @ y
    fits = []
    for size in (low + 1, high + 1):
        inverse = np.linalg.inv(r[:size, :size])
        fits.append((inverse @ projected[:size], inverse @ inverse.T))
    rest = y - q @ projected
    return *fits, float(rest @ rest)


def _vertex(curve, C, k, sign, variance, ends):
    """Where a quadratic has its extreme, how much too extreme it is there, and the place's error.

    (None, 0, 0) where it has none between these ends.
    """
    if not sign * curve[2] < 0.0:
        return None, 0.0, 0.0
    at = -0.5 * curve[1] / curve[2]
    if not ends[0] <= at <= ends[1]:
        return None, 0.0, 0.0
    row = _row(at, C.shape[0] - 1, k + 1)
    slope = variance * float(row @ C @ row)
    curvature = 2.0 * abs(curve[2])
    return at, 0.5 * slope / curvature, math.sqrt(slope) / curvature


def _edge(here, c, fall, curve, sign, noise):
    """Where, on the side of the fall, samples leave a polynomial; the sample's length; whether.

    Within `BEYOND` samples from the window: else it is none that the fall bounds, and its end is
    taken.
    """
    t, y, first, last, origin, scale, level = here
    if fall == 0:
        ends = (t[[first, last - 1]] - origin) / scale
        values = sign * np.polyval(curve[::-1], ends)
        return float(ends[int(np.argmax(values))]), 0.0, True
    end = last - 1 if fall > 0 else first
    for i in range(end, end + fall * BEYOND, fall):
        if not 0 <= i + fall < t.size:
            break
        u, step = (t[i + fall] - origin) / scale, abs(t[i + fall] - t[i]) / scale
        if abs(y[i + fall] - level - np.polyval(c[::-1], u)) > LEFT * noise.sd:
            return float((t[i] - origin) / scale + 0.5 * fall * step), step, True
    return float((t[end] - origin) / scale), 0.0, False


def _row(u, degree, k):
    """The k-th derivatives of 1, u, u^2, ... at u."""
    return np.array([math.perm(j, k) * u ** (j - k) if j >= k else 0.0 for j in range(degree + 1)])
