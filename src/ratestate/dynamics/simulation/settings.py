"""Arguments checked: rtol of all functions; method and saved times of `simulate`.

The defaults are in the functions' signatures.
"""

import numpy as np

from ...engine.model import METHODS
from ...model.arrays import column_to_si
from ...model.names import one_of
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


def solver_settings(rtol, method):
    """rtol as a float; ParameterError for an unknown method, and rtol beyond 1e-13 to 0.1."""
    rtol = checked_rtol(rtol, "1e-13", "0.1", "1e-6")
    if not isinstance(method, str) or method not in METHODS:
        raise refusal("settings.method", method=method, wanted=one_of(METHODS, method))
    return rtol


def check_normal_stress(loading, slider, t_end):
    """Raise ParameterError for a normal stress that the loading cannot give this slider.

    It must begin at the slider's, and stay > 0 up to t_end [s].
    """
    if loading.normal_stress is None:
        return
    if "sigma" in getattr(slider.sigma, "dims", ()):
        raise refusal("settings.sigma_axis")
    loading.normal_stress.check(slider.sigma, t_end)


def saved_times(times, t_end):
    """Saved times [s]: an array (m,), or a DataArray with ``time`` last; None for None.

    ParameterError where there are none, they do not increase, or go beyond t_end.
    """
    if times is None:
        return None
    if not is_array(times) or times.ndim == 1:
        times = column_to_si("times", times)
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
