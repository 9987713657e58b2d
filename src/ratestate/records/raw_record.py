"""The columns of a record's Dataset, each checked, and the loading of a record.

`fit` turns them into `problem.Samples`, or into the segments of a fit of cycles.  The loading is
load-point speeds and normal stress, as given or as recorded.
"""

import dataclasses
from typing import NamedTuple

import numpy as np
import scipy
import xarray

from ..model.history import History
from ..model.loading import Loading
from .kit.sample_noise import sample_noise
from .load_point.segments import Segments, segments_from
from .load_point.stress_steps import VARIABLE, stress_range
from .messages import raw_record as sentences
from .reading.sizes import check_stress, constant_in_si

#: fewest samples
MIN_SAMPLES = 30
#: bounds of friction, which may be a change from some level; longest load-point displacement [m]
MIN_MU, MAX_MU, MAX_DISTANCE = -0.1, 3.0, 10.0
#: largest difference of a given loading from the recorded displacement, as a fraction of its range
MAX_DIFFERENCE = 0.1
#: tolerance of the lines through normal stress: as a multiple of its noise, and at least this
#: fraction of its mean
NOISE_MULTIPLE, MIN_TOLERANCE = 4.0, 1e-6
#: least jump from one sample to the next, as a multiple of that tolerance
JUMP = 5.0
#: most lines; the solver stops at each of their ends
MAX_LINES = 5000


class RawRecord(NamedTuple):
    """The columns of a record with m samples."""

    data: xarray.Dataset
    time: np.ndarray  # (m,) [s], increasing
    kind: str  # "tau": friction is the spring force over sigma; "mu": friction of the interface
    friction: np.ndarray  # (m,)
    displacement: np.ndarray | None  # (m,) load-point displacement [m]

    @property
    def t(self):
        """(m,) times since the first sample [s]."""
        return self.time - self.time[0]


def raw_record(data, slider):
    """Return the `RawRecord` in a Dataset of `read_lab` or `simulate`.

    ParameterError if data is not a Dataset, has fewer than `MIN_SAMPLES` samples, or has times that
    do not increase; if a variable is absent, not along time alone, or not finite; or if the size of
    friction, displacement or the slider's normal stress shows that its unit is wrong.
    """
    if slider is not None:
        constant_in_si("sigma", slider.sigma)
    time = checked_time(data)
    kind, friction = _friction(data, slider)
    typical = float(np.median(friction))
    if not MIN_MU < typical < MAX_MU:
        hint = "Change its sign." if -MAX_MU < typical < 0.0 else "Is it a stress, or in per cent?"
        raise sentences.refusal("columns.size", typical=typical, high=MAX_MU, advice=hint)
    return RawRecord(data, time, kind, friction, displacement_of(data, time))


def checked_time(data):
    """Check the type, size, times and normal stress of a record; return its times (m,) [s].

    ParameterError as for `raw_record`.
    """
    if not isinstance(data, xarray.Dataset):
        raise sentences.refusal("record.type", type=type(data).__name__)
    time = column(data, "time")
    if time.size < MIN_SAMPLES:
        raise sentences.refusal("record.few", samples=time.size, fewest=MIN_SAMPLES)
    if not (np.diff(time) > 0.0).all():
        row = int(np.argmin(np.diff(time) > 0.0)) + 1
        raise sentences.refusal(
            "columns.not_increasing", before=time[row - 1], after=time[row], row=row
        )
    if "sigma" in data.variables and data["sigma"].dims == ("time",):
        sigma = np.asarray(data["sigma"].values, float)
        check_stress(sigma <= 0.0, sigma)  # NaN is allowed; another function warns of it
    return time


def column(data, name):
    """Return the values (m,) of a variable along time [SI]; ParameterError if one is not finite."""
    if name not in data.variables:
        raise sentences.refusal("columns.absent", name=name, variables=variable_names(data))
    variable = data[name]
    if variable.dims != ("time",):
        raise sentences.refusal("columns.dimensions", name=name, dims=variable.dims)
    values = np.ascontiguousarray(variable.values, float)
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise sentences.refusal("columns.not_finite", name=name, value=values[row], row=row)
    return values


def variable_names(data):
    """Return the names of all variables as text for a message."""
    return ", ".join(map(str, data.variables)) or "no variable at all"


def _friction(data, slider):
    """Return the kind of friction that was recorded ("tau" or "mu") and its values (m,)."""
    if "friction" in data.variables:
        return "tau", column(data, "friction")
    names = [name for name in ("tau", "mu") if name in data.variables]
    if len(names) == 2:
        raise sentences.refusal("columns.tau_and_mu")
    if not names:
        raise sentences.refusal("columns.no_friction", variables=variable_names(data))
    (kind,) = names
    values = column(data, kind)
    if kind == "mu":
        return kind, values
    sigma = data["sigma"] if "sigma" in data.variables else slider.sigma
    return kind, values / np.asarray(sigma, float)


def displacement_of(data, time):
    """Return the load-point displacement (m,) [m], integrated from V_load if need be, or None."""
    if "delta_lp" in data.variables:
        displacement = column(data, "delta_lp")
        if (distance := float(np.ptp(displacement))) > MAX_DISTANCE:
            raise sentences.refusal("columns.far", far=distance, farthest=MAX_DISTANCE)
        return displacement
    if "V_load" in data.variables:
        V, t = column(data, "V_load"), time - time[0]
        return np.concatenate([[0.0], np.cumsum(0.5 * (V[1:] + V[:-1]) * np.diff(t))])
    return None


def loading_of(raw, loading=None, sigma=None, segments=None):
    """Return the `Loading` of a record, with t = 0 at the first sample: as given or as recorded.

    sigma : normal stress of the slider [Pa]; with it, a recorded normal stress that varies is added
    segments : the `recorded_segments`, if they are known

    ParameterError if no motion is recorded, the record begins at rest, or the given loading has
    several cases, is too short, or differs from the recorded displacement by more than
    `MAX_DIFFERENCE`.
    """
    if loading is None:
        segments, start = segments or recorded_segments(raw.data, raw.time), float(raw.time[0])
        if not segments.V[0] > 0.0:
            raise sentences.refusal("load_point.rests", start=start)
        pairs = zip((segments.t[1:] - start).tolist(), segments.V[1:].tolist(), strict=True)
        loading = Loading.steps(float(segments.V[0]), *pairs)
    else:
        _check_given(loading, raw)
    if sigma is None or loading.normal_stress is not None:
        return loading
    return dataclasses.replace(loading, normal_stress=recorded_stress(raw.data, raw.t, sigma))


def constant_speeds_of(raw, loading=None):
    """Return `loading_of` the record; ParameterError if the load point accelerates."""
    loading = loading_of(raw, loading)
    if np.any(loading.rate):
        raise sentences.refusal("load_point.accelerates")
    return loading


def recorded_segments(data, time):
    """Return the recorded `Segments`, overshoots included.

    time : (m,) times of the record [s]; the first segment starts at or before time[0]

    ParameterError if the load point's motion is not recorded or has no constant speeds, or if
    stored segments are incomplete, empty or out of order.
    """
    segments = _stored_segments(data, float(time[-1]))
    if segments is None:
        names = [name for name in ("delta_lp", "V_load") if name in data.variables]
        if not names:
            raise sentences.refusal("load_point.unknown", variables=variable_names(data))
        segments = segments_from(column(data, "time"), {name: column(data, name) for name in names})
    # a window may have cut off segments at both ends
    inside = slice(segments.at(time[0]), np.searchsorted(segments.t, time[-1]))
    columns = ("t", "V", "t_error", "V_error")
    parts = {name: getattr(segments, name)[inside] for name in columns}
    return segments._replace(end=float(time[-1]), **parts)


def _stored_segments(data, end):
    """Return the `Segments` that `read_lab` stored, up to this end [s]; None if none.

    Errors that are not stored are 0.
    """
    names = ("segment_t", "segment_V")
    if not any(name in data.variables for name in names):
        return None
    stored = [data[name].values for name in names if name in data.variables]
    usable = all(array.ndim == 1 and array.size and array.dtype.kind in "iuf" for array in stored)
    usable = usable and len(stored) == 2 and bool(np.isfinite(stored).all())
    if not usable or (np.diff(stored[0]) <= 0.0).any():
        raise sentences.refusal("load_point.altered")
    t, V = (array.astype(float) for array in stored)
    t_error, V_error = (np.asarray(data.get(f"{s}_error", 0.0 * t), float) for s in names)
    return Segments(t, V, end, t_error, V_error)


def _check_given(loading, raw):
    if not isinstance(loading, Loading) or np.ndim(loading.V) != 1:
        raise sentences.refusal("load_point.no_loading")
    loading.covers(raw.time[-1] - raw.time[0])
    if not loading.V[0] > 0.0:
        raise sentences.refusal("load_point.begins_at_rest")
    if raw.displacement is None:
        return
    given = np.asarray(loading.delta_lp(raw.t))
    worst, span = float(np.ptp(raw.displacement - given)), float(np.ptp(raw.displacement))
    if worst > MAX_DIFFERENCE * span:
        raise sentences.refusal("load_point.differs", given=float(given[-1]), far=span, worst=worst)


def segments_of(raw, loading=None):
    """Return the `Segments` of a `RawRecord`: as recorded, or of a loading.

    In a given loading, t = 0 is the first sample, and no segment counts as an overshoot.
    """
    if loading is None:
        return recorded_segments(raw.data, raw.time).without_overshoots()
    checked = constant_speeds_of(raw, loading)
    zeros = np.zeros(checked.t.size)
    t, V = raw.time[0] + checked.t, np.asarray(checked.V, float)
    return Segments(t, V, float(raw.time[-1]), zeros, zeros)


def recorded_stress(data, t, sigma):
    """Return the recorded normal stress as a `History` that begins at sigma; None if constant.

    data : Dataset, with or without ``sigma`` along time
    t : (m,) times since the first sample [s]
    sigma : normal stress of the slider [Pa]

    ParameterError if it needs more than `MAX_LINES` straight lines.
    """
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return None
    recorded = np.asarray(data["sigma"].values, float)
    if not np.isfinite(recorded).all() or stress_range(data) <= VARIABLE:
        return None
    tolerance = max(NOISE_MULTIPLE * sample_noise(recorded), MIN_TOLERANCE * recorded.mean())
    knots = polyline_corners(t, recorded, tolerance)
    if knots.size > MAX_LINES:
        raise sentences.refusal("record.stress_lines", lines=knots.size, most=MAX_LINES)
    at = t[knots]
    values = scipy.interpolate.make_lsq_spline(t, recorded, [at[0], *at, at[-1]], 1).c
    values *= sigma / values[0]
    end = np.append(values[1:], values[-1])
    # a steep line from one sample to the next is a jump at the later sample
    jumps = np.diff(knots, append=t.size) == 1
    jumps &= np.abs(end - values) > JUMP * tolerance
    end[jumps] = values[jumps]
    return History("sigma", at, values, end)


def polyline_corners(t, values, tolerance):
    """Return the corners (rows) of a polyline that follows the values within the tolerance.

    Douglas & Peucker's algorithm: the row farthest from the line between two corners becomes a
    corner.
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
        distances = np.abs(values[inside] - values[first] - slope * (t[inside] - t[first]))
        farthest = int(np.argmax(distances))
        if distances[farthest] > tolerance:
            middle = first + 1 + farthest
            kept[middle] = True
            open_ends += [(first, middle), (middle, last)]
    return np.flatnonzero(kept)
