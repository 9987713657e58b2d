"""What the load point of a record does: segments of constant speed, and its displacement."""

from typing import NamedTuple

import numpy as np

from .fitting.raw_record import loading_of, recorded_segments


class Segments(NamedTuple):
    """Starts [s] and speeds [m/s] of n segments, taken as exact, and when the last one ends."""

    t: np.ndarray  # (n,)
    V: np.ndarray  # (n,)
    end: float

    @property
    def ends(self):
        """(n,) when each ends [s]."""
        return np.append(self.t[1:], self.end)

    def displacement(self, t):
        """Load-point displacement [m] at times t, from the first segment's start on."""
        moved = np.concatenate([[0.0], np.cumsum(self.V * (self.ends - self.t))])
        return np.interp(t, np.append(self.t, self.end), moved)


def segments_of(raw, loading=None):
    """The `Segments` of a `RawRecord`, as recorded or of a loading (t = 0 at the first sample)."""
    if loading is None:
        t, V = recorded_segments(raw.data, raw.time)
    else:
        checked = loading_of(raw, loading)
        t, V = raw.time[0] + checked.t, np.asarray(checked.V, float)
    return Segments(t, V, float(raw.time[-1]))
