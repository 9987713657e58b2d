"""A record as it is given to `fit`: the columns of its Dataset, each checked.

What a fit makes of it is a `record.Record`, or the segments of a fit of cycles.
"""

from typing import NamedTuple

import numpy as np
import xarray

from .messages import raw_record as sentences
from .reading.sizes import check_stress, constant_in_si

#: least samples
FEWEST = 30
#: bounds of friction, which may be a change from some level; farthest that a load point moves [m]
LOW, HIGH, FARTHEST = -0.1, 3.0, 10.0


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
        raise sentences.refusal("columns.size", typical=typical, high=HIGH, advice=hint)
    return RawRecord(data, time, kind, friction, displacement_of(data, time))


def checked_time(data):
    """(m,) times of a record [s], once its type, number, times and normal stress are checked.

    ParameterError as of `raw_record`.
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
        check_stress(sigma <= 0.0, sigma)  # with gaps, of which a warning tells, it serves
    return time


def column(data, name):
    """(m,) values of a variable along time [SI]; refuses values that are not finite, by row."""
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
    """The names of all variables, as a message lists them."""
    return ", ".join(map(str, data.variables)) or "no variable at all"


def _friction(data, slider):
    """The friction that was recorded: of "tau", the spring, or "mu", the interface; its values."""
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
    """(m,) load-point displacement [m], from the speed where only that was recorded; or None."""
    if "delta_lp" in data.variables:
        displacement = column(data, "delta_lp")
        if (far := float(np.ptp(displacement))) > FARTHEST:
            raise sentences.refusal("columns.far", far=far, farthest=FARTHEST)
        return displacement
    if "V_load" in data.variables:
        V, t = column(data, "V_load"), time - time[0]
        return np.concatenate([[0.0], np.cumsum(0.5 * (V[1:] + V[:-1]) * np.diff(t))])
    return None
