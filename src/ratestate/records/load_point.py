"""What the load point of a record does: segments of constant speed, and its displacement."""

from typing import NamedTuple

import numpy as np

from .fitting.raw_record import constant_speeds_of, recorded_segments
from .reading.overshoots import without_overshoots


class Segments(NamedTuple):
    """Starts [s] and speeds [m/s] of n segments without overshoots, and of all m with them."""

    t: np.ndarray  # (n,)
    V: np.ndarray  # (n,)
    end: float  # when the last one ends [s]
    t_error: np.ndarray  # (n,) of the starts [s]; 0 of those that are given
    all_t: np.ndarray  # (m,)
    all_V: np.ndarray  # (m,)

    @property
    def ends(self):
        """(n,) when each ends [s]."""
        return np.append(self.t[1:], self.end)

    def displacement(self, t):
        """Load-point displacement [m] at times t, from the first segment's start on."""
        ends = np.append(self.all_t, self.end)
        moved = np.concatenate([[0.0], np.cumsum(self.all_V * np.diff(ends))])
        return np.interp(t, ends, moved)


def segments_of(raw, loading=None):
    """The `Segments` of a `RawRecord`, as recorded or of a loading (t = 0 at the first sample).

    A loading that is given has no overshoots.
    """
    end = float(raw.time[-1])
    if loading is None:
        all_t, all_V = recorded_segments(raw.data, raw.time)
        t, V, _ = without_overshoots(all_t, all_V, end)
        return Segments(t, V, end, _start_errors(raw.data, t), all_t, all_V)
    checked = constant_speeds_of(raw, loading)
    t, V = raw.time[0] + checked.t, np.asarray(checked.V, float)
    return Segments(t, V, end, np.zeros(t.size), t, V)


def _start_errors(data, starts):
    """(n,) standard errors of some of a record's starts [s], as far as it has them."""
    if "segment_t_error" not in data.variables:
        return np.zeros(starts.size)
    at = np.searchsorted(data["segment_t"].values, starts)
    return np.asarray(data["segment_t_error"].values, float)[at]
