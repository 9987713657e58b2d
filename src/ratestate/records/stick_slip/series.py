"""Shear stress and load point of a record or a run, checked and in SI."""

from typing import NamedTuple

import numpy as np
import xarray
from scipy.ndimage import uniform_filter1d

from ...dynamics.results import parameter
from ...model.conversion import in_si
from ...model.units import one_in_si
from ..kit.sample_noise import rounding
from ..load_point.segments import (
    segments_from_displacement,
    segments_from_velocity,
    stored_segments,
)
from ..messages import stick_slip as sentences
from ..reading.sizes import constant_in_si, typical_stress

#: least samples
FEWEST = 30
#: largest difference of tau from K (delta_lp - delta) of a run's stress without noise, over tau
SAME = 1e-9
#: variables that make a run: with others alone it is the record that somebody has made of one
RUN = {"tau", "V", "V_load", "delta", "delta_lp"}
#: samples in a mean of the normal stress
SMOOTH = 25


class Load(NamedTuple):
    """The load point: speeds that are linear between times, one of which may be there twice."""

    t: np.ndarray  # (k,) [s]
    V: np.ndarray  # (k,) [m/s]
    V_error: np.ndarray  # (k,) [m/s]
    displacement: np.ndarray  # (k,) [m]

    def speed(self, t):
        """Speed at times t, and its standard error [m/s]."""
        return np.interp(t, self.t, self.V), np.interp(t, self.t, self.V_error)

    def moved(self, start, end):
        """Displacement between two times [m]."""
        return np.interp(end, self.t, self.displacement) - np.interp(
            start, self.t, self.displacement
        )

    def varies(self, start, end, allowed):
        """Whether the speed varies by more than this part of the largest between two times."""
        inside = self.V[(self.t > start) & (self.t < end)]
        V = np.concatenate([inside, self.speed(np.array([start, end]))[0]])
        return bool(np.ptp(V) > allowed * np.abs(V).max())


class Series(NamedTuple):
    """A record or run of n samples."""

    t: np.ndarray  # (n,) [s], increasing
    tau: np.ndarray  # (n,) [Pa]
    sigma: np.ndarray | None  # (n,) [Pa]; None where it is not known
    load: Load
    K: float | None  # [Pa/m]; None where it is not known
    K_error: float  # [Pa/m]
    K_source: str  # sentence of the table `stiffness`
    M: float | None  # [kg/m^2]
    V: np.ndarray | None  # (n,) [m/s], of a run without noise
    resolution: float  # error of tau in a run without noise, or by a record's digits [Pa]
    t_resolution: float = 0.0  # error of times by a record's digits [s]


def series_of(data, K=None, M=None, sigma=None):
    """The `Series` of a Dataset of `read_lab` or `simulate`; ParameterError for what is none."""
    if not isinstance(data, xarray.Dataset):
        raise sentences.refusal("data.type", type=type(data).__name__)
    data = in_si(data)
    own = {symbol: _scalar(symbol, x) for symbol, x in (("K", K), ("M", M), ("sigma", sigma))}
    is_run = data.attrs.get("title") == "ratestate simulate" and {*data.variables} >= RUN
    if is_run:
        _check_run(data)
        # (the solver's last step may end where the run does, to the last digit)
        data = data.isel(time=np.append(True, np.diff(data["time"].values) != 0.0))
    t = _column(data, "time")
    if t.size < FEWEST:
        raise sentences.refusal("data.few", samples=t.size, fewest=FEWEST)
    if not (np.diff(t) > 0.0).all():
        row = int(np.argmin(np.diff(t) > 0.0)) + 1
        raise sentences.refusal(
            "data.not_increasing", before=float(t[row - 1]), after=float(t[row]), row=row
        )
    return _of_run(data, t, own) if is_run else _of_record(data, t, own)


def _check_run(run):
    """ParameterError for a sweep, and a run of which only the ends were saved."""
    for dim in run["tau"].dims if "tau" in run else ():
        if dim != "time":
            raise sentences.refusal("data.several", dim=dim)
    if run.sizes.get("time", 1) < FEWEST:
        raise sentences.refusal("data.end_only", times=run.sizes.get("time", 1))


def _of_run(run, t, own):
    """The `Series` of a run: without noise, if tau is that of the spring."""
    slider = {symbol: _scalar(symbol, parameter(run, symbol)) for symbol in ("K", "M", "a")}
    K = slider["K"] if own["K"] is None else own["K"]
    if not np.isfinite(K):
        raise sentences.refusal("data.rigid")
    tau, delta_lp = _column(run, "tau"), _column(run, "delta_lp")
    sigma = _column(run, "sigma") if "sigma" in run.data_vars else None
    if sigma is None:
        sigma = np.full(t.size, own["sigma"] or _scalar("sigma", parameter(run, "sigma")))
    spring = slider["K"] * (delta_lp - _column(run, "delta"))
    allowed = SAME * np.abs(tau).max() + 1e-15 * slider["K"] * np.abs(delta_lp).max()
    exact = np.abs(tau - spring).max() <= allowed
    V_load = _column(run, "V_load")
    return Series(
        t=t,
        tau=tau,
        sigma=sigma,
        load=Load(t, V_load, np.zeros(t.size), delta_lp),
        K=K,
        K_error=0.0,
        K_source="run" if own["K"] is None else "given",
        M=slider["M"] if own["M"] is None else own["M"],
        V=_column(run, "V") if exact else None,
        resolution=float(run.attrs.get("rtol", 1e-6)) * slider["a"] * float(sigma.max()),
    )


def _of_record(data, t, own):
    """The `Series` of a laboratory's record."""
    given = own["sigma"]
    sigma = None if given is None else np.full(t.size, constant_in_si("sigma", given))
    recorded = _column(data, "sigma") if "sigma" in data.variables and sigma is None else None
    if recorded is not None:
        typical_stress(recorded)
        recorded = np.resize(recorded, t.size)  # one number holds for all samples
    sigma = recorded if sigma is None else sigma
    resolution = 0.0
    if "tau" in data.variables:
        tau = _column(data, "tau")
        resolution = rounding(tau)
    elif "friction" not in data.variables:
        raise sentences.refusal("data.no_stress", variables=_names(data))
    elif sigma is None:
        raise sentences.refusal("data.no_sigma")
    else:
        friction = _column(data, "friction")
        tau, resolution = friction * sigma, rounding(friction) * float(np.abs(sigma).max())
    if recorded is not None:
        sigma = uniform_filter1d(recorded, SMOOTH, mode="nearest")
    return Series(
        t=t,
        tau=tau,
        sigma=sigma,
        load=_recorded_load(data, t),
        K=own["K"],
        K_error=0.0,
        K_source="given",
        M=own["M"],
        V=None,
        resolution=resolution,
        # (times of even samples are even to their last digit)
        t_resolution=rounding(np.diff(t)),
    )


def _recorded_load(data, t):
    """The `Load` of a record: the constant speeds found in it."""
    if (stored := stored_segments(data)) is not None:
        starts, V = stored
        error = _values(data["segment_V_error"]) if "segment_V_error" in data else np.zeros(V.size)
    elif "delta_lp" in data.variables or "V_load" in data.variables:
        name = "delta_lp" if "delta_lp" in data.variables else "V_load"
        find = segments_from_displacement if name == "delta_lp" else segments_from_velocity
        found = find(t, _column(data, name))
        starts, V, error = found.t, found.V, found.V_error
    else:
        raise sentences.refusal("data.no_load", variables=_names(data))
    ends = np.append(starts[1:], max(t[-1], starts[-1]))
    times = np.column_stack([starts, ends]).ravel()
    moved = np.concatenate([[0.0], np.cumsum(V * (ends - starts))])
    displacement = np.column_stack([moved[:-1], moved[1:]]).ravel()
    return Load(times, np.repeat(V, 2), np.repeat(error, 2), displacement)


def _scalar(symbol, value):
    return None if value is None else one_in_si(symbol, value)


def _column(data, name):
    """(n,) finite values of a variable along time [SI]."""
    if name not in data.variables:
        raise sentences.refusal("data.absent", name=name, variables=_names(data))
    variable = data[name]
    for dim in variable.dims:
        if dim != "time":
            raise sentences.refusal("data.several", dim=dim)
    values = np.atleast_1d(_values(variable))
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise sentences.refusal("data.not_finite", name=name, value=float(values[row]), row=row)
    return values


def _values(variable):
    return np.ascontiguousarray(variable.values, float)


def _names(data):
    """The names of all variables, as a message lists them."""
    return ", ".join(map(str, data.variables)) or "no variable at all"
