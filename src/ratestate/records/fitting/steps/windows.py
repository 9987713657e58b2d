"""Windows of a record: each step and hold with the sliding before it and after it.

No step can be fitted during stick-slip.  Events are detected, and tested for significance, as by
`events`.  That test accepts some events of wandering noise.  So here a segment needs several
events, with drops that are a large fraction of the range of friction.
"""

from typing import NamedTuple

import numpy as np

from ....errors import RateStateError
from ...load_point.stress_steps import stress_steps
from ...messages import fitting as sentences
from ...raw_record import checked_time, recorded_segments
from ...stick_slip.detection import detected
from ...stick_slip.series import series_of
from . import HOLD, NORMAL_STRESS, STEP

#: fraction of the sliding before a change that its window has, so that the change before is over
LEAD = 0.5
#: fewest rows of this sliding, if the record has as many
ROWS = 50
#: fewest events at one speed; least median drop, as a fraction of the range of friction there
FEWEST, DROP = 4, 1.0 / 3.0


class StepWindow(NamedTuple):
    """A step or hold, and the part of the record in which it is fitted."""

    kind: str  # `STEP` or `HOLD` of the load point, or `NORMAL_STRESS`
    t: float  # when it begins [s]
    begin: float  # of the window [s]
    end: float  # [s]; the first time that is not in it
    V_before: float  # of the load point [m/s]
    V_after: float
    t_hold: float  # duration of a hold [s], else NaN
    slip_since_change: float  # load-point displacement from the change before to `begin` [m]

    @property
    def rise(self):
        """Rise of the load-point speed at a step [m/s]; 0 at other kinds."""
        return self.V_after - self.V_before if self.kind == STEP else 0.0

    def part(self, data):
        """Return the rows of a record (Dataset) in the window."""
        time = data["time"].values
        return data.isel(time=slice(*np.searchsorted(time, (self.begin, self.end)).tolist()))

    def stress_levels(self, part):
        """Return normal stress [Pa] before and after t; part : rows of the window."""
        time, sigma = part["time"], part["sigma"]
        return tuple(float(sigma.where(side).median()) for side in (time < self.t, time > self.t))


class _Change(NamedTuple):
    """A change of speed or normal stress."""

    t: float
    V: float  # load-point speed after the change
    is_of_stress: bool
    end: float  # end of a ramp of normal stress, else t


def windows_of(data):
    """Return the `StepWindow`s (list) of a record, a Dataset in SI, in order of time.

    A hold lasts until the end of the sliding after it.  Steps and ramps of normal stress are those
    of `stress_steps`.  ParameterError as of `checked_time` and `recorded_segments`, and if no step
    or hold follows on sliding.
    """
    time = checked_time(data)
    changes = _changes(data)
    windows = []
    for i in range(1, len(changes) - 1):
        before, change, after = changes[i - 1 : i + 2]
        if before.V == 0.0 or (before.V == change.V and not change.is_of_stress):
            continue
        is_hold = change.V == 0.0
        if is_hold and i + 2 < len(changes):
            after = changes[i + 2]
        # a change that would end after the next one begins counts as over from its start
        over = before.end if before.end < change.t else before.t
        begin = _window_begin(time, over, before.V, change, after.t)
        windows.append(
            StepWindow(
                kind=NORMAL_STRESS if change.is_of_stress else HOLD if is_hold else STEP,
                t=change.t,
                begin=begin,
                end=after.t,
                V_before=before.V,
                V_after=changes[i + 1].V if is_hold else change.V,
                t_hold=changes[i + 1].t - change.t if is_hold else np.nan,
                slip_since_change=np.inf if i == 1 else before.V * (begin - over),
            )
        )
    if not windows:
        raise sentences.refusal("per_step.no_step")
    return windows


def _changes(data):
    """Return `_Change`s (list), the first at the record's start, the last at its end."""
    time = data["time"].values
    segments = recorded_segments(data, time).without_overshoots()
    pairs = zip(segments.t.tolist(), segments.V.tolist(), strict=True)
    changes = [_Change(t, V, False, t) for t, V in pairs][1:]
    has_stress = "sigma" in data.variables and data["sigma"].dims == ("time",)
    for t, _, _, over in stress_steps(time, data["sigma"].values) if has_stress else ():
        changes.append(_Change(t, float(segments.V[segments.at(t)]), True, over))
    begin, end = float(time[0]), float(time[-1]) + 0.5 * float(np.median(np.diff(time)))
    first = _Change(begin, float(segments.V[0]), False, begin)
    return [first, *sorted(changes), _Change(end, np.nan, False, end)]


def _window_begin(time, over, V, change, end):
    """Return when the window of a change begins [s].

    over : end of the change before [s]; V, end : speed before the change, end of the window

    The sliding before the change is not longer in displacement than the sliding after it.  It has
    at least `ROWS` rows, if there are as many.
    """
    moved = max(change.V, V) * (end - change.t)
    lead = min(LEAD * (change.t - over), moved / V)
    row, first = np.searchsorted(time, (change.t, change.t - lead)).tolist()
    if row - first < ROWS:
        lead = max(lead, change.t - max(float(time[max(row - ROWS, 0)]), over))
    return change.t - lead


class StickSlipSegment(NamedTuple):
    """A part of a record at one load-point speed, with stick-slip."""

    begin: float  # [s]
    end: float
    V: float  # of the load point [m/s]
    events: int


def stick_slip_segments(data, sigma):
    """Return the `StickSlipSegment`s (list) of a record; sigma [Pa] is used if none is recorded."""
    time = data["time"].values
    segments, found = recorded_segments(data, time), []
    for begin, end, V in zip(segments.t, [*segments.t[1:], np.inf], segments.V, strict=True):
        part = data.isel(time=slice(*np.searchsorted(time, (begin, end)).tolist()))
        if V > 0.0 and (count := _events_in(part, sigma)):
            found.append(StickSlipSegment(float(begin), float(end), float(V), count))
    return found


def _events_in(part, sigma):
    """Return the number of stick-slip events in a segment; 0 without stick-slip."""
    try:
        series = series_of(part, sigma=None if "sigma" in part.variables else sigma)
    except RateStateError:  # such as missing values, on which the fit has a message
        return 0
    series, rough, *_ = detected(series)
    if len(rough) < FEWEST:
        return 0
    friction = series.tau / series.sigma
    drops = [friction[i] - friction[j] for i, j in rough if min(i, j) >= 0]
    high, low = np.percentile(friction, (99.0, 1.0))
    return len(rough) if np.median(drops) > DROP * (high - low) else 0


def stick_slip_in(window, segments):
    """Return the `StickSlipSegment` with most events that overlaps a window, or None."""
    about = [part for part in segments if part.begin < window.end and window.begin < part.end]
    return max(about, key=lambda segment: segment.events, default=None)
