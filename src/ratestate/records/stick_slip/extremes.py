"""Extremes of a noisy series, or of its slope: values, times and their standard errors.

The largest of many noisy samples is too large.  So two polynomials are fitted by least squares to a
window next to the fall of each event, or within it.  The first has the lowest degree that has an
extreme, and its vertex is the place of the extreme.  The second is two degrees higher and gives the
value at this place.  If noise hides the vertex of one event, the place is the vertex of the mean
polynomial of all events.

If noise hides that vertex too, the extreme is at the edge of the loading, next to the fall.  Noise
hides the first samples that leave the polynomial.  The fall begins or ends with a finite
acceleration, so the departure grows as the square of the time from the extreme.  Its growth from
zero to `MIN_DEPARTURE` standard deviations then takes as long as from there to four times as many.
If noise hides the fall in one event, the mean departure of all events shows it.

All events at one load-point velocity share a window relative to the middles of their falls.  Of the
windows in which both polynomials agree in value and slope, it is the one with the least error
(Lepskii 1991, doi:10.1137/1135065, chooses windows by such comparisons).

    k    order of the derivative whose extreme is sought: 0 for the stress, 1 for its slope
    u    time from the window's middle divided by its extent
    c    coefficients (m, size) of polynomials of m events, in ascending order
    C    covariances (m, size, size) of these coefficients
"""

import math
from typing import NamedTuple

import numpy as np

#: number of samples in a window; windows with at least twice as many are averaged in blocks
WINDOW_SAMPLES = 300
#: degrees by which the second polynomial exceeds the first
EXTRA_DEGREES = 2
#: least variance of a sample [Pa^2], which avoids a division by zero
TINY = 1e-300
#: excess of a window without a vertex and without a bound by the fall, so that it is chosen last
UNBOUNDED = 1e6
#: least distance of a vertex from the fall, in standard errors, so that noise does not create it
MIN_VERTEX = 6.0
#: largest shift of a vertex, in u
FARTHEST = 0.5
#: least distance of a sample that has left a polynomial, in standard deviations
MIN_DEPARTURE = 4.0
#: number of samples after a window within which samples must leave, or the fall does not bound it
SAMPLES_AFTER = 4
#: most events from which a window is chosen; fraction of them that must have enough samples
MAX_EVENTS, MIN_SHARE = 16, 0.8
#: largest mean difference between both degrees that agree, in standard errors
MAX_DIFFERENCE = 1.5
#: largest allowed excess of the sum of squares, in standard deviations
ROUGH = 4.0
#: power of the contradiction with which the error of a window is multiplied
PENALTY_POWER = 4


class FallWindow(NamedTuple):
    """A window between two times after the middle of a fall, and the side of the fall."""

    start: float  # [s]
    end: float  # [s]
    fall: int  # -1: the fall is before the window, +1: after it, 0: the window is in the fall


class Extremes(NamedTuple):
    """Extremes (m,) of a series or of its slope in a window; NaN if it has too few samples."""

    time: np.ndarray
    value: np.ndarray
    error: np.ndarray
    time_error: np.ndarray
    difference: np.ndarray  # between the values of both degrees
    contradiction: float  # largest misfit, of degrees or samples, as a multiple of the allowed one

    @property
    def biased_error(self):
        """Return errors (m,) of the values that include the mean difference of the degrees."""
        known = self.difference[np.isfinite(self.difference)]
        return np.hypot(self.error, abs(known.mean()) if known.size else math.nan)


def chosen_window(t, y, middles, windows, k, sign, noise):
    """Choose the `FallWindow` whose extremes have the smallest error without contradiction.

    The error is multiplied by a power of the contradiction.  The result is None if no window has
    enough samples.
    """
    sample = middles[:: math.ceil(middles.size / MAX_EVENTS)]
    choices: list[tuple[float, FallWindow]] = []
    for window in windows:
        result = extremes(t, y, sample, window, k, sign, noise)
        if np.isfinite(result.value).mean() >= MIN_SHARE:
            error = math.sqrt(float(np.nanmean(result.error**2)))
            penalty = PENALTY_POWER * math.log(max(result.contradiction, 1.0))
            choices.append((math.log(max(error, TINY)) + penalty, window))
    return min(choices, default=(0.0, None))[1]


def extremes(t, y, middles, window, k, sign, noise):
    """Return the `Extremes` of the k-th derivative in a window relative to each middle of a fall.

    sign : 1 for maxima, -1 for minima
    """
    table = np.full((5, len(middles)), math.nan)
    starts, stops = np.searchsorted(t, middles + np.array([[window.start], [window.end]]))
    use = np.flatnonzero(stops - starts >= k + EXTRA_DEGREES + 4)
    if not use.size:
        return Extremes._make((*table, math.inf))
    span = starts[use], stops[use], np.searchsorted(t, middles[use])
    extent = window.end - window.start
    scales = middles[use] + 0.5 * (window.start + window.end), extent, y[span[0]]
    (c, C), high, excess = _fits(t, y, span, scales, k, noise)
    ends = (t[[span[0], span[1] - 1]] - scales[0]) / extent
    vertices, bounded = _vertices(c, C, k, sign, ends, window.fall), np.ones(use.size, bool)
    if vertices is None:
        u, u_error, bounded = edges((t, y), span, scales, c, window.fall, sign, noise.sd)
    else:
        u, u_error = vertices
    (value, variance), (difference, difference_variance) = _compared((c, C), high, u, k)
    _, (turn, turn_variance) = _compared((c, C), high, u, k + 1)
    time = scales[0] + extent * u
    if vertices is None:  # the place is uncertain where the curve differs by less than its error
        slope = np.abs((_derivatives(u, k + 3, k + 1) * c).sum(axis=1))
        blurred = np.minimum(np.sqrt(variance / 3.0) / (slope + TINY), 1.0)
        variance = variance + (slope * u_error) ** 2
        u_error = np.hypot(u_error, blurred)
    else:  # the mean slope of the higher degree at the vertices moves them
        mean, noise_variance = float(turn.mean()), float(turn_variance.mean()) / use.size
        bend = abs(math.factorial(k + 2) * float(c[:, k + 2].mean()))
        shift = sign * float(np.clip(mean / bend, -FARTHEST, FARTHEST))
        u_error = np.hypot(u_error, math.hypot(math.sqrt(noise_variance) / bend, 0.5 * shift))
        value = value + sign * 0.5 * max(mean**2 - noise_variance, 0.0) / bend
        time = time + shift * extent
    value = value / extent**k + (scales[2] if k == 0 else 0.0)
    error = np.sqrt(variance) / extent**k
    table[:, use] = time, value, error, extent * u_error, difference / extent**k
    parts = [np.where(bounded, excess, UNBOUNDED).sum() / ROUGH / math.sqrt(use.size)]
    for part, part_variance in ((difference, difference_variance), (turn, turn_variance)):
        parts.append(abs(part.sum()) / MAX_DIFFERENCE / math.sqrt(max(part_variance.sum(), TINY)))
    return Extremes._make((*table, float(max(parts))))


def _compared(low, high, u, k):
    """Return the higher degree's k-th derivative, its excess over the lower's; with variances."""
    (c, C), (c_high, C_high) = low, high
    row, n = _derivatives(u, c_high.shape[1], k), c.shape[1]
    value, variance = (row * c_high).sum(axis=1), _quadratic(row, C_high)
    lower, lower_variance = (row[:, :n] * c).sum(axis=1), _quadratic(row[:, :n], C)
    return (value, variance), (value - lower, np.maximum(variance - lower_variance, 0.0))


def _fits(t, y, span, scales, k, noise):
    """Fit both degrees to samples in windows: (c, C) of each, and the excess (m,).

    The excess is the sum of squared residuals minus its expectation, in standard deviations.

    span, scales : as for `edges`
    """
    (first, last, _), (centre, extent, level) = span, scales
    sizes = last - first
    block = max(int(sizes.max()) // WINDOW_SAMPLES, 1)
    sizes = sizes // block
    rows = first[:, None, None] + np.arange(sizes.max() * block).reshape(1, -1, block)
    rows = np.minimum(rows, t.size - 1)
    inside = np.arange(sizes.max()) < sizes[:, None]
    variance = max(noise.sd**2, TINY) * noise.inflation / block
    u = (t[rows].mean(axis=2) - centre[:, None]) / extent
    values = y[rows].mean(axis=2) - level[:, None]
    size = k + EXTRA_DEGREES + 3
    q, r = np.linalg.qr(u[..., None] ** np.arange(size) * inside[..., None])
    projected = np.einsum("mni,mn->mi", q, values)
    fits = []
    for n in (size - EXTRA_DEGREES, size):
        inverse = np.linalg.inv(r[:, :n, :n])
        c = np.einsum("mij,mj->mi", inverse, projected[:, :n])
        fits.append((c, variance * (inverse @ inverse.transpose(0, 2, 1))))
    rest = (values - np.einsum("mni,mi->mn", q, projected)) * inside
    degrees = np.maximum(sizes - size, 1)
    return *fits, ((rest**2).sum(axis=1) / variance - degrees) / np.sqrt(2.0 * degrees)


def _vertices(c, C, k, sign, ends, fall):
    """Return the vertices of polynomials in u and their errors (m,), or None if hidden by noise.

    ends : (2, m) ends of the windows, in u
    """

    def vertex(c, C, ends):
        """Return u, its error, and whether it is in the window and clear of the fall's side."""
        bend = math.factorial(k + 2) * c[:, k + 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            u = -math.factorial(k + 1) * c[:, k + 1] / bend
        inside = (sign * bend < 0.0) & (ends[0] <= u) & (u <= ends[1])
        u, bend = np.where(inside, u, 0.0), np.where(inside, np.abs(bend), math.inf)
        error = np.sqrt(_quadratic(_derivatives(u, c.shape[1], k + 1), C)) / bend
        sides = np.abs(u - ends)[{-1: [0], 1: [1], 0: [0, 1]}[fall]]
        return u, error, inside & (MIN_VERTEX * error < sides.min(axis=0))

    bounds = np.array([[ends[0].min()], [ends[1].max()]])
    mean = c.mean(axis=0, keepdims=True), C.mean(axis=0, keepdims=True) / len(c)
    (mean_u,), (mean_error,), (is_known,) = vertex(*mean, bounds)
    if not is_known:
        return None
    u, errors, known = vertex(c, C, ends)
    known &= known.mean() > 0.5
    spread = float(np.std(u[known])) if known.any() else 0.0
    return np.where(known, u, mean_u), np.where(known, errors, math.hypot(mean_error, spread))


def edges(samples, span, scales, c, fall, sign, sd):
    """Return extremes next to the fall in u, their errors, and whether the fall bounds them (m,).

    samples : t and y, (n,) each, of the whole record
    span : (m,) first samples of the windows, first samples after them, and first samples after the
        middles of falls
    scales : times (m,) at which u = 0; time in which u grows by 1; stresses (m,) from which the
        polynomials are counted
    c : (m, size) coefficients of the polynomials
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
    residuals = np.where(inside & (index > 0), y[rows] - level[:, None] - curve, 0.0)

    def first_departures(residuals, sd):
        """Return after how many samples the curve is left (0: not nearby), and clearly left."""
        near = (residuals > MIN_DEPARTURE * sd) & inside & (index <= SAMPLES_AFTER)
        left = near.argmax(axis=1)  # (0 if there is none)
        far = (residuals > 4.0 * MIN_DEPARTURE * sd) & inside & (index >= left[:, None])
        return left, np.where(far.any(axis=1), far.argmax(axis=1), inside.sum(axis=1) - 1)

    count = np.maximum(inside.sum(axis=0), 1)
    single = first_departures(np.abs(residuals), sd)
    shared = first_departures(np.abs(residuals.sum(axis=0) / count), sd / np.sqrt(count))
    left, far = (np.where(single[0] > 0, a, b) for a, b in zip(single, shared, strict=True))
    bounded = left > 0
    step = np.abs(u[event, left] - u[event, np.maximum(left - 1, 0)])
    delay = np.abs(u[event, far] - u[event, left])
    # a time between two samples has an error of sqrt(1/12) steps, the delay of sqrt(2/12); if no
    # sample leaves the curve, the extreme is between the window's end and the fall's middle
    place = np.where(bounded, u[event, left] - fall * (0.5 * step + delay), u[:, 0])
    return place, np.where(bounded, np.hypot(0.5 * step, 0.5 * delay), 0.5 * delay), bounded


def _quadratic(row, C):
    return np.einsum("mi,mij,mj->m", row, C, row)


def _derivatives(u, size, k):
    """Return the k-th derivatives (m, size) of 1, u, u^2, ... at u (m,)."""
    powers = np.arange(size)
    factors = np.array([math.perm(j, k) for j in powers], float)
    return factors * u[:, None] ** np.maximum(powers - k, 0)
