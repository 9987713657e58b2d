"""An extreme of a noisy series, or of its slope: value, time and their standard errors.

The largest of many noisy samples is too large.  So polynomials are fitted by least squares to a
window beside the fall of an event, or within it: one of the lowest degree with an extreme, whose
vertex is the place, and one two degrees higher, whose value is taken there.  At its own vertex a
fitted polynomial is too extreme by var(slope)/(2 |curvature|), which is subtracted.  Where the
window has no vertex the extreme is at its edge (module ``edges``).

    k    order of the derivative whose extreme is sought: 0 of the stress, 1 of its slope
    u    time from the window's origin over its extent
    c    coefficients of a polynomial, from the constant on, C their covariance for unit variance
"""

import math
from typing import NamedTuple

import numpy as np

from .edges import Place, edge

#: samples in a window of which means are taken from twice as many on
PLENTY = 300
#: degrees over that with an extreme
MORE = 2
#: least variance of a sample [Pa^2], so that what has no noise can be divided by it
TINY = 1e-300
#: excess of a window without a vertex that the fall does not bound: the last to be chosen
UNBOUNDED = 1e6


class Window(NamedTuple):
    """A window from two times after the middle of a fall, and which side of it is the fall."""

    start: float  # [s]
    end: float  # [s]
    fall: int  # -1: the fall is before the window, +1: after it, 0: the window is in the fall


class Extreme(NamedTuple):
    """The extreme of a series, or of its slope, in a window."""

    time: float
    value: float
    error: float
    time_error: float
    difference: float  # of the degrees; nan where there are too few samples
    variance: float  # of that
    turn: float  # difference of the degrees' slopes there, over u
    turn_variance: float
    curvature: float  # over u
    extent: float  # of the window [s]
    inside: float  # 1.0 for a vertex in the window, 0.0 for its edge
    excess: float  # sum of squares over its expectation, in standard deviations


class Fit(NamedTuple):
    """Polynomials in both degrees, of one window."""

    low: tuple  # c, C
    high: tuple
    curve: np.ndarray  # (3,) the quadratic that is the k-th derivative of the lower one
    variance: float  # of a sample
    excess: float


NOTHING = Extreme(*[math.nan] * len(Extreme._fields))


def extreme(t, y, middle, window, k, sign, noise, known=None):
    """The `Extreme` of the k-th derivative, of sign +1 a maximum, in a window after `middle`.

    known : time after `middle`, and its error, of an extreme that has no vertex here
    """
    first, last = np.searchsorted(t, (middle + window.start, middle + window.end))
    if last - first < k + MORE + 4:
        return NOTHING
    origin, extent, level = 0.5 * (t[first] + t[last - 1]), t[last - 1] - t[first], y[first]
    means, values, variance = _means(t[first:last], y[first:last] - level, noise)
    fit = _fit((means - origin) / extent, values, k, variance)
    place, bias = _vertex(fit, k, sign, (t[[first, last - 1]] - origin) / extent)
    inside = place is not None
    if place is None and known:
        place = Place((middle + known[0] - origin) / extent, known[1] / extent)
    elif place is None:
        span = first, last, int(np.searchsorted(t, middle))
        samples = (t - origin) / extent, y - level
        place = edge(samples, span, fit.low[0], window.fall, sign, noise.sd)
    value, variance_high, difference, variance_more = _compared(fit, place.u, k)
    _, _, turn, turn_more = _compared(fit, place.u, k + 1)
    spread, off = place.error, 0.0
    if not inside and not known:
        spread, off = _edge_errors(fit.curve, place, variance * variance_high)
    per = extent**k
    return Extreme(
        time=origin + extent * place.u,
        value=(value - sign * bias) / per + (level if k == 0 else 0.0),
        error=math.sqrt(variance * variance_high + 2.0 * bias**2 + off**2) / per,
        time_error=extent * spread,
        difference=difference / per,
        variance=variance * variance_more / per**2,
        turn=turn,
        turn_variance=variance * turn_more,
        curvature=2.0 * fit.curve[2],
        extent=extent,
        inside=float(inside),
        excess=min(fit.excess, UNBOUNDED) if place.bounded else UNBOUNDED,
    )


def _means(t, y, noise):
    """Times and values of a window, means of some where it has many; variance of one."""
    block = t.size // PLENTY
    variance = max(noise.sd**2, TINY) * noise.inflation
    if block < 2:
        return t, y, variance
    rows = t.size // block * block
    return (*(x[:rows].reshape(-1, block).mean(axis=1) for x in (t, y)), variance / block)


def _fit(u, y, k, variance):
    """The `Fit` of values y (n,) at u by least squares."""
    size = k + MORE + 3
    q, r = np.linalg.qr(np.vander(u, size, increasing=True))
    projected = q.T @ y
    inverses = [np.linalg.inv(r[:n, :n]) for n in (size - MORE, size)]
    low, high = ((inverse @ projected[: len(inverse)], inverse @ inverse.T) for inverse in inverses)
    rest = y - q @ projected
    degrees = max(u.size - size, 1)
    excess = (float(rest @ rest) / variance - degrees) / math.sqrt(2.0 * degrees)
    curve = np.array([math.perm(k + j, k) * low[0][k + j] for j in range(3)])
    return Fit(low, high, curve, variance, excess)


def _vertex(fit, k, sign, ends):
    """The `Place` of a quadratic's extreme, and how much too extreme it is there; or None, 0."""
    curvature = 2.0 * fit.curve[2]
    if not sign * curvature < 0.0:
        return None, 0.0
    u = -fit.curve[1] / curvature
    if not ends[0] <= u <= ends[1]:
        return None, 0.0
    C = fit.low[1]
    row = derivatives(u, C.shape[0], k + 1)
    slope = fit.variance * float(row @ C @ row)
    return Place(u, math.sqrt(slope) / abs(curvature)), 0.5 * slope / abs(curvature)


def _edge_errors(curve, place, variance):
    """Errors of the place of an extreme at an edge, and of a value through that of the edge.

    variance : of the value; an extreme is anywhere where the curve is as extreme as that can tell
    """
    slope = abs(curve[1] + 2.0 * curve[2] * place.u)
    if not slope > 0.0:
        return place.error, 0.0
    blurred = min(math.sqrt(variance / 3.0) / slope, 1.0)
    return math.hypot(place.error, blurred), slope * place.error


def _compared(fit, u, k):
    """k-th derivative at u: of the higher degree, with its variance; less the lower's, with that.

    Variances are for unit variance of the samples.
    """
    (c, C), (c_high, C_high) = fit.low, fit.high
    row, n = derivatives(u, c_high.size, k), c.size
    value, variance = row @ c_high, row @ C_high @ row
    more = variance - row[:n] @ C @ row[:n]
    return value, variance, value - row[:n] @ c, max(more, 0.0)


def derivatives(u, size, k):
    """The k-th derivatives of 1, u, u^2, ... at u: (size,)."""
    return np.array([math.perm(j, k) * u ** (j - k) if j >= k else 0.0 for j in range(size)])
