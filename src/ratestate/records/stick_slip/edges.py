"""Where an extreme is that has no vertex: at the edge of the loading, next to a fall.

The loading is a polynomial up to where samples leave it for the fall.  They have begun to leave
before noise lets one see it: the departure from a polynomial grows as the square of the time from
the extreme, where the fall begins or ends with a finite acceleration, so that it takes as long to
pass from nothing to `LEFT` standard deviations as from there to four times as many.
"""

import math
from typing import NamedTuple

import numpy as np

#: standard deviations of a sample from a polynomial that it has left
LEFT = 4.0
#: samples from a window in which it must be left: else it is none that the fall bounds
BEYOND = 4


class Place(NamedTuple):
    """Where an extreme is, in u, and the standard error of that."""

    u: float
    error: float
    bounded: bool = True  # by a vertex, or by the fall


def edge(samples, span, c, fall, sign, sd):
    """The `Place` of the extreme of a polynomial c on the side of the fall of its window.

    samples : u and y, (n,) each, of the whole record
    span : first sample of the window, that after its last, and that after the middle of the fall
    """
    u, y = samples
    first, last, middle = span
    if fall == 0:
        ends = u[[first, last - 1]]
        slopes = sign * np.polynomial.polynomial.polyval(ends, np.polynomial.polynomial.polyder(c))
        return Place(float(ends[int(np.argmax(slopes))]), 0.0)
    end = last - 1 if fall > 0 else first
    stop = max(middle, end + 1) if fall > 0 else min(middle - 1, end - 1)
    rows = np.arange(end + fall, stop + fall, fall)
    rows = rows[(rows >= 0) & (rows < u.size)]
    off = np.abs(y[rows] - np.polynomial.polynomial.polyval(u[rows], c))
    left = np.flatnonzero(off[:BEYOND] > LEFT * sd)
    if not left.size:
        return Place(float(u[end]), 0.0, bounded=False)
    i = int(left[0])
    far = np.flatnonzero(off[i:] > 4.0 * LEFT * sd)
    j = i + int(far[0]) if far.size else rows.size - 1
    step = abs(float(u[rows[i]] - u[rows[i] - fall]))
    delay = abs(float(u[rows[j]] - u[rows[i]]))
    # a time between two samples is known to sqrt(1/12) of a step, the delay to sqrt(2/12)
    error = math.hypot(0.5 * step, 0.5 * delay)
    return Place(float(u[rows[i]]) - fall * (0.5 * step + delay), error)
