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
from ..raw_record import FEWEST, checked_time, column, variable_names
from ..reading.sizes import constant_in_si, typical_stress

#: largest difference of tau from K (delta_lp - delta) of a run's stress without noise, over tau
SAME = 1e-9
#: variables that make a run: with others alone it is the record that somebody has made of one
RUN = {"tau", "V", "V_load", "delta", "delta_lp"}
#: samples in a mean of the normal stress
SMOOTH = 25
#: part by which V_lp may vary during an event, and between events whose recurrence counts
CHANGES = 0.02


class Series(NamedTuple):
    """A record or run of n samples.  Between samples all columns are straight lines."""

    t: np.ndarray  # (n,) [s], increasing
    tau: np.ndarray  # (n,) [Pa]
    sigma: np.ndarray | None  # (n,) [Pa]; None if it is not known
    V_lp: np.ndarray  # (n,) [m/s]
    V_lp_error: np.ndarray  # (n,) [m/s]
    delta_lp: np.ndarray  # (n,) [m]
    K: float | None  # [Pa/m]; None if it is not known
    K_source: str  # sentence of the table `stiffness`
    M: float | None  # [kg/m^2]
    V: np.ndarray | None  # (n,) [m/s], of a run without noise
    resolution: float  # error of tau in a run without noise, or by a record's digits [Pa]
    t_resolution: float = 0.0  # error of times by a record's digits [s]

    def at(self, t, values):
        """A column at times t."""
        return np.interp(t, self.t, values)

    def moved(self, start, end):
        """Displacement of the load point between two times [m]."""
        return self.at(end, self.delta_lp) - self.at(start, self.delta_lp)

    def speed_varies(self, start, end):
        """Whether V_lp varies by more than `CHANGES` of the largest between two times."""
        inside = slice(*np.searchsorted(self.t, (start, end)))
        V = np.append(self.V_lp[inside], self.at([start, end], self.V_lp))
        return bool(np.ptp(V) > CHANGES * np.abs(V).max())


def series_of(data, K=None, M=None, sigma=None):
    """The `Series` of a Dataset of `read_lab` or `simulate`; ParameterError for anything else."""
    if not isinstance(data, xarray.Dataset):
        raise sentences.refusal("data.type", type=type(data).__name__)
    data = in_si(data)
    own = {
        symbol: None if value is None else one_in_si(symbol, value)
        for symbol, value in (("K", K), ("M", M), ("sigma", sigma))
    }
    if data.attrs.get("title") == "ratestate simulate" and {*data.variables} >= RUN:
        return _of_run(data, own)
    return _of_record(data, own)


def _of_run(run, own):
    """The `Series` of a run: without noise, if tau is that of the spring."""
    for dim in run["tau"].dims:
        if dim != "time":
            raise sentences.refusal("data.several", dim=dim)
    if run.sizes.get("time", 1) < FEWEST:
        raise sentences.refusal("data.end_only", times=run.sizes.get("time", 1))
    # (the solver's last step may end where the run does, to the last digit)
    run = run.isel(time=np.append(True, np.diff(run["time"].values) != 0.0))
    t = checked_time(run)
    slider = {symbol: one_in_si(symbol, parameter(run, symbol)) for symbol in ("K", "M", "a")}
    K = slider["K"] if own["K"] is None else own["K"]
    if not np.isfinite(K):
        raise sentences.refusal("data.rigid")
    tau, delta_lp = column(run, "tau"), column(run, "delta_lp")
    if "sigma" in run.data_vars:
        sigma = column(run, "sigma")
    else:
        sigma = np.full(t.size, own["sigma"] or one_in_si("sigma", parameter(run, "sigma")))
    spring = slider["K"] * (delta_lp - column(run, "delta"))
    allowed = SAME * np.abs(tau).max() + 1e-15 * slider["K"] * np.abs(delta_lp).max()
    return Series(
        t=t,
        tau=tau,
        sigma=sigma,
        V_lp=column(run, "V_load"),
        V_lp_error=np.zeros(t.size),
        delta_lp=delta_lp,
        K=K,
        K_source="run" if own["K"] is None else "given",
        M=slider["M"] if own["M"] is None else own["M"],
        V=column(run, "V") if np.abs(tau - spring).max() <= allowed else None,
        resolution=float(run.attrs.get("rtol", 1e-6)) * slider["a"] * float(sigma.max()),
    )


def _of_record(data, own):
    """The `Series` of a laboratory's record."""
    t = checked_time(data)
    sigma, smooth = _normal_stress(data, own["sigma"], t.size)
    if "tau" in data.variables:
        tau = column(data, "tau")
        resolution = rounding(tau)
    elif "friction" not in data.variables:
        raise sentences.refusal("data.no_stress", variables=variable_names(data))
    elif sigma is None:
        raise sentences.refusal("data.no_sigma")
    else:
        friction = column(data, "friction")
        tau, resolution = friction * sigma, rounding(friction) * float(np.abs(sigma).max())
    V_lp, V_lp_error, delta_lp = _recorded_load(data, t)
    return Series(
        t=t,
        tau=tau,
        sigma=smooth,
        V_lp=V_lp,
        V_lp_error=V_lp_error,
        delta_lp=delta_lp,
        K=own["K"],
        K_source="given",
        M=own["M"],
        V=None,
        resolution=resolution,
        # (times of even samples are even to their last digit)
        t_resolution=rounding(np.diff(t)),
    )


def _normal_stress(data, given, samples):
    """Normal stress [Pa] of the samples, and smoothed; None and None if it is not known."""
    if given is not None:
        return (np.full(samples, constant_in_si("sigma", given)),) * 2
    if "sigma" not in data.variables:
        return None, None
    recorded = column(data, "sigma") if data["sigma"].ndim else data["sigma"].values
    typical_stress(recorded)
    sigma = np.resize(recorded, samples)  # one number holds for all samples
    return sigma, uniform_filter1d(sigma, SMOOTH, mode="nearest")


def _recorded_load(data, t):
    """Speed [m/s], its error, and displacement [m] of a record's load point at times t."""
    if (stored := stored_segments(data)) is not None:
        starts, V = stored
        error = data["segment_V_error"].values if "segment_V_error" in data else 0.0 * V
    elif "delta_lp" in data.variables or "V_load" in data.variables:
        name = "delta_lp" if "delta_lp" in data.variables else "V_load"
        find = segments_from_displacement if name == "delta_lp" else segments_from_velocity
        found = find(t, column(data, name))
        starts, V, error = found.t, found.V, found.V_error
    else:
        raise sentences.refusal("data.no_load", variables=variable_names(data))
    ends = np.append(starts, max(t[-1], starts[-1]))
    moved = np.concatenate([[0.0], np.cumsum(V * np.diff(ends))])
    rows = np.maximum(np.searchsorted(starts, t, side="right") - 1, 0)
    return V[rows], error[rows], np.interp(t, ends, moved)
