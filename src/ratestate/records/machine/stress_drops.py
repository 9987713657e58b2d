"""Stress drops of stick-slip in a record, and the loading phases between them."""

from itertools import pairwise

import numpy as np
import xarray

from ..stick_slip.detection import detected, in_gaps, is_whole
from ..stick_slip.series import series_of

#: least drop over the largest one of a segment: smaller ones are of what rings
DROP = 0.3
#: fewest in a segment, and part of it after which they still go on: else it only rings down
CYCLES, GOES_ON = 3, 0.6


def stress_drops(raw, sigma, segments):
    """For each of the `Segments` (m, 2) starts and ends [s] of the stress drops in it.

    To the sample: what is fitted to begins and ends well between them.
    """
    variables = {
        "friction": ("time", raw.friction),
        "sigma": ("time", np.full(raw.time.size, sigma)),
    }
    variables |= {"segment_t": ("segment", segments.t), "segment_V": ("segment", segments.V)}
    series, falls, *_ = detected(series_of(xarray.Dataset(variables, {"time": raw.time})))
    samples = falls[is_whole(falls) & ~in_gaps(series.t, falls)]
    times, drops = series.t[samples], series.tau[samples] @ (1.0, -1.0)
    chosen = []
    for begin, end in zip(segments.t, segments.ends, strict=True):
        inside = (times[:, 0] >= begin) & (times[:, 1] <= end)
        large = inside & (drops > DROP * drops[inside].max(initial=0.0))
        goes_on = large.sum() >= CYCLES and times[large, 0][-1] > begin + GOES_ON * (end - begin)
        chosen.append(times[large & goes_on])
    return chosen


def loading_phases(drops):
    """[(start, end)] [s] of the loading between successive drops (m, 2)."""
    return [(float(one[1]), float(other[0])) for one, other in pairwise(drops)]
