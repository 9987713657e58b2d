"""Slides of a record that are stick-slip: steady sliding is unstable there, and no step is seen.

The events and the test of their significance are those of `events`.  Of noise that wanders that
test lets some pass: here a slide wants several events, which make up much of what friction does.
"""

from typing import NamedTuple

import numpy as np

from ....errors import RateStateError
from ...loading import recorded_segments
from ...stick_slip.detection import detected
from ...stick_slip.series import series_of

#: fewest events at one speed, and least drop of a typical one, over the range of friction there
FEWEST, DROP = 4, 1.0 / 3.0


class Slide(NamedTuple):
    """A part of a record at one load-point speed, with stick-slip."""

    begin: float  # [s]
    end: float
    V: float  # of the load point [m/s]
    events: int


def stick_slip_slides(data, sigma):
    """list of `Slide` of a record (Dataset in SI); sigma [Pa] where none is recorded."""
    time = data["time"].values
    starts, speeds = recorded_segments(data, time)
    found = []
    for begin, end, V in zip(starts, [*starts[1:], np.inf], speeds, strict=True):
        part = data.isel(time=slice(*np.searchsorted(time, (begin, end)).tolist()))
        if V > 0.0 and (count := _events_in(part, sigma)):
            found.append(Slide(float(begin), float(end), float(V), count))
    return found


def _events_in(part, sigma):
    """Number of stick-slip events in a slide; 0 where there is no stick-slip."""
    try:
        series = series_of(part, sigma=None if "sigma" in part.variables else sigma)
    except RateStateError:  # such as of missing values: the fit of the slide says so
        return 0
    series, rough, *_ = detected(series)
    if len(rough) < FEWEST:
        return 0
    friction = series.tau / series.sigma
    drops = [friction[i] - friction[j] for i, j in rough if min(i, j) >= 0]
    high, low = np.percentile(friction, (99.0, 1.0))
    return len(rough) if np.median(drops) > DROP * (high - low) else 0


def stick_slip_about(window, slides):
    """Of the stick-slip `Slide`s that a `Window` has a part of that with most events, or None."""
    about = [one for one in slides if one.begin < window.end and window.begin < one.end]
    return max(about, key=lambda one: one.events, default=None)
