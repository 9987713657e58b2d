"""A record as `healing` looks at it: samples, the load point's segments, holds, and slides."""

from typing import NamedTuple

import numpy as np
import xarray

from ..loading import Segments, segments_of
from ..messages import healing as sentences
from ..raw_record import raw_record
from .fault_slip import fault_slip
from .holds import holds_of

#: samples of which the mean is friction at a slide's end; speeds that differ by more are two speeds
LAST, SPEEDS = 12, 0.05


class Slide(NamedTuple):
    """A slide before or after a hold."""

    rows: np.ndarray  # of samples
    tail: np.ndarray  # rows from the peak on, if it follows a hold
    V: float  # [m/s]
    follows_hold: bool


class HealingRecord(NamedTuple):
    """Samples (m,), and what the load point does."""

    t: np.ndarray  # [s], as recorded
    friction: np.ndarray
    kind: str  # "tau": of the spring over sigma; "mu": of the interface
    trend: str | None  # along what friction drifts: "slip", "time" or None
    segments: Segments
    holds: list
    slides: list
    slip: np.ndarray  # of the fault [m]; of the load point if k is not resolved
    k: float  # stiffness over normal stress [1/m]; inf if it is not resolved
    level: np.ndarray  # friction without a rough estimate of its drift
    data: xarray.Dataset  # as given, in SI

    @property
    def spacing(self):
        """The usual time between samples [s]."""
        return float(np.median(np.diff(self.t)))

    @property
    def along(self):
        """What friction drifts along (m,): time [s], or slip of the fault [m]."""
        return self.t if self.trend == "time" else self.slip

    def along_at(self, t, friction):
        """What friction drifts along, at a time [s] when it has this value."""
        if self.trend == "time":
            return t
        return float(self.segments.displacement(t)) - friction / self.k


def healing_record(data, loading, trend):
    """`HealingRecord` of a Dataset; ParameterError as of `raw_record`, and where there is no hold.

    loading : `Loading`, or None for that which was recorded
    """
    names = getattr(data, "variables", ())
    if "tau" in names and "friction" not in names and "sigma" not in names:
        raise sentences.refusal("record.no_sigma")
    raw = raw_record(data, None)
    segments = segments_of(raw, loading)
    holds = holds_of(raw, segments)
    if not holds:
        raise sentences.refusal("record.no_hold")
    slip, k = fault_slip(raw.friction, segments.displacement(raw.time), holds)
    level = raw.friction - (_drift(raw.friction, slip, holds) * slip if trend else 0.0)
    slides = _slides(level, holds)
    return HealingRecord(
        raw.time, raw.friction, raw.kind, trend, segments, holds, slides, slip, k, level, data
    )


def is_same(one, other):
    """Whether two speeds count as one."""
    return abs(one - other) <= SPEEDS * max(one, other)


def _drift(friction, slip, holds):
    """Change of friction with slip [1/m], the median over slides, each to the next one's end."""
    slopes = []
    for hold in holds:
        before, after = hold.before[-LAST:], hold.after[-LAST:]
        if min(before.size, after.size) == LAST and is_same(hold.V_before, hold.V_after):
            moved = slip[after].mean() - slip[before].mean()
            slopes.append((friction[after].mean() - friction[before].mean()) / moved)
    return float(np.median(slopes)) if slopes else 0.0


def _slides(level, holds):
    """List of the `Slide`s before and after holds, each once, in order of time."""
    found = {}
    for hold in holds:
        sides = (hold.before, hold.V_before, False), (hold.after, hold.V_after, True)
        for rows, V, after in sides:
            if rows.size and (first := int(rows[0])) not in found:
                tail = rows[int(np.argmax(level[rows])) :] if after else rows
                found[first] = Slide(rows, tail, V, after)
    return list(found.values())
