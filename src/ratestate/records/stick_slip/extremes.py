"""Extremes of a noisy series, or of its slope: values, times and their standard errors.

The largest of many noisy samples is too large.  So polynomials are fitted by least squares to a
window beside the fall of each event, or within it: one of the lowest degree with an extreme, whose
vertex is the place, and one two degrees higher, whose value is taken there.  If noise hides the
vertex of one event, the vertex of the mean polynomial of all events is the place.

If that is hidden too, the extreme is at the edge of the loading, next to the fall.  Samples have
begun to leave the polynomial before noise lets one see it: the departure grows as the square of the
time from the extreme, where the fall begins or ends with a finite acceleration, so that it takes as
long to pass from nothing to `LEFT` standard deviations as from there to four times as many.  If
noise hides the fall in one event, the mean departure of all events shows it.

All events at one load-point velocity share a window, counted from the middles of their falls: the
one with the least error in which the lower polynomial is not contradicted by the higher one, in
value and slope.  (Lepskii 1991, doi:10.1137/1135065, chooses windows by such comparisons.)

    k    order of the derivative whose extreme is sought: 0 of the stress, 1 of its slope
    u    time from the window's middle divided by its extent
    c    coefficients (m, size) of polynomials of m events, from the constant on
    C    their covariances (m, size, size)
"""

import math
from typing import NamedTuple

import numpy as np

#: samples in a window of which means are taken from twice as many on
PLENTY = 300
#: degrees over that with an extreme
MORE = 2
#: least variance of a sample [Pa^2], so that what has no noise can be divided by it
TINY = 1e-300
#: excess of a window without a vertex that the fall does not bound: the last to be chosen
UNBOUNDED = 1e6
#: standard errors of a vertex that it must be from the fall, so that noise does not make it, nor
#: a value at the vertex that is too extreme by more than a tenth of its error
SEEN = 6.0
#: largest shift of a vertex, in u
FARTHEST = 0.5
#: standard deviations of a sample from a polynomial that it has left
LEFT = 4.0
#: samples from a window in which it must be left: else the fall does not bound it
BEYOND = 4
#: events from which a window is chosen, at most; part of them that must have samples enough
MOST, ENOUGH = 16, 0.8
#: standard errors of the mean difference between both degrees that do not contradict
AGREE = 1.5
#: standard deviations of the sum of squares that a window may have too much
ROUGH = 4.0
#: power of the contradiction by which an error must be smaller
PRICE = 4


class Window(NamedTuple):
    """A window from two times after the middle of a fall, and which side of it is the fall."""

    start: float  # [s]
    end: float  # [s]
    fall: int  # -1: the fall is before the window, +1: after it, 0: the window is in the fall


class Extremes(NamedTuple):
    """The extremes (m,) of a series, or of its slope, in a window; NaN with too few samples."""

    time: np.ndarray
    value: np.ndarray
    error: np.ndarray
    time_error: np.ndarray
    difference: np.ndarray  # of the values of both degrees
    contradiction: float  # how far the degrees are apart, and samples from them, over the allowed

    @property
    def biased_error(self):
        """(m,) errors of the values, with the mean difference of the degrees, which all share."""
        known = self.difference[np.isfinite(self.difference)]
        return np.hypot(self.error, abs(known.mean()) if known.size else math.nan)


def chosen_window(t, y, middles, windows, k, sign, noise):
    """The `Window` among these in which extremes are least uncertain and not contradicted.

    The more the degrees contradict each other, the smaller the error must be in return.  None if no
    window has samples enough.
    """
    some = middles[:: math.ceil(middles.size / MOST)]
    choices: list[tuple[float, Window]] = []
    for window in windows:
        found = extremes(t, y, some, window, k, sign, noise)
        if np.isfinite(found.value).mean() >= ENOUGH:
            error = math.sqrt(float(np.nanmean(found.error**2)))
            choices.append((error * max(found.contradiction, 1.0) ** PRICE, window))
    return min(choices, default=(0.0, None))[1]


def extremes(t, y, middles, window, k, sign, noise):
    """The `Extremes` of the k-th derivative, of sign +1 maxima, in a window after each middle."""
    found = np.full((5, len(middles)), math.nan)
    firsts, lasts = np.searchsorted(t, middles + np.array([[window.start], [window.end]]))
    use = np.flatnonzero(lasts - firsts >= k + MORE + 4)
    if not use.size:
        return Extremes._make((*found, math.inf))
    span = firsts[use], lasts[use], np.searchsorted(t, middles[use])
    extent = window.end - window.start
    scales = middles[use] + 0.5 * (window.start + window.end), extent, y[span[0]]
    (c, C), high, excess = _fits(t, y, span, scales, k, noise)
    ends = (t[[span[0], span[1] - 1]] - scales[0]) / extent
    vertices, bounded = _vertices(c, C, k, sign, ends, window.fall), np.ones(use.size, bool)
    if vertices is None:
        u, u_error, bounded = edges((t, y), span, scales, c, window.fall, sign, noise.sd)
    else:
        u, u_error = vertices
    (value, variance), (difference, more) = _compared((c, C), high, u, k)
    _, (turn, turn_variance) = _compared((c, C), high, u, k + 1)
    time = scales[0] + extent * u
    if vertices is None:  # the extreme is anywhere where the curve is as extreme as can be told
        slope = np.abs((_derivatives(u, k + 3, k + 1) * c).sum(axis=1))
        blurred = np.minimum(np.sqrt(variance / 3.0) / (slope + TINY), 1.0)
        variance = variance + (slope * u_error) ** 2
        u_error = np.hypot(u_error, blurred)
    else:  # the mean slope of the higher degree at the vertices moves them
        mean, by_noise = float(turn.mean()), float(turn_variance.mean()) / use.size
        bend = abs(math.factorial(k + 2) * float(c[:, k + 2].mean()))
        shift = sign * float(np.clip(mean / bend, -FARTHEST, FARTHEST))
        u_error = np.hypot(u_error, math.hypot(math.sqrt(by_noise) / bend, 0.5 * shift))
        value = value + sign * 0.5 * max(mean**2 - by_noise, 0.0) / bend
        time = time + shift * extent
    value = value / extent**k + (scales[2] if k == 0 else 0.0)
    error = np.sqrt(variance) / extent**k
    found[:, use] = time, value, error, extent * u_error, difference / extent**k
    parts = [np.where(bounded, excess, UNBOUNDED).sum() / ROUGH / math.sqrt(use.size)]
    for off, its_variance in ((difference, more), (turn, turn_variance)):
        parts.append(abs(off.sum()) / AGREE / math.sqrt(max(its_variance.sum(), TINY)))
    return Extremes._make((*found, float(max(parts))))


def _compared(low, high, u, k):
    """k-th derivative of the higher degree at u, and its difference from the lower; variances."""
    (c, C), (c_high, C_high) = low, high
    row, n = _derivatives(u, c_high.shape[1], k), c.shape[1]
    value, variance = (row * c_high).sum(axis=1), _quadratic(row, C_high)
    lower, less = (row[:, :n] * c).sum(axis=1), _quadratic(row[:, :n], C)
    return (value, variance), (value - lower, np.maximum(variance - less, 0.0))


def _fits(t, y, span, scales, k, noise):
    """c, C of both degrees by least squares of samples (or means of some) in windows.

    And (m,) sums of squares less what is expected, in standard deviations.

    span, scales : as of `edges`
    """
    (first, last, _), (centre, extent, level) = span, scales
    sizes = last - first
    block = max(int(sizes.max()) // PLENTY, 1)
    sizes = sizes // block
    rows = first[:, None, None] + np.arange(sizes.max() * block).reshape(1, -1, block)
    rows = np.minimum(rows, t.size - 1)
    inside = np.arange(sizes.max()) < sizes[:, None]
    variance = max(noise.sd**2, TINY) * noise.inflation / block
    u = (t[rows].mean(axis=2) - centre[:, None]) / extent
    values = y[rows].mean(axis=2) - level[:, None]
    size = k + MORE + 3
    q, r = np.linalg.qr(u[..., None] ** np.arange(size) * inside[..., None])
    projected = np.einsum("mni,mn->mi", q, values)
    both = []
    for n in (size - MORE, size):
        inverse = np.linalg.inv(r[:, :n, :n])
        c = np.einsum("mij,mj->mi", inverse, projected[:, :n])
        both.append((c, variance * (inverse @ inverse.transpose(0, 2, 1))))
    rest = (values - np.einsum("mni,mi->mn", q, projected)) * inside
    degrees = np.maximum(sizes - size, 1)
    return *both, ((rest**2).sum(axis=1) / variance - degrees) / np.sqrt(2.0 * degrees)


def _vertices(c, C, k, sign, ends, fall):
    """Places (m,) of the vertices of polynomials, in u, and their errors.

    None if noise hides the vertex of the mean polynomial too, or if it is outside the window.

    ends : (2, m) of the windows, in u
    """

    def seen(c, C, ends):
        """u, its error, and whether it is in the window, and beyond noise from the fall's side."""
        bend = math.factorial(k + 2) * c[:, k + 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            u = -math.factorial(k + 1) * c[:, k + 1] / bend
        inside = (sign * bend < 0.0) & (ends[0] <= u) & (u <= ends[1])
        u, bend = np.where(inside, u, 0.0), np.where(inside, np.abs(bend), math.inf)
        error = np.sqrt(_quadratic(_derivatives(u, c.shape[1], k + 1), C)) / bend
        sides = np.abs(u - ends)[{-1: [0], 1: [1], 0: [0, 1]}[fall]]
        return u, error, inside & (SEEN * error < sides.min(axis=0))

    whole = np.array([[ends[0].min()], [ends[1].max()]])
    mean = c.mean(axis=0, keepdims=True), C.mean(axis=0, keepdims=True) / len(c)
    (place,), (mean_error,), (is_seen,) = seen(*mean, whole)
    if not is_seen:
        return None
    u, errors, known = seen(c, C, ends)
    known &= known.mean() > 0.5
    spread = float(np.std(u[known])) if known.any() else 0.0
    return np.where(known, u, place), np.where(known, errors, math.hypot(mean_error, spread))


def edges(samples, span, scales, c, fall, sign, sd):
    """Places (m,) of the extremes of polynomials on the side of the fall, in u; their errors.

    And (m,) whether the fall bounds them.

    c : (m, size) of the polynomials
    samples : t and y, (n,) each, of the whole record
    span : (m,) first samples of the windows, those after their last, those after middles of falls
    scales : times (m,) at which u = 0, time in which it grows by 1, and (m,) stress at which c = 0
    """
    (t, y), (first, last, middle), (centre, extent, level) = samples, span, scales
    event = np.arange(len(c))
    if fall == 0:  # the steeper of both ends
        u = (t[np.stack([first, last - 1], axis=1)] - centre[:, None]) / extent
        slopes = [(_derivatives(side, c.shape[1], 1) * c).sum(axis=1) for side in u.T]
        best = u[event, np.argmax(sign * np.array(slopes), axis=0)]
        return best, np.zeros(len(c)), np.ones(len(c), bool)
    end = last - 1 if fall > 0 else first
    steps = np.maximum(fall * (middle - end) + (fall < 0), 1)
    index = np.arange(int(steps.max()) + 1)  # (from the window's last sample on)
    rows = end[:, None] + fall * index
    inside = (rows >= 0) & (rows < t.size) & (index <= steps[:, None])
    rows = np.clip(rows, 0, t.size - 1)
    u = (t[rows] - centre[:, None]) / extent
    curve = (u[..., None] ** np.arange(c.shape[1]) * c[:, None]).sum(-1)
    off = np.where(inside & (index > 0), y[rows] - level[:, None] - curve, 0.0)

    def leaves(off, sd):
        """Samples from the window at which it is left, 0 for none near it, and at which by far."""
        near = (off > LEFT * sd) & inside & (index <= BEYOND)
        left = near.argmax(axis=1)  # (0 if there is none)
        far = (off > 4.0 * LEFT * sd) & inside & (index >= left[:, None])
        return left, np.where(far.any(axis=1), far.argmax(axis=1), inside.sum(axis=1) - 1)

    count = np.maximum(inside.sum(axis=0), 1)
    own = leaves(np.abs(off), sd)
    shared = leaves(np.abs(off.sum(axis=0) / count), sd / np.sqrt(count))
    left, far = (np.where(own[0] > 0, a, b) for a, b in zip(own, shared, strict=True))
    bounded = left > 0
    step = np.abs(u[event, left] - u[event, np.maximum(left - 1, 0)])
    delay = np.abs(u[event, far] - u[event, left])
    # a time between two samples is known to sqrt(1/12) of a step, the delay to sqrt(2/12); if
    # nothing is seen to leave a window, the extreme is at its end, or up to the fall's middle
    place = np.where(bounded, u[event, left] - fall * (0.5 * step + delay), u[:, 0])
    return place, np.where(bounded, np.hypot(0.5 * step, 0.5 * delay), 0.5 * delay), bounded


def _quadratic(row, C):
    return np.einsum("mi,mij,mj->m", row, C, row)


def _derivatives(u, size, k):
    """The k-th derivatives of 1, u, u^2, ... at u (m,): (m, size)."""
    powers = np.arange(size)
    factors = np.array([math.perm(j, k) for j in powers], float)
    return factors * u[:, None] ** np.maximum(powers - k, 0)
