"""Arguments checked: rtol of all functions; method, time step and saved times of `simulate`.

The defaults are in the functions' signatures.
"""

import numpy as np

from ...engine.model import METHODS
from ...friction.laws import LAWS
from ...model.arrays import column
from ...model.units import is_array, to_si
from ..refusals import refusal


def checked_rtol(rtol, least, most, example):
    """A relative tolerance as a float; ParameterError for an array, and beyond least and most.

    These are texts, such as "1e-12", as the message shows them; so is the example.
    """
    rtol = to_si("rtol", rtol)
    if is_array(rtol) or not float(least) <= rtol <= float(most):
        raise refusal("settings.rtol", rtol=rtol, least=least, most=most, example=example)
    return rtol


def solver_settings(rtol, method, dt, slider):
    """rtol and dt [s] as floats; dt is None for a method that chooses its steps.

    ParameterError for an unknown method, rtol beyond 1e-13 to 0.1, dt given or missing against the
    method, not > 0, or too long; and for a slider that the method is not for.
    """
    rtol = checked_rtol(rtol, "1e-13", "0.1", "1e-6")
    if not isinstance(method, str) or method not in METHODS:
        raise refusal("settings.method", method=method, choices=", ".join(METHODS))
    needs = METHODS[method]
    if not needs.needs_dt and dt is not None:
        raise refusal("settings.dt_not_wanted", method=method, dt=dt)
    if needs.needs_dt:
        if dt is None:
            raise refusal("settings.dt_missing", method=method)
        dt = to_si("dt", dt)
        if is_array(dt):
            raise refusal("settings.dt_array")
    if needs.needs_mass:
        _check_oscillation(method, dt, slider)
    if needs.needs_law and slider.friction_law.reverses:
        raise refusal("settings.reverses", method=method, friction=slider.friction)
    if slider.law not in _laws_for(method):
        others = [name for name in METHODS if slider.law in _laws_for(name)]
        laws = " or ".join(map(repr, _laws_for(method)))
        raise refusal("settings.law", method=method, laws=laws, other=others[-1], law=slider.law)
    return rtol, dt


def check_normal_stress(loading, slider, t_end, method):
    """Raise ParameterError for a normal stress that the loading cannot give this slider.

    It must begin at the slider's, and stay > 0 up to t_end [s]; and the method must know it.
    """
    if loading.normal_stress is None:
        return
    if METHODS[method].needs_dt:
        raise refusal("settings.normal_stress", method=method)
    if "sigma" in getattr(slider.sigma, "dims", ()):
        raise refusal("settings.sigma_axis")
    loading.normal_stress.check(slider.sigma, t_end)


def _laws_for(method):
    """Names of the laws that a method is for."""
    needs = METHODS[method].needs_law
    return [name for name, law in LAWS.items() if not needs or law.gives(needs)]


def _check_oscillation(method, dt, slider):
    """Raise ParameterError for a slider without a natural period, or one too short for dt."""
    if np.any(np.equal(slider.M, 0.0)) or np.any(np.isinf(slider.K)):
        raise refusal("settings.mass_and_spring", method=method)
    if dt and (angle := float(np.max((slider.K / slider.M) ** 0.5)) * dt) > np.pi:
        raise refusal("settings.dt_long", dt=dt, angle=angle)


def saved_times(times, t_end):
    """Saved times [s]: an array (m,), or a DataArray with ``time`` last; None for None.

    ParameterError where there are none, they do not increase, or go beyond t_end.
    """
    if times is None:
        return None
    if not is_array(times) or times.ndim == 1:
        times = column("times", times)
        if is_array(times):
            raise refusal("times.list_of_arrays")
    else:
        times = to_si("times", times)
        if "time" not in times.dims:
            raise refusal("times.dimensions", dims=times.dims)
        times = times.drop_vars("time", errors="ignore").transpose(..., "time")
    values = np.asarray(times)
    if not (np.diff(values, axis=-1) > 0).all():
        raise refusal("times.order")
    latest = times.max("time") if is_array(times) else values.max()
    if np.any(latest > t_end * (1.0 + 1e-12)):
        raise refusal("times.late", latest=float(np.max(latest)), t_end=float(np.max(t_end)))
    return np.minimum(times, t_end if is_array(times) else float(np.min(t_end)))  # rounding
