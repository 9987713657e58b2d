"""The coordinates in which a fit moves, their bounds, and their values in SI.

A positive parameter moves as its logarithm, so that steps are relative and no bound is needed at
0.  b is its own coordinate, for it may be negative.  Beside what the user frees, a record brings
unknowns of its own: its level of friction, its trend, and the state in which it begins.
"""

import math
from typing import NamedTuple

import numpy as np

from .refusals import refusal

#: parameters of the slider that may be free
PARAMETERS = ("a", "b", "Dc", "K", "M")
#: coordinates that are no logarithms
LINEAR = ("b", "lag", "level", "trend")
#: ln(V/V1) and ln(theta V1/Dc) at the start of a record that begins out of steady sliding at V1
START = ("v_start", "psi_start")
#: coordinates that are no logarithm of a value in SI
PLAIN = (*LINEAR, *START)
#: an estimate this near to a bound, as a part of the distance between both, is at the bound
NEAR = 1e-3


class Unknowns(NamedTuple):
    """Names of the coordinates, in order, and the bounds between which each may move."""

    names: tuple
    low: np.ndarray  # (k,)
    high: np.ndarray  # (k,)

    @property
    def reported(self):
        """Names that the result reports: all but those that only describe the record."""
        return tuple(n for n in self.names if n not in (*START, "level", "trend"))

    def sides(self, point):
        """name -> -1 or 1 where a point (k,) is at the lower or upper bound, else 0."""
        width = self.high - self.low
        bounded = np.isfinite(width)
        part = np.full(len(self.names), 0.5)
        part[bounded] = (point[bounded] - self.low[bounded]) / width[bounded]
        sides = np.where(part < NEAR, -1, np.where(part > 1.0 - NEAR, 1, 0))
        return dict(zip(self.names, sides.tolist(), strict=True))


def distinct(points, distance, most=None):
    """Indices of points (n, k), each farther than `distance` from all before in some coordinate."""
    kept: list[int] = []
    for i, point in enumerate(points):
        if len(kept) != most and all(np.any(np.abs(point - points[j]) > distance) for j in kept):
            kept.append(i)
    return kept


def checked_free(free, slider):
    """The free parameters as a tuple, in the order of `PARAMETERS`; refuses what cannot be free."""
    allowed = ", ".join((*PARAMETERS, "lag", "mu0"))
    try:
        names = (free,) if isinstance(free, str) else tuple(free)
    except TypeError:
        raise refusal("free.no_sequence", free=free, allowed=allowed) from None
    if not names:
        raise refusal("free.empty", allowed=allowed)
    for name in names:
        if name not in (*PARAMETERS, "lag", "mu0"):
            raise refusal("free.unknown", name=name, allowed=allowed)
    if len(set(names)) < len(names):
        raise refusal("free.twice", names=names)
    if "K" in names and math.isinf(slider.K):
        raise refusal("free.rigid")
    if "M" in names and slider.M == 0.0:
        raise refusal("free.massless")
    chosen = tuple(n for n in (*PARAMETERS, "lag") if n in names)
    if not chosen:
        raise refusal("free.only_mu0")
    return chosen


def to_coordinate(name, value):
    """A value [SI] as the coordinate in which it moves."""
    return value if name in LINEAR else np.log(value)


def to_value(name, coordinate):
    """The value [SI] of a coordinate."""
    if name in LINEAR:
        return coordinate
    with np.errstate(over="ignore"):  # an open end of an interval
        return np.exp(coordinate)
