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
    C    their covariances (m, size, size) for unit variance of a sample
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
#: largest shift of a vertex, and largest place of one, in u
FARTHEST, OUTSIDE = 0.5, 1e3
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
    variance: np.ndarray  # of the difference
    turn: np.ndarray  # difference of the slopes of both degrees, over u
    turn_variance: np.ndarray
    excess: np.ndarray  # sum of squares over its expectation, in standard deviations

    @property
    def biased_error(self):
        """(m,) errors of the values, with the mean difference of the degrees, which all share."""
        known = self.difference[np.isfinite(self.difference)]
        return np.hypot(self.error, abs(known.mean()) if known.size else math.nan)

    @property
    def contradiction(self):
        """How far the degrees are apart, and samples from them, over what is allowed."""
        excess = self.excess[np.isfinite(self.excess)]
        parts = [excess.sum() / ROUGH / math.sqrt(excess.size)]
        pairs = (self.difference, self.variance), (self.turn, self.turn_variance)
        for off, variance in pairs:
            spread = math.sqrt(max(np.nansum(variance), TINY))
            parts.append(abs(np.nansum(off)) / AGREE / spread)
        return float(max(parts))


class _Fits(NamedTuple):
    """Polynomials of both degrees in one window of m events."""

    low: tuple  # c, C
    high: tuple
    variance: float  # of a sample
    excess: np.ndarray  # (m,)

    def compared(self, u, k):
        """k-th derivative at u of the higher degree, and its excess over the lower, with variances.

        Variances are for unit variance of the samples.
        """
        (c, C), (c_high, C_high) = self.low, self.high
        row, n = _derivatives(u, c_high.shape[1], k), c.shape[1]
        value, variance = (row * c_high).sum(axis=1), _quadratic(row, C_high)
        lower, less = (row[:, :n] * c).sum(axis=1), _quadratic(row[:, :n], C)
        return value, variance, value - lower, np.maximum(variance - less, 0.0)


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
    found = Extremes(*np.full((len(Extremes._fields), len(middles)), math.nan))
    spans = np.searchsorted(t, middles + np.array([[window.start], [window.end]]))
    use = np.flatnonzero(spans[1] - spans[0] >= k + MORE + 4)
    if not use.size:
        return found
    spans, middle, extent = spans[:, use], middles[use], window.end - window.start
    centre, level = middle + 0.5 * (window.start + window.end), y[spans[0, :]]
    fits = _fits(t, y, spans, (centre, extent, level), k, noise)
    ends = (t[[spans[0], spans[1] - 1]] - centre) / extent
    vertices = _vertices(fits, k, sign, ends, window.fall)
    if vertices is None:
        span = (*spans, np.searchsorted(t, middle))
        scales = centre, extent, level
        u, error, bounded = edges((t, y), span, scales, fits.low[0], window.fall, sign, noise.sd)
    else:
        (u, error), bounded = vertices, np.ones(use.size, bool)
    value, variances, difference, more = fits.compared(u, k)
    _, _, turn, turn_more = fits.compared(u, k + 1)
    off = np.zeros(use.size)
    if vertices is None:  # the extreme is anywhere where the curve is as extreme as can be told
        slope = np.abs((_derivatives(u, k + 3, k + 1) * fits.low[0]).sum(axis=1))
        blurred = np.sqrt(fits.variance * variances / 3.0) / np.maximum(slope, TINY)
        error, off = np.hypot(error, np.minimum(blurred, 1.0)), slope * error
    per = extent**k
    columns = Extremes(
        time=centre + extent * u,
        value=value / per + (level if k == 0 else 0.0),
        error=np.sqrt(fits.variance * variances + off**2) / per,
        time_error=extent * error,
        difference=difference / per,
        variance=fits.variance * more / per**2,
        turn=turn,
        turn_variance=fits.variance * turn_more,
        excess=np.where(bounded, np.minimum(fits.excess, UNBOUNDED), UNBOUNDED),
    )
    if vertices is not None:
        columns = _moved(columns, fits, k, sign, extent)
    for column, part in zip(found, columns, strict=True):
        column[use] = part
    return found


def _fits(t, y, spans, scales, k, noise):
    """The `_Fits` by least squares of samples (or means of some) in windows.

    spans : (2, m) first samples of the windows, and those after their last
    scales : as of `edges`
    """
    centre, extent, level = scales
    sizes = spans[1] - spans[0]
    block = max(int(sizes.max()) // PLENTY, 1)
    sizes = sizes // block
    rows = spans[0][:, None, None] + np.arange(sizes.max() * block).reshape(1, -1, block)
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
        both.append((c, inverse @ inverse.transpose(0, 2, 1)))
    rest = (values - np.einsum("mni,mi->mn", q, projected)) * inside
    degrees = np.maximum(inside.sum(axis=1) - size, 1)
    excess = ((rest**2).sum(axis=1) / variance - degrees) / np.sqrt(2.0 * degrees)
    return _Fits(both[0], both[1], variance, excess)


def _vertices(fits, k, sign, ends, fall):
    """Places (m,) of the vertices of the lower polynomials, in u, and their errors.

    None if noise hides the vertex of the mean polynomial too, or if it is outside the window.

    ends : (2, m) of the windows, in u
    """

    def seen(c, C, ends):
        """u, its error, and whether it is in the window, and beyond noise from the fall's side."""
        curvature = math.factorial(k + 2) * c[:, k + 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            u = -math.factorial(k + 1) * c[:, k + 1] / curvature
        is_near = np.abs(u) < OUTSIDE
        u = np.where(is_near, u, 0.0)
        row = _derivatives(u, c.shape[1], k + 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            error = np.where(is_near, np.sqrt(_quadratic(row, C)) / np.abs(curvature), math.inf)
        sides = np.abs(u - ends)[[i for i, side in ((0, -1), (1, 1)) if fall in (0, side)]]
        inside = (ends[0] <= u) & (u <= ends[1])
        return u, error, (sign * curvature < 0.0) & inside & (SEEN * error < sides.min(axis=0))

    c, C = fits.low
    whole = np.array([[ends[0].min()], [ends[1].max()]])
    mean = C.mean(axis=0, keepdims=True) * fits.variance / len(c)
    (place,), (mean_error,), (is_seen,) = seen(c.mean(axis=0, keepdims=True), mean, whole)
    if not is_seen:
        return None
    u, errors, known = seen(c, C * fits.variance, ends)
    if known.mean() <= 0.5:
        known[:] = False
    spread = float(np.std(u[known])) if known.any() else 0.0
    errors = np.where(known, errors, math.hypot(mean_error, spread))
    return np.where(known, u, place), errors


def edges(samples, span, scales, c, fall, sign, sd):
    """Places (m,) of the extremes of polynomials on the side of the fall, in u; their errors.

    And (m,) whether the fall bounds them.

    c : (m, size) of the polynomials
    samples : t and y, (n,) each, of the whole record
    span : (m,) first samples of the windows, those after their last, those after middles of falls
    scales : times (m,) at which u = 0, time in which it grows by 1, and (m,) stress at which c = 0
    """
    first, last, middle = span
    size = np.arange(c.shape[1])

    def u_and_off(rows):
        """u of samples (m, rows), and how far these are from the polynomials."""
        u = (samples[0][rows] - scales[0][:, None]) / scales[1]
        off = samples[1][rows] - scales[2][:, None] - (u[..., None] ** size * c[:, None]).sum(-1)
        return u, off

    if fall == 0:
        u, _ = u_and_off(np.stack([first, last - 1], axis=1))
        slopes = (size[1:] * u[..., None] ** size[:-1] * c[:, None, 1:]).sum(-1)
        best = u[np.arange(len(u)), np.argmax(sign * slopes, axis=1)]
        return best, np.zeros(len(u)), np.ones(len(u), bool)
    end = last - 1 if fall > 0 else first
    steps = np.maximum(fall * (middle - end) + (fall < 0), 1)
    rows = end[:, None] + fall * np.arange(int(steps.max()) + 1)  # (the window's last included)
    inside = (rows >= 0) & (rows < samples[0].size) & (np.arange(rows.shape[1]) <= steps[:, None])
    u, off = u_and_off(np.clip(rows, 0, samples[0].size - 1))
    off = np.where(inside, off, 0.0)
    off[:, 0] = 0.0
    count = np.maximum(inside.sum(axis=0), 1)
    own = _leaves(np.abs(off), sd, inside)
    shared = _leaves(np.abs(off.sum(axis=0) / count), sd / np.sqrt(count), inside)
    left, far = (np.where(own[0] > 0, a, b) for a, b in zip(own, shared, strict=True))
    event, bounded = np.arange(len(u)), left > 0
    step = np.abs(u[event, left] - u[event, np.maximum(left - 1, 0)])
    delay = np.abs(u[event, far] - u[event, left])
    # a time between two samples is known to sqrt(1/12) of a step, the delay to sqrt(2/12); if
    # nothing is seen to leave a window, the extreme is at its end, or up to the fall's middle
    place = np.where(bounded, u[event, left] - fall * (0.5 * step + delay), u[:, 0])
    return place, np.where(bounded, np.hypot(0.5 * step, 0.5 * delay), 0.5 * delay), bounded


def _leaves(off, sd, inside):
    """(m,) samples from the window at which it is left, 0 for none near it, and at which by far."""
    index = np.arange(inside.shape[1])
    near = (off > LEFT * sd) & inside & (index <= BEYOND)
    left = np.where(near.any(axis=1), near.argmax(axis=1), 0)
    far = (off > 4.0 * LEFT * sd) & inside & (index >= left[:, None])
    last = inside.sum(axis=1) - 1
    return left, np.where(far.any(axis=1), far.argmax(axis=1), last)


def _moved(found, fits, k, sign, extent):
    """`Extremes` whose vertices are moved by what the degrees' slopes differ by, in the mean."""
    turn, m = float(found.turn.mean()), found.turn.size
    variance = float(found.turn_variance.mean()) / m
    curvature = math.factorial(k + 2) * float(fits.low[0][:, k + 2].mean())
    shift = float(np.clip(-turn / curvature, -FARTHEST, FARTHEST))
    more = extent * math.hypot(math.sqrt(variance) / abs(curvature), 0.5 * shift)
    beyond = 0.5 * max(turn**2 - variance, 0.0) / abs(curvature) / extent**k
    return found._replace(
        time=found.time + shift * extent,
        time_error=np.hypot(found.time_error, more),
        value=found.value + sign * beyond,
    )


def _quadratic(row, C):
    """(m,) row C row of each event."""
    return np.einsum("mi,mij,mj->m", row, C, row)


def _derivatives(u, size, k):
    """The k-th derivatives of 1, u, u^2, ... at u (m,): (m, size)."""
    powers = np.arange(size)
    factors = np.array([math.perm(j, k) for j in powers], float)
    return factors * u[:, None] ** np.maximum(powers - k, 0)
