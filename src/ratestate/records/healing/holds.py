"""The holds of a record: when they begin and end, and the slides before and after them."""

from typing import NamedTuple

import numpy as np

#: samples left out on either side of a change of speed, whose time is found no better
GUARD = 1


class Hold(NamedTuple):
    """A hold; the slide before it, or after it, has no rows where the record has none."""

    start: float  # [s], as recorded
    end: float
    V_before: float  # [m/s]; NaN where the record has no such slide
    V_after: float
    before: np.ndarray  # rows of samples
    during: np.ndarray
    after: np.ndarray
    slide: float  # time [s] of the slide after it; 0 without one


def holds_of(raw, segments):
    """list of `Hold`s, in order of time."""
    starts, V, ends = segments.t, segments.V, segments.ends

    def rows(i):
        if not 0 <= i < V.size:
            return np.arange(0)
        first, last = np.searchsorted(raw.time, (starts[i], ends[i]))
        # (the record's own first and last samples are beside no change)
        first, last = first + (GUARD if i else 0), last - (GUARD if i + 1 < V.size else 0)
        return np.arange(first, max(last, first))

    def speed(i):
        return float(V[i]) if 0 <= i < V.size else np.nan

    return [
        Hold(
            float(starts[i]),
            float(ends[i]),
            speed(i - 1),
            speed(i + 1),
            rows(i - 1),
            rows(i),
            rows(i + 1),
            float(ends[i + 1] - starts[i + 1]) if i + 1 < V.size else 0.0,
        )
        for i in np.flatnonzero(V == 0.0)
    ]
