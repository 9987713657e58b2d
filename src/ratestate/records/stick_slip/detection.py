"""Which falls of the shear stress are events: beyond what the noise can do.

A turning point of a series is confirmed as soon as the series has moved away from it by more than a
threshold; what is between a maximum and the next minimum is an event.  The threshold is the largest
range that noise alone reaches in a series of this length, so that noise makes no event.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

#: range of the record over the noise from which samples are used as they are; else means of some
CLEAR = 40.0
#: most samples in such a mean, over those of the record
LONGEST = 0.01
#: standard deviations beyond the expected range of the noise
MARGIN = 3.0
#: rise of stress for the load point's way, over the usual one, from which no spring does it
STEEP = 3.0
#: steps between samples on either side of a gap, and how many times as long it is
BESIDE, LONG = 20, 10.0


class Rough(NamedTuple):
    """An event by its samples; -1 for a peak or trough that the record does not have."""

    peak: int
    trough: int


def rough_events(y, noise, inflation=1.0):
    """list of `Rough` events of a series (n,) with noise of this standard deviation; threshold.

    One that the record's start or end cuts is among them, with -1 for what is missing.  Falls that
    are smaller than the threshold are not found.

    inflation : variance of a mean of samples over that with white noise
    """
    spread = float(np.subtract(*np.percentile(y, (99.0, 1.0))))
    width = 1
    if noise > 0.0 and spread > 0.0:
        width = min(math.ceil((CLEAR * noise / spread) ** 2), max(int(LONGEST * y.size), 1))
    smooth = uniform_filter1d(y, width, mode="nearest") if width > 1 else y
    independent = max(y.size / width, 2.0)
    expected = 2.0 * math.sqrt(2.0 * math.log(independent))
    threshold = (expected + MARGIN) * noise * math.sqrt(min(inflation / width, 1.0))
    turns, leaves = turning_points(smooth, threshold)
    return _paired(turns, leaves), threshold


def without_rebounds(y, moved, rough):
    """`Rough` events (m) in which stress that swings back after a fall belongs to the same event.

    Load point and spring load the block no faster than they do elsewhere.

    moved : (n,) displacement of the load point [m]
    """
    pairs = [*itertools.pairwise(rough)]
    rises = np.array([y[b.peak] - y[a.trough] for a, b in pairs])
    way = np.array([moved[b.peak] - moved[a.trough] for a, b in pairs])
    if rises.size < 2 or not (way > 0.0).all():
        return rough
    stiffness, order = rises / way, np.argsort(rises / way)
    middle = np.searchsorted(np.cumsum(rises[order]), 0.5 * rises.sum())
    kept = [rough[0]]
    for one, too_steep in zip(rough[1:], stiffness > STEEP * stiffness[order][middle], strict=True):
        last = kept[-1]
        if (
            too_steep
            and min(last.peak, last.trough, one.trough) >= 0
            and y[one.peak] < y[last.peak]
        ):
            lower = min(last.trough, one.trough, key=lambda i: y[i])
            kept[-1] = Rough(last.peak, lower)
        else:
            kept.append(one)
    return kept


def in_gaps(t, rough):
    """(m,) whether samples are missing from before the peaks to after the troughs of `Rough`s.

    A step between samples is a gap if it is `LONG` times those on either side of it.
    """
    steps = np.diff(t)
    long = np.flatnonzero(steps > LONG * np.median(steps))
    return np.array([_has_gap(steps, long, one) for one in rough], bool)


def _has_gap(steps, long, rough):
    """Whether one of these long steps is a gap in a `Rough` event."""
    if min(rough) < 0:
        return False
    for i in long[(long >= rough.peak - 1) & (long <= rough.trough)]:
        sides = steps[max(i - BESIDE, 0) : i], steps[i + 1 : i + 1 + BESIDE]
        if all(side.size and steps[i] > LONG * np.median(side) for side in sides):
            return True
    return False


def turning_points(y, threshold):
    """Turning points [(sample, +1 for a maximum or -1)] of a series, and how it ends: -1 falling.

    In turn maxima and minima, each more than the threshold from the next; the ends of the series
    are none.  The end is 0 where no turning point is.
    """
    turns: list[tuple[int, int]] = []
    high = low = 0
    rising = 0  # unknown until the series has moved
    for i, value in enumerate(y.tolist()):
        high, low = (i if value > y[high] else high), (i if value < y[low] else low)
        if rising >= 0 and y[high] - value > threshold:
            turns += [(high, 1)] if rising else []
            rising, low = -1, i
        elif rising <= 0 and value - y[low] > threshold:
            turns += [(low, -1)] if rising else []
            rising, high = 1, i
    return turns, rising


def _paired(turns, leaves):
    """Maxima with the minima that follow; what the record cuts, with -1."""
    found = []
    if turns and turns[0][1] < 0:
        found.append(Rough(-1, turns[0][0]))
        turns = turns[1:]
    found += [Rough(one[0], other[0]) for one, other in zip(turns[::2], turns[1::2], strict=False)]
    if turns and turns[-1][1] > 0 and leaves < 0:
        found.append(Rough(turns[-1][0], -1))
    return found
