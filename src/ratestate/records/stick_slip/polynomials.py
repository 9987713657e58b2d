"""Extremes of a noisy series, or of its slope: values, times and their standard errors.

The largest of many noisy samples is too large.  So polynomials are fitted by least squares to a
window beside the fall of each event, or within it: one of the lowest degree with an extreme, whose
vertex is the place, and one two degrees higher, whose value is taken there.  If noise hides the
vertex of one event, the vertex of the mean polynomial of all events is the place.  If that is
hidden too, the extreme is at the edge of the window (module ``edges``).

    k    order of the derivative whose extreme is sought: 0 of the stress, 1 of its slope
    u    time from the window's middle divided by its extent
    c    coefficients (m, size) of polynomials of m events, from the constant on
    C    their covariances (m, size, size) for unit variance of a sample
"""

import math
from typing import NamedTuple

import numpy as np

from .edges import Places, edges

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


class Fits(NamedTuple):
    """Polynomials of both degrees in one window of m events."""

    low: tuple  # c, C
    high: tuple
    variance: float  # of a sample
    excess: np.ndarray  # (m,)


def extremes(t, y, middles, window, k, sign, noise):
    """The `Extremes` of the k-th derivative, of sign +1 maxima, in a window after each middle."""
    found = Extremes(*np.full((len(Extremes._fields), len(middles)), math.nan))
    spans = np.searchsorted(t, middles + np.array([[window.start], [window.end]]))
    use = np.flatnonzero(spans[1] - spans[0] >= k + MORE + 4)
    if not use.size:
        return found
    spans, middle, extent = spans[:, use], middles[use], window.end - window.start
    centre, level = middle + 0.5 * (window.start + window.end), y[spans[0, :]]
    samples, inside, variance = _samples(t, y, spans, noise)
    u = (samples[0] - centre[:, None]) / extent
    fits = _fits(u, samples[1] - level[:, None], inside, k, variance)
    ends = (t[[spans[0], spans[1] - 1]] - centre) / extent
    places = _vertices(fits, k, sign, ends, window.fall)
    vertex = places is not None
    if places is None:
        span = (*spans, np.searchsorted(t, middle))
        scales = centre, extent, level
        places = edges((t, y), span, scales, fits.low[0], window.fall, sign, noise.sd)
    value, variances, difference, more = _compared(fits, places.u, k)
    _, _, turn, turn_more = _compared(fits, places.u, k + 1)
    error, off = places.error, np.zeros(use.size)
    if not vertex:
        error, off = _edge_errors(fits.low[0], k, places, variance * variances)
    per = extent**k
    excess = np.where(places.bounded, np.minimum(fits.excess, UNBOUNDED), UNBOUNDED)
    columns = Extremes(
        time=centre + extent * places.u,
        value=value / per + (level if k == 0 else 0.0),
        error=np.sqrt(variance * variances + off**2) / per,
        time_error=extent * error,
        difference=difference / per,
        variance=variance * more / per**2,
        turn=turn,
        turn_variance=variance * turn_more,
        excess=excess,
    )
    if vertex:
        columns = _moved(columns, fits, k, sign, extent)
    for column, part in zip(found, columns, strict=True):
        column[use] = part
    return found


def _samples(t, y, spans, noise):
    """Times and values (2, m, n) in the windows, or means of some; which are inside; variance."""
    sizes = spans[1] - spans[0]
    block = max(int(sizes.max()) // PLENTY, 1)
    sizes = sizes // block
    rows = spans[0][:, None, None] + np.arange(sizes.max() * block).reshape(1, -1, block)
    rows = np.minimum(rows, t.size - 1)
    inside = np.arange(sizes.max()) < sizes[:, None]
    variance = max(noise.sd**2, TINY) * noise.inflation / block
    return np.stack([t[rows].mean(axis=2), y[rows].mean(axis=2)]), inside, variance


def _fits(u, y, inside, k, variance):
    """The `Fits` of values y (m, n) at u by least squares of those that are inside."""
    size = k + MORE + 3
    q, r = np.linalg.qr(u[..., None] ** np.arange(size) * inside[..., None])
    projected = np.einsum("mni,mn->mi", q, y)
    both = []
    for n in (size - MORE, size):
        inverse = np.linalg.inv(r[:, :n, :n])
        c = np.einsum("mij,mj->mi", inverse, projected[:, :n])
        both.append((c, inverse @ inverse.transpose(0, 2, 1)))
    rest = (y - np.einsum("mni,mi->mn", q, projected)) * inside
    degrees = np.maximum(inside.sum(axis=1) - size, 1)
    excess = ((rest**2).sum(axis=1) / variance - degrees) / np.sqrt(2.0 * degrees)
    return Fits(both[0], both[1], variance, excess)


def _vertices(fits, k, sign, ends, fall):
    """`Places` of the vertices of the lower polynomials.

    None if noise hides the vertex of the mean polynomial too, or if it is outside the window.
    """
    c, C = fits.low
    mean = _vertex(c.mean(axis=0), C.mean(axis=0) * fits.variance / len(c), k)
    if not _seen(mean, sign, (ends[0].min(), ends[1].max()), fall):
        return None
    own = [_vertex(*one, k) for one in zip(c, C * fits.variance, strict=True)]
    known = np.array([_seen(one, sign, at, fall) for one, at in zip(own, ends.T, strict=True)])
    if known.mean() <= 0.5:
        known[:] = False
    u, errors, _ = np.array(own).T
    spread = float(np.std(u[known])) if known.any() else 0.0
    places = np.where(known, u, mean[0])
    errors = np.where(known, errors, math.hypot(mean[1], spread))
    return Places(places, errors, np.ones(places.size, bool))


def _seen(vertex, sign, ends, fall):
    """Whether a vertex is in the window, and beyond noise from the side of the fall."""
    place, error, curvature = vertex
    sides = [abs(place - ends[i]) for i, side in ((0, -1), (1, 1)) if fall in (0, side)]
    inside = ends[0] <= place <= ends[1]
    return sign * curvature < 0.0 and inside and SEEN * error < min(sides)


def _vertex(c, C, k):
    """Where the k-th derivative of c is extreme, the standard error of that, and its curvature."""
    curvature = math.perm(k + 2, k) * 2.0 * c[k + 2]
    if curvature == 0.0:
        return 0.0, math.inf, 0.0
    u = -math.perm(k + 1, k) * c[k + 1] / curvature
    if not abs(u) < 1e3:
        return u, math.inf, curvature
    row = derivatives(np.array([u]), c.size, k + 1)[0]
    return u, math.sqrt(row @ C @ row) / abs(curvature), curvature


def _edge_errors(c, k, places, variance):
    """Errors of the places of extremes at an edge, and of values through those of the edge.

    variance : of the value; an extreme is anywhere where the curve is as extreme as that can tell
    """
    slope = np.abs((derivatives(places.u, c.shape[1], k + 1) * c).sum(axis=1))
    blurred = np.sqrt(variance / 3.0) / np.maximum(slope, TINY)
    return np.hypot(places.error, np.minimum(blurred, 1.0)), slope * places.error


def _compared(fits, u, k):
    """k-th derivative at u: of the higher degree, with its variance; less the lower's, with that.

    Variances are for unit variance of the samples.
    """
    (c, C), (c_high, C_high) = fits.low, fits.high
    row, n = derivatives(u, c_high.shape[1], k), c.shape[1]
    value, variance = (row * c_high).sum(axis=1), _quadratic(row, C_high)
    lower = (row[:, :n] * c).sum(axis=1)
    return value, variance, value - lower, np.maximum(variance - _quadratic(row[:, :n], C), 0.0)


def _quadratic(row, C):
    """(m,) row C row of each event."""
    return np.einsum("mi,mij,mj->m", row, C, row)


def _moved(found, fits, k, sign, extent):
    """`Extremes` whose vertices are moved by what the degrees' slopes differ by, in the mean."""
    turn, m = float(found.turn.mean()), found.turn.size
    variance = float(found.turn_variance.mean()) / m
    curvature = math.perm(k + 2, k) * 2.0 * float(fits.low[0][:, k + 2].mean())
    shift = float(np.clip(-turn / curvature, -FARTHEST, FARTHEST))
    more = extent * math.hypot(math.sqrt(variance) / abs(curvature), 0.5 * shift)
    beyond = 0.5 * max(turn**2 - variance, 0.0) / abs(curvature) / extent**k
    return found._replace(
        time=found.time + shift * extent,
        time_error=np.hypot(found.time_error, more),
        value=found.value + sign * beyond,
    )


def derivatives(u, size, k):
    """The k-th derivatives of 1, u, u^2, ... at u (m,): (m, size)."""
    powers = np.arange(size)
    factors = np.array([math.perm(j, k) for j in powers], float)
    return factors * u[:, None] ** np.maximum(powers - k, 0)
