"""The columns of a record's Dataset, each checked.

`fit` turns them into a `samples.Samples`, or into the segments of a fit of cycles.
"""

from typing import NamedTuple

import numpy as np
import xarray

from .messages import raw_record as sentences
from .reading.sizes import check_stress, constant_in_si

#: fewest samples
FEWEST = 30
#: bounds of friction, which may be a change from some level; longest load-point displacement [m]
MIN_MU, MAX_MU, MAX_DISTANCE = -0.1, 3.0, 10.0


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

    ParameterError if data is not a Dataset, has fewer than `FEWEST` samples, or has times that do
    not increase; if a variable is absent, not along time alone, or not finite; or if the size of
    friction, displacement or the slider's normal stress shows that its unit is wrong.
    """
    if slider is not None:
        constant_in_si("sigma", slider.sigma)
    time = checked_time(data)
    kind, friction = _friction(data, slider)
    typical = float(np.median(friction))
    if not MIN_MU < typical < MAX_MU:
        hint = "Turn its sign." if -MAX_MU < typical < 0.0 else "Is it a stress, or in per cent?"
        raise sentences.refusal("columns.size", typical=typical, high=MAX_MU, advice=hint)
    return RawRecord(data, time, kind, friction, displacement_of(data, time))


def checked_time(data):
    """Check the type, size, times and normal stress of a record; return its times (m,) [s].

    ParameterError as for `raw_record`.
    """
    if not isinstance(data, xarray.Dataset):
        raise sentences.refusal("record.type", type=type(data).__name__)
    time = column(data, "time")
    if time.size < FEWEST:
        raise sentences.refusal("record.few", samples=time.size, fewest=FEWEST)
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
        if (far := float(np.ptp(displacement))) > MAX_DISTANCE:
            raise sentences.refusal("columns.far", far=far, farthest=MAX_DISTANCE)
        return displacement
    if "V_load" in data.variables:
        V, t = column(data, "V_load"), time - time[0]
        return np.concatenate([[0.0], np.cumsum(0.5 * (V[1:] + V[:-1]) * np.diff(t))])
    return None
