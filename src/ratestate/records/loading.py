"""The loading of a record: speeds of its load point and normal stress, given or as recorded."""

import dataclasses
from typing import NamedTuple

import numpy as np
from scipy.interpolate import make_lsq_spline

from ..model.history import NormalStress
from ..model.loading import Loading
from .kit.sample_noise import sample_noise
from .load_point.segments import find_segments, stored_segments, without_overshoots
from .load_point.stress_steps import VARIABLE, stress_range
from .messages import raw_record as sentences
from .raw_record import column, displacement_of, variable_names

#: largest difference of a given loading from the recorded displacement, over the distance moved
DIFFERENCE = 0.1
#: of the noise, by which lines of normal stress may miss samples; of the mean, if there is no noise
NOISES, LEAST = 4.0, 1e-6
#: tolerances by which a change from one sample to the next is a jump
JUMP = 5.0
#: most lines: each is a break at which all sliders stop
MOST = 5000


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


def loading_of(raw, loading=None, sigma=None):
    """The `Loading` from the record's first sample on: the one given, or as recorded.

    With the normal stress that was recorded, if it varies and the sigma of the slider [Pa] is
    given.

    ParameterError: none is recorded; it begins at rest; the one given is many, is too short, or is
    off the recorded displacement by more than `DIFFERENCE`.
    """
    if loading is None:
        loading = _recorded(raw)
    else:
        _check_given(loading, raw)
    if sigma is None or loading.normal_stress is not None:
        return loading
    return dataclasses.replace(loading, normal_stress=recorded_stress(raw.data, raw.t, sigma))


def constant_speeds_of(raw, loading=None):
    """Return the `Loading` as of `loading_of`; ParameterError if the load point accelerates."""
    loading = loading_of(raw, loading)
    if np.any(loading.rate):
        raise sentences.refusal("load_point.accelerates")
    return loading


def recorded_segments(data, time):
    """Starts (n,) [s], the first at or before the first sample, and speeds (n,) [m/s] of segments.

    time : (m,) of the record [s]

    ParameterError where the load point's motion is not recorded, or has no constant speeds.
    """
    segments = stored_segments(data)
    if segments is None:
        times = column(data, "time")
        displacement = displacement_of(data, times)
        if displacement is None:
            raise sentences.refusal("load_point.unknown", variables=variable_names(data))
        segments = find_segments(times, displacement)
    starts, speeds = segments
    # a window may have cut off segments at both ends
    inside = starts < time[-1]
    first = max(int(np.searchsorted(starts, time[0], side="right")) - 1, 0)
    return starts[inside][first:], speeds[inside][first:]


def _recorded(raw):
    """The steps and holds of the load point."""
    time = raw.time
    starts, speeds = recorded_segments(raw.data, time)
    if not speeds[0] > 0.0:
        raise sentences.refusal("load_point.rests", start=time[0])
    pairs = zip(starts[1:] - time[0], speeds[1:], strict=True)
    return Loading.steps(float(speeds[0]), *((float(t), float(V)) for t, V in pairs))


def _check_given(loading, raw):
    """Refuse a loading that does not suit a fit, or differs from the record in units or times."""
    if not isinstance(loading, Loading) or np.ndim(loading.V) != 1:
        raise sentences.refusal("load_point.no_loading")
    loading.covers(raw.time[-1] - raw.time[0])
    if not loading.V[0] > 0.0:
        raise sentences.refusal("load_point.begins_at_rest")
    if raw.displacement is None:
        return
    given = np.asarray(loading.delta_lp(raw.t))
    worst, far = float(np.ptp(raw.displacement - given)), float(np.ptp(raw.displacement))
    if worst > DIFFERENCE * far:
        raise sentences.refusal("load_point.differs", given=float(given[-1]), far=far, worst=worst)


def segments_of(raw, loading=None):
    """The `Segments` of a `RawRecord`, as recorded or of a loading (t = 0 at the first sample).

    A loading that is given has no overshoots.
    """
    end = float(raw.time[-1])
    if loading is None:
        all_t, all_V = recorded_segments(raw.data, raw.time)
        t, V, _ = without_overshoots(all_t, all_V, end)
        errors = np.zeros(t.size)
        if "segment_t_error" in raw.data.variables:
            at = np.searchsorted(raw.data["segment_t"].values, t)
            errors = np.asarray(raw.data["segment_t_error"].values, float)[at]
        return Segments(t, V, end, errors, all_t, all_V)
    checked = constant_speeds_of(raw, loading)
    t, V = raw.time[0] + checked.t, np.asarray(checked.V, float)
    return Segments(t, V, end, np.zeros(t.size), t, V)


def recorded_stress(data, t, sigma):
    """`NormalStress` of a record with a normal stress that varies, else None.

    In proportion, from the slider's sigma on.  ParameterError where it has too many lines.

    data : the Dataset, with ``sigma`` along time or not; t : (m,) times from its first sample on
    sigma : of the slider [Pa]
    """
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return None
    recorded = np.asarray(data["sigma"].values, float)
    if not np.isfinite(recorded).all() or stress_range(data) <= VARIABLE:
        return None
    tolerance = max(NOISES * sample_noise(recorded), LEAST * recorded.mean())
    knots = corners(t, recorded, tolerance)
    if knots.size > MOST:
        raise sentences.refusal("record.stress_lines", lines=knots.size, most=MOST)
    at = t[knots]
    values = make_lsq_spline(t, recorded, [at[0], *at, at[-1]], 1).c
    values *= sigma / values[0]
    end = np.append(values[1:], values[-1])
    # from one sample to the next it jumps, and the later one is after it
    jumps = np.diff(knots, append=t.size) == 1
    jumps &= np.abs(end - values) > JUMP * tolerance
    end[jumps] = values[jumps]
    return NormalStress(at, values, end)


def corners(t, values, tolerance):
    """Rows (k,) between which straight lines pass all values within the tolerance.

    By Douglas & Peucker: the row farthest from a line between two others becomes a corner.
    """
    kept = np.zeros(t.size, bool)
    kept[[0, -1]] = True
    open_ends = [(0, t.size - 1)]
    while open_ends:
        first, last = open_ends.pop()
        if last - first < 2:
            continue
        inside = slice(first + 1, last)
        slope = (values[last] - values[first]) / (t[last] - t[first])
        off = np.abs(values[inside] - values[first] - slope * (t[inside] - t[first]))
        farthest = int(np.argmax(off))
        if off[farthest] > tolerance:
            middle = first + 1 + farthest
            kept[middle] = True
            open_ends += [(first, middle), (middle, last)]
    return np.flatnonzero(kept)
