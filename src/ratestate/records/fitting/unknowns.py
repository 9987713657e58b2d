"""The parameters that a fit may move: their coordinates, bounds, and where searches for them start.

`PARAMETERS` has a row for each; whatever else names parameters derives from it.  A positive
parameter moves as its logarithm, so that steps are relative and no bound is needed at 0.  b moves
as itself, for it may be negative.  Beside what the user frees, a record brings parameters of its
own: its level of friction, its trend, and the state in which it begins.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .refusals import refusal

#: step of a difference in a logarithm
STEP = 3e-5
#: ln of the ratio of speeds that a hold counts as
HOLD = 5.0
#: an estimate this near to a bound, as a part of the distance between both, is at the bound
NEAR = 1e-3


class Parameter(NamedTuple):
    """How a fit moves a parameter; its bounds and starts are over its size, as of `sizes_of`."""

    #: "slider", or "record", if the user may free it; else of the record: "start", or "linear",
    #: in which friction is a linear function
    group: str
    is_log: bool = False  # it moves as its logarithm
    bounds: tuple[float, float] = (-math.inf, math.inf)
    starts: tuple[float, float] | None = None  # of a logarithm in powers of ten; None: 0 alone
    step: Callable[[Any], float] = lambda record: STEP  # of a difference in the coordinate
    irrelevant: int = 0  # -1 or 1: it ceases to matter where it is small, or large
    reported_as: str = ""  # if it is reported, but not among the free parameters
    no_part_in_cycles: str = ""  # what of it has no effect on cycles


#: name -> `Parameter`, in the order in which they are reported
PARAMETERS = {
    "a": Parameter("slider", is_log=True, bounds=(1e-3, 1e2), starts=(-0.5, 0.5)),
    "b": Parameter(
        "slider", bounds=(-1e2, 1e2), starts=(-1.0, 3.0), step=lambda record: STEP * record.scale
    ),
    "Dc": Parameter("slider", is_log=True, bounds=(1e-3, 1e3), starts=(-1.5, 0.7)),
    "K": Parameter("slider", is_log=True, bounds=(1e-4, 1e6), starts=(-0.5, 1.5), irrelevant=1),
    "M": Parameter("slider", is_log=True, bounds=(1e-8, 1e4), starts=(-3.0, 1.0), irrelevant=-1),
    "lag": Parameter(
        "record",
        bounds=(-0.1, 0.1),
        step=lambda record: 0.1 * record.spacing,
        no_part_in_cycles="a delay of a load point that moves steadily",
    ),
    # ln(V/V1) and ln(theta V1/Dc) at the start of a record that begins out of steady sliding at V1
    "v_start": Parameter("start", bounds=(-20.0, 20.0)),
    "psi_start": Parameter("start", bounds=(-20.0, 20.0)),
    "level": Parameter("linear"),
    "trend": Parameter("linear", reported_as="trend_{along}"),
}


def _names(*groups):
    """Names of the parameters of these groups."""
    return tuple(name for name, row in PARAMETERS.items() if row.group in groups)


OF_SLIDER, START, LINEAR = _names("slider"), _names("start"), _names("linear")
#: parameters that the user may free; each fit estimates mu0 anyway
FREE = _names("slider", "record")


def sizes_of(record, sigma):
    """name -> order of magnitude that the record suggests [SI]; 1 of all others."""
    speeds = record.loading.V[record.loading.V > 0.0]
    ratio = max(float(np.abs(np.log(speeds / record.loading.V[0])).max()), 1.0)
    if speeds.size < record.loading.V.size:  # in a hold the slider slows by orders of magnitude
        ratio = max(ratio, HOLD)
    scale = record.scale / ratio
    t, slow = record.t, float(speeds.min())
    distance = float(record.loading.delta_lp(t[-1:])[0] - record.loading.delta_lp(t[:1])[0])
    distance = max(distance, 10.0 * slow * record.spacing)
    K = 10.0 * sigma * record.scale / distance
    M = K * (t[-1] / 50.0) ** 2
    sizes = {"a": scale, "b": scale, "Dc": 0.05 * distance, "K": K, "M": M, "lag": t[-1]}
    return dict.fromkeys(PARAMETERS, 1.0) | sizes


class Unknowns(NamedTuple):
    """Names of the coordinates, in order, and the bounds between which each may move."""

    names: tuple
    low: np.ndarray  # (k,)
    high: np.ndarray  # (k,)

    def sides(self, point):
        """name -> -1 or 1 where a point (k,) is at the lower or upper bound, else 0."""
        width = self.high - self.low
        bounded = np.isfinite(width)
        part = np.full(len(self.names), 0.5)
        part[bounded] = (point[bounded] - self.low[bounded]) / width[bounded]
        sides = np.where(part < NEAR, -1, np.where(part > 1.0 - NEAR, 1, 0))
        return dict(zip(self.names, sides.tolist(), strict=True))


def unknowns_of(record, free, *, start, sigma):
    """`Unknowns` of a record: free parameters, the start if that is free, level, trend."""
    names = (*free, *(START if start else ()), *record.regressors())
    sizes = sizes_of(record, sigma)
    bounds = [
        [to_coordinate(name, end * sizes[name]) for end in PARAMETERS[name].bounds]
        for name in names
    ]
    low, high = np.array(bounds).T
    return Unknowns(names, low, high)


def distinct(points, distance, most=None):
    """Indices (list) of points (n, k), each away from all before, in some coordinate.

    distance : farther than this; one for all coordinates, or (k,)
    most : largest number of them; None for any
    """
    kept: list[int] = []
    for i, point in enumerate(points):
        if len(kept) != most and all(np.any(np.abs(point - points[j]) > distance) for j in kept):
            kept.append(i)
    return kept


def checked_free(free, slider):
    """The free parameters as a tuple, in the order of `PARAMETERS`, without mu0.

    ParameterError for what cannot be free, twice the same, and for none beside mu0.
    """
    allowed = ", ".join((*FREE, "mu0"))
    try:
        names = (free,) if isinstance(free, str) else tuple(free)
    except TypeError:
        raise refusal("free.no_sequence", free=free, allowed=allowed) from None
    if not names:
        raise refusal("free.empty", allowed=allowed)
    for name in names:
        if name not in (*FREE, "mu0"):
            raise refusal("free.unknown", name=name, allowed=allowed)
    if len(set(names)) < len(names):
        raise refusal("free.twice", names=names)
    if "K" in names and math.isinf(slider.K):
        raise refusal("free.rigid")
    if "M" in names and slider.M == 0.0:
        raise refusal("free.massless")
    chosen = tuple(name for name in FREE if name in names)
    if not chosen:
        raise refusal("free.only_mu0", slider=", ".join(OF_SLIDER))
    return chosen


def to_coordinate(name, value):
    """A value [SI] as the coordinate in which it moves."""
    return np.log(value) if PARAMETERS[name].is_log else value


def to_value(name, coordinate):
    """The value [SI] of a coordinate."""
    if not PARAMETERS[name].is_log:
        return coordinate
    with np.errstate(over="ignore"):  # an open end of an interval
        return np.exp(coordinate)
