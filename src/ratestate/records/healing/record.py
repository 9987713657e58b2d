"""A record as `healing` looks at it: samples, the load point's segments, and the holds in them."""

from typing import NamedTuple

import numpy as np

from ..fitting.raw_record import raw_record
from ..load_point import Segments, segments_of
from .holds import holds_of
from .messages import refusal


class HealingRecord(NamedTuple):
    """Samples (m,), and what the load point does."""

    t: np.ndarray  # [s], as recorded
    friction: np.ndarray
    kind: str  # "tau": of the spring over sigma; "mu": of the interface
    trend: str | None  # along what friction drifts: "slip", "time" or None
    segments: Segments
    holds: list

    @property
    def spacing(self):
        """The usual time between samples [s]."""
        return float(np.median(np.diff(self.t)))

    def along(self, t):
        """What friction drifts with, at times t [s]: time, or load-point displacement [m]."""
        return np.asarray(t) if self.trend == "time" else self.segments.displacement(t)

    @property
    def slides(self):
        """Rows (list of arrays) of the slides before and after holds, each once."""
        rows = [rows for hold in self.holds for rows in (hold.before, hold.after) if rows.size]
        return list({int(one[0]): one for one in rows}.values())


def healing_record(data, loading, trend):
    """`HealingRecord` of a Dataset; ParameterError as of `raw_record`, and where there is no hold.

    loading : `Loading`, or None for that which was recorded
    """
    names = getattr(data, "variables", ())
    if "tau" in names and "friction" not in names and "sigma" not in names:
        raise refusal("record.no_sigma")
    raw = raw_record(data, None)
    segments = segments_of(raw, loading)
    holds = holds_of(raw, segments)
    if not holds:
        raise refusal("record.no_hold")
    return HealingRecord(raw.time, raw.friction, raw.kind, trend, segments, holds)
