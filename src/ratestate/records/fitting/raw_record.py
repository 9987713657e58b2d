"""A record as it is given to `fit`: the columns of its Dataset, each checked.

What a fit makes of it is a `record.Record`, or the segments of a fit of cycles.
"""

import dataclasses
from typing import NamedTuple

import numpy as np
import xarray

from ...model.loading import Loading
from ..reading.segments import find_segments, stored_segments
from ..reading.sizes import check_stress, constant_in_si
from .normal_stress import recorded_stress
from .refusals import refusal

#: least samples
FEWEST = 30
#: bounds of friction, which may be a change from some level; farthest that a load point moves [m]
LOW, HIGH, FARTHEST = -0.1, 3.0, 10.0
#: largest difference of a given loading from the recorded displacement, over the distance moved
DIFFERENCE = 0.1


class RawRecord(NamedTuple):
    """The columns of a record with m samples."""

    data: xarray.Dataset
    time: np.ndarray  # (m,) [s], increasing
    kind: str  # "tau": friction is that of the spring; "mu": of the interface
    friction: np.ndarray  # (m,)
    displacement: np.ndarray | None  # (m,) of the load point [m]

    @property
    def t(self):
        """(m,) times since the first sample [s]."""
        return self.time - self.time[0]


def raw_record(data, slider):
    """The `RawRecord` in a Dataset of `read_lab`, or of `simulate`.

    ParameterError: no Dataset; fewer than `FEWEST` samples; times that do not increase; a variable
    that is absent, not along time alone, or not finite; friction, a displacement, or the slider's
    normal stress, of a size that means other units.
    """
    if slider is not None:
        constant_in_si("sigma", slider.sigma)
    time = checked_time(data)
    kind, friction = _friction(data, slider)
    typical = float(np.median(friction))
    if not LOW < typical < HIGH:
        hint = "turn its sign" if -HIGH < typical < 0.0 else "is it a stress, or in per cent?"
        raise refusal("columns.size", typical=typical, high=HIGH, advice=hint)
    return RawRecord(data, time, kind, friction, _displacement(data, time))


def checked_time(data):
    """(m,) times of a record [s], once its type, number, times and normal stress are checked.

    ParameterError as of `raw_record`.
    """
    if not isinstance(data, xarray.Dataset):
        raise refusal("record.type", type=type(data).__name__)
    time = _column(data, "time")
    if time.size < FEWEST:
        raise refusal("record.few", samples=time.size, fewest=FEWEST)
    if not (np.diff(time) > 0.0).all():
        row = int(np.argmin(np.diff(time) > 0.0)) + 1
        raise refusal("columns.not_increasing", before=time[row - 1], after=time[row], row=row)
    if "sigma" in data.variables and data["sigma"].dims == ("time",):
        sigma = np.asarray(data["sigma"].values, float)
        check_stress(sigma <= 0.0, sigma)  # with gaps, of which a warning tells, it serves
    return time


def _column(data, name):
    """(m,) values of a variable along time [SI]; refuses values that are not finite, by row."""
    if name not in data.variables:
        raise refusal("columns.absent", name=name, variables=_variable_names(data))
    variable = data[name]
    if variable.dims != ("time",):
        raise refusal("columns.dimensions", name=name, dims=variable.dims)
    values = np.ascontiguousarray(variable.values, float)
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise refusal("columns.not_finite", name=name, value=values[row], row=row)
    return values


def _variable_names(data):
    """The names of all variables, as a message lists them."""
    return ", ".join(map(str, data.variables)) or "no variable at all"


def _friction(data, slider):
    """The friction that was recorded: of "tau", the spring, or "mu", the interface; its values."""
    if "friction" in data.variables:
        return "tau", _column(data, "friction")
    names = [name for name in ("tau", "mu") if name in data.variables]
    if len(names) == 2:
        raise refusal("columns.tau_and_mu")
    if not names:
        raise refusal("columns.no_friction", variables=_variable_names(data))
    (kind,) = names
    values = _column(data, kind)
    if kind == "mu":
        return kind, values
    sigma = data["sigma"] if "sigma" in data.variables else slider.sigma
    return kind, values / np.asarray(sigma, float)


def _displacement(data, time):
    """(m,) load-point displacement [m], from the speed where only that was recorded; or None."""
    if "delta_lp" in data.variables:
        displacement = _column(data, "delta_lp")
        if (far := float(np.ptp(displacement))) > FARTHEST:
            raise refusal("columns.far", far=far, farthest=FARTHEST)
        return displacement
    if "V_load" in data.variables:
        V, t = _column(data, "V_load"), time - time[0]
        return np.concatenate([[0.0], np.cumsum(0.5 * (V[1:] + V[:-1]) * np.diff(t))])
    return None


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
        raise refusal("load_point.accelerates")
    return loading


def _load_point_segments(data):
    """(segments,) starts [s] and speeds [m/s] of a record's load point, 0 in a hold."""
    if (stored := stored_segments(data)) is not None:
        return stored
    time = _column(data, "time")
    displacement = _displacement(data, time)
    if displacement is None:
        raise refusal("load_point.unknown", variables=_variable_names(data))
    return find_segments(time, displacement)


def recorded_segments(data, time):
    """Starts (n,) [s], the first at or before the first sample, and speeds (n,) [m/s] of segments.

    time : (m,) of the record [s]

    ParameterError where the load point's motion is not recorded, or has no constant speeds.
    """
    starts, speeds = _load_point_segments(data)
    # a window may have cut off segments at both ends
    inside = starts < time[-1]
    first = max(int(np.searchsorted(starts, time[0], side="right")) - 1, 0)
    return starts[inside][first:], speeds[inside][first:]


def _recorded(raw):
    """The steps and holds of the load point."""
    time = raw.time
    starts, speeds = recorded_segments(raw.data, time)
    if not speeds[0] > 0.0:
        raise refusal("load_point.rests", start=time[0])
    pairs = zip(starts[1:] - time[0], speeds[1:], strict=True)
    return Loading.steps(float(speeds[0]), *((float(t), float(V)) for t, V in pairs))


def _check_given(loading, raw):
    """Refuse a loading that does not suit a fit, or differs from the record in units or times."""
    if not isinstance(loading, Loading) or np.ndim(loading.V) != 1:
        raise refusal("load_point.no_loading")
    loading.covers(raw.time[-1] - raw.time[0])
    if not loading.V[0] > 0.0:
        raise refusal("load_point.begins_at_rest")
    if raw.displacement is None:
        return
    given = np.asarray(loading.delta_lp(raw.t))
    worst, far = float(np.ptp(raw.displacement - given)), float(np.ptp(raw.displacement))
    if worst > DIFFERENCE * far:
        raise refusal("load_point.differs", given=float(given[-1]), far=far, worst=worst)
