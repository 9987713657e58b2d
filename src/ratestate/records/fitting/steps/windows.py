"""Windows of a record: each step and hold with the sliding before it and after.

No step can be fitted in a slide that is stick-slip.  The events and the test of their significance
are those of `events`.  Of noise that wanders, that test accepts some: here a slide needs several
events, which make up much of the range of friction.
"""

from typing import NamedTuple

import numpy as np

from ....errors import RateStateError
from ...load_point.segments import without_overshoots
from ...load_point.stress_steps import stress_steps
from ...loading import recorded_segments
from ...messages import fitting as sentences
from ...raw_record import checked_time
from ...stick_slip.detection import detected
from ...stick_slip.series import series_of

#: part of the sliding before a change that belongs to its window: the change before it is over
LEAD = 0.5
#: fewest rows there, as far as there are as many
ROWS = 50
#: fewest events at one speed, and least drop of a typical one, over the range of friction there
FEWEST, DROP = 4, 1.0 / 3.0


class Window(NamedTuple):
    """A step or hold, and the part of the record in which it is fitted."""

    kind: str  # "step" and "hold" of the load point, or "normal stress"
    t: float  # when it begins [s]
    begin: float  # of the window [s]
    end: float  # [s]; the first time that is not in it
    V_before: float  # of the load point [m/s]
    V_after: float
    t_hold: float  # how long the load point rests [s]; NaN unless it is a hold
    slip_since_change: float  # how far it moves from the change before to the window's begin [m]

    @property
    def rise(self):
        """How much the speed of the load point rises at a step [m/s]; 0 if it is none of speed."""
        return self.V_after - self.V_before if self.kind == "step" else 0.0

    def part(self, data):
        """The rows of a record (Dataset) in the window."""
        time = data["time"].values
        return data.isel(time=slice(*np.searchsorted(time, (self.begin, self.end)).tolist()))

    def stress_levels(self, part):
        """Normal stress [Pa] before a step of it, and after; part : the rows of the window."""
        time, sigma = part["time"], part["sigma"]
        return tuple(float(sigma.where(side).median()) for side in (time < self.t, time > self.t))


class _Change(NamedTuple):
    """A change of speed or normal stress."""

    t: float
    V: float  # of the load point from there on
    is_of_stress: bool
    end: float  # when it is over: a ramp of normal stress lasts


def windows_of(data):
    """The `Window`s (list) of a record, a Dataset in SI, in order of time.

    A hold lasts until the end of the sliding after it.  Steps and ramps of normal stress are those
    of `stress_steps`.  ParameterError as of `checked_time` and `recorded_segments`, and: no step
    or hold that follows on sliding.
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
        begin = _window_begin(time, before, change, after)
        windows.append(
            Window(
                "normal stress" if change.is_of_stress else "hold" if is_hold else "step",
                change.t,
                begin,
                after.t,
                before.V,
                changes[i + 1].V if is_hold else change.V,
                changes[i + 1].t - change.t if is_hold else np.nan,
                np.inf if i == 1 else before.V * (begin - _end_of_change(before, change)),
            )
        )
    if not windows:
        raise sentences.refusal("each.no_step")
    return windows


def _changes(data):
    """`_Change`s (list), the first at the record's start, the last at its end."""
    time = data["time"].values
    found, of_each = recorded_segments(data, time)
    starts, speeds, _ = without_overshoots(found, of_each, time[-1])
    pairs = zip(starts.tolist(), speeds.tolist(), strict=True)
    changes = [_Change(t, V, False, t) for t, V in pairs][1:]
    has_stress = "sigma" in data.variables and data["sigma"].dims == ("time",)
    for t, _, _, over in stress_steps(time, data["sigma"].values) if has_stress else ():
        V = speeds[max(int(np.searchsorted(starts, t, side="right")) - 1, 0)]
        changes.append(_Change(t, float(V), True, over))
    end = float(time[-1]) + 0.5 * float(np.median(np.diff(time)))
    begin = float(time[0])
    first, last = _Change(begin, float(speeds[0]), False, begin), _Change(end, np.nan, False, end)
    return [first, *sorted(changes), last]


def _end_of_change(before, change):
    """When the change before another is over [s]; when it begins, if that comes too late."""
    return before.end if before.end < change.t else before.t


def _window_begin(time, before, change, after):
    """Where the window of a change begins [s].

    It has no more sliding before the change than after it, in displacement, but `ROWS` rows of it.
    """
    moved = max(change.V, before.V) * (after.t - change.t)
    over = _end_of_change(before, change)
    lead = min(LEAD * (change.t - over), moved / before.V)
    rows = np.searchsorted(time, change.t) - np.searchsorted(time, change.t - lead)
    if rows < ROWS:
        at = max(int(np.searchsorted(time, change.t)) - ROWS, 0)
        lead = max(lead, change.t - max(float(time[at]), over))
    return change.t - lead


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


def stick_slip_in(window, slides):
    """The stick-slip `Slide` with most events that overlaps a `Window`, or None."""
    about = [one for one in slides if one.begin < window.end and window.begin < one.end]
    return max(about, key=lambda one: one.events, default=None)
