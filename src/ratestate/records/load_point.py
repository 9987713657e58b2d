"""What the load point of a record does: segments of constant speed, and its displacement."""

from typing import NamedTuple

import numpy as np

from .fitting.raw_record import loading_of, recorded_segments
from .reading.overshoots import without_overshoots


class Segments(NamedTuple):
    """Starts [s] and speeds [m/s] of n segments, and when the last one ends."""

    t: np.ndarray  # (n,)
    V: np.ndarray  # (n,)
    end: float
    t_error: np.ndarray  # (n,) of the starts [s]; 0 of those that are given

    @property
    def ends(self):
        """(n,) when each ends [s]."""
        return np.append(self.t[1:], self.end)

    def displacement(self, t):
        """Load-point displacement [m] at times t, from the first segment's start on."""
        moved = np.concatenate([[0.0], np.cumsum(self.V * (self.ends - self.t))])
        return np.interp(t, np.append(self.t, self.end), moved)


def segments_of(raw, loading=None):
    """The `Segments` of a `RawRecord`, as recorded or of a loading (t = 0 at the first sample).

    Without overshoots, if as recorded.
    """
    if loading is None:
        found, V = recorded_segments(raw.data, raw.time)
        t, V, kept = without_overshoots(found, V, raw.time[-1])
        t_error = _start_errors(raw.data, found)[kept]
    else:
        checked = loading_of(raw, loading)
        t, V = raw.time[0] + checked.t, np.asarray(checked.V, float)
        t_error = np.zeros(t.size)
    return Segments(t, V, float(raw.time[-1]), t_error)


def _start_errors(data, starts):
    """(n,) standard errors of some of a record's starts [s], as far as it has them."""
    if "segment_t_error" not in data.variables:
        return np.zeros(starts.size)
    at = np.searchsorted(data["segment_t"].values, starts)
    return np.asarray(data["segment_t_error"].values, float)[at]
