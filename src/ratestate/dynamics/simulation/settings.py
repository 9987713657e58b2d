"""Arguments of `simulate`, checked: the method with its accuracy or step, and the saved times."""

import numpy as np

from ...engine.model import METHODS
from ...errors import ParameterError
from ...model.arrays import column
from ...model.units import is_array, to_si


def checked_rtol(rtol, least, most, example):
    """A relative tolerance as a float; ParameterError beyond these bounds, which are texts."""
    rtol = to_si("rtol", rtol)
    if is_array(rtol) or not float(least) <= rtol <= float(most):
        raise ParameterError(
            f"rtol = {rtol!r} is out of range; expected one number from {least} to {most} such as "
            f"{example}"
        )
    return rtol


def solver_settings(rtol, method, dt, slider):
    """rtol and dt as floats, checked against the method."""
    rtol = checked_rtol(rtol, "1e-13", "0.1", "1e-6")
    if not isinstance(method, str) or method not in METHODS:
        raise ParameterError(f"method = {method!r} is unknown; choose one of {', '.join(METHODS)}")
    needs = METHODS[method]
    if not needs.needs_dt and dt is not None:
        raise ParameterError(f"dt = {dt!r}: {method} chooses its steps itself; leave dt out")
    if needs.needs_dt:
        if dt is None:
            raise ParameterError(
                f"{method} needs a time step: give dt [s], for example dt=0.05/(2*pi*slider.f_n)"
            )
        dt = to_si("dt", dt)
        if is_array(dt):
            raise ParameterError("dt must be one number, common to all cases")
    if needs.needs_mass:
        _check_oscillation(method, dt, slider)
    if slider.law not in needs.laws:
        other = next(
            name
            for name, row in METHODS.items()
            if slider.law in row.laws and row.needs_dt == needs.needs_dt
        )
        raise ParameterError(
            f"{method} is for law={' or '.join(map(repr, needs.laws))}; use method={other!r} for "
            f"the {slider.law} law"
        )
    return rtol, dt


def _check_oscillation(method, dt, slider):
    """Raise ParameterError for a slider without a natural period, or one too short for dt."""
    if np.any(np.equal(slider.M, 0.0)) or np.any(np.isinf(slider.K)):
        raise ParameterError(
            f"{method} needs mass and spring: M > 0 and K < inf (it steps by sqrt(K/M)); "
            f"use method='rodas5p' for M = 0 or K = inf"
        )
    if dt and (angle := float(np.max((slider.K / slider.M) ** 0.5)) * dt) > np.pi:
        raise ParameterError(
            f"dt = {dt:g} s is {angle:.3g}/omega, omega = sqrt(K/M): more than half a natural "
            f"period; take dt of 0.1/omega or less"
        )


def saved_times(times, t_end):
    """Saved times [s]: None, an array (m,), or a DataArray with ``time`` last; checked."""
    if times is None:
        return None
    if np.size(times) == 0:
        raise ParameterError("times is empty; leave it out to get the solver's own steps")
    if not is_array(times) or times.ndim == 1:
        times = column("times", times)
        if is_array(times):
            raise ParameterError("times is a list of DataArrays; give one with a dimension 'time'")
    else:
        times = to_si("times", times)
        if "time" not in times.dims:
            raise ParameterError(f"times has dimensions {times.dims}; one must be 'time'")
        times = times.drop_vars("time", errors="ignore").transpose(..., "time")
    values = np.asarray(times)
    if not (np.diff(values, axis=-1) > 0).all():
        raise ParameterError("times [s] must increase; sort them and drop repeated ones")
    latest = times.max("time") if is_array(times) else values.max()
    if np.any(latest > t_end * (1.0 + 1e-12)):
        raise ParameterError(
            f"times reach {float(np.max(latest)):.9g} s, beyond t_end = {float(np.max(t_end)):.9g}"
            f" s; extend t_end or drop the later times"
        )
    return np.minimum(times, t_end if is_array(times) else float(np.min(t_end)))  # rounding
