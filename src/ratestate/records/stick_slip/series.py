"""Checked shear stress and load point of a record or a run, in SI."""

from typing import NamedTuple

import numpy as np
import scipy
import xarray

from ...dynamics.results import parameter
from ...model.conversion import in_si
from ...model.units import one_in_si
from ..kit.sample_noise import rounding
from ..messages import stick_slip as sentences
from ..raw_record import MIN_SAMPLES, checked_time, column, recorded_segments, variable_names
from ..reading.sizes import constant_in_si, typical_stress

#: largest relative difference between tau and K (delta_lp - delta) in a run without added noise
MAX_DIFFERENCE = 1e-9
#: variables of a run; a Dataset without some of them is treated as a record
RUN = {"tau", "V", "V_load", "delta", "delta_lp"}
#: samples in the moving average of the normal stress
SMOOTH = 25
#: largest relative variation of V_lp during an event, and during a recurrence interval
CHANGES = 0.02


class Series(NamedTuple):
    """A record or run of n samples.  Columns are interpolated linearly between samples."""

    t: np.ndarray  # (n,) [s], increasing
    tau: np.ndarray  # (n,) [Pa]
    resolution: float  # error of tau [Pa]: the solver's, or the rounding of a record
    V_lp: np.ndarray  # (n,) [m/s]
    V_lp_error: np.ndarray  # (n,) [m/s]
    delta_lp: np.ndarray  # (n,) [m]
    sigma: np.ndarray | None = None  # (n,) [Pa]; None if it is unknown
    K: float | None = None  # [Pa/m]; None if it is unknown
    K_source: str = "given"  # name of a message in the table `stiffness`
    M: float | None = None  # [kg/m^2]; None if it is unknown
    V: np.ndarray | None = None  # (n,) [m/s]; None for a record, and for a run with added noise
    t_resolution: float = 0.0  # error of times by the rounding of a record [s]

    def at(self, t, values):
        """Interpolate a column at times t."""
        return np.interp(t, self.t, values)

    def speed_varies(self, start, end):
        """Return whether V_lp varies by more than `CHANGES` of its maximum between two times."""
        inside = slice(*np.searchsorted(self.t, (start, end)))
        V = np.append(self.V_lp[inside], self.at([start, end], self.V_lp))
        return bool(np.ptp(V) > CHANGES * np.abs(V).max())


def series_of(data, K=None, M=None, sigma=None):
    """Return the `Series` of a Dataset from `read_lab` or `simulate`, or raise ParameterError."""
    if not isinstance(data, xarray.Dataset):
        raise sentences.refusal("data.type", type=type(data).__name__)
    data = in_si(data)
    given = {
        symbol: None if value is None else one_in_si(symbol, value)
        for symbol, value in (("K", K), ("M", M), ("sigma", sigma))
    }
    if data.attrs.get("title") == "ratestate simulate" and {*data.variables} >= RUN:
        return _series_of_run(data, given)
    return _series_of_record(data, given)


def _series_of_run(run, given):
    """Return the `Series` of a run, with V unless tau differs from the spring's stress."""
    for dim in run["tau"].dims:
        if dim != "time":
            raise sentences.refusal("data.several", dim=dim)
    if run.sizes.get("time", 1) < MIN_SAMPLES:
        raise sentences.refusal("data.end_only", times=run.sizes.get("time", 1))
    # (the solver's last step may end at the run's last saved time, which is then repeated)
    run = run.isel(time=np.append(True, np.diff(run["time"].values) != 0.0))
    t = checked_time(run)
    slider = {symbol: one_in_si(symbol, parameter(run, symbol)) for symbol in ("K", "M", "a")}
    K = slider["K"] if given["K"] is None else given["K"]
    if not np.isfinite(K):
        raise sentences.refusal("data.rigid")
    tau, delta_lp = column(run, "tau"), column(run, "delta_lp")
    if "sigma" in run.data_vars:
        sigma = column(run, "sigma")
    else:
        sigma = np.full(t.size, given["sigma"] or one_in_si("sigma", parameter(run, "sigma")))
    spring = slider["K"] * (delta_lp - column(run, "delta"))
    limit = MAX_DIFFERENCE * np.abs(tau).max() + 1e-15 * slider["K"] * np.abs(delta_lp).max()
    return Series(
        t,
        tau,
        parameter(run, "rtol") * slider["a"] * float(sigma.max()),
        *(column(run, "V_load"), np.zeros(t.size), delta_lp),
        sigma=sigma,
        K=K,
        K_source="run" if given["K"] is None else "given",
        M=slider["M"] if given["M"] is None else given["M"],
        V=column(run, "V") if np.abs(tau - spring).max() <= limit else None,
    )


def _series_of_record(data, given):
    t = checked_time(data)
    sigma, smooth = _normal_stress(data, given["sigma"], t.size)
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
    if not {"delta_lp", "V_load", "segment_t", "segment_V"} & {*data.variables}:
        raise sentences.refusal("data.no_load", variables=variable_names(data))
    series = record_series(t, tau, recorded_segments(data, t), resolution)
    return series._replace(sigma=smooth, K=given["K"], M=given["M"])


def record_series(t, tau, segments, resolution):
    """Return the `Series` of a record with these `Segments` and the resolution of tau."""
    number = segments.at(t)
    load_point = segments.V[number], segments.V_error[number], segments.displacement(t)
    # (differences, because evenly spaced times show no rounding)
    return Series(t, tau, resolution, *load_point, t_resolution=rounding(np.diff(t)))


def _normal_stress(data, given, samples):
    """Return the normal stress [Pa] of the samples, and smoothed; (None, None) if unknown."""
    if given is not None:
        return (np.full(samples, constant_in_si("sigma", given)),) * 2
    if "sigma" not in data.variables:
        return None, None
    recorded = column(data, "sigma") if data["sigma"].ndim else data["sigma"].values
    typical_stress(recorded)
    sigma = np.resize(recorded, samples)  # one number holds for all samples
    return sigma, scipy.ndimage.uniform_filter1d(sigma, SMOOTH, mode="nearest")
