"""Steps, holds and ramps: what is put at the end of a history that goes on for ever.

They return a dict of the fields that change: t, V, rate and returns.  They raise ParameterError for
a history with an end, a time before the last event's end, a wrong unit or range, an array of times,
and arrays that clash.
"""

import numpy as np

from ...errors import ParameterError
from ..arrays import appended, check_aligned
from ..units import is_array, one_in_si, to_si


def step(loading, t, V):
    """The fields of a `Loading` that change by a step at t [s] to V [m/s]."""
    t = _time(loading, t)
    return _changed(loading, t, {t: (speed_from(t, V), 0.0)}, returns=None)


def hold(loading, t, duration):
    """The fields of a `Loading` that change by a hold from t [s] on, for a duration [s]."""
    t = _time(loading, t)
    end = end_of(t, duration, "hold")
    after = loading.V[..., -1]
    return _changed(loading, t, {t: (0.0, 0.0), end: (after, 0.0)}, returns=True)


def ramp(loading, t, V, duration):
    """The fields of a `Loading` that change by a ramp from t [s] on, to V within a duration [s]."""
    t, V = _time(loading, t), speed_from(t, V)
    end = end_of(t, duration, "ramp")
    before = loading.V[..., -1]
    check_aligned({"V_lp before": before, f"V_lp from t = {end!r} s on": V})
    with np.errstate(over="ignore"):
        rate = (V - before) / (end - t)
    if not np.isfinite(rate).all():
        raise ParameterError(f"ramp = {duration!r} is too short; for a jump leave it out")
    return _changed(loading, t, {t: (before, rate), end: (V, 0.0)}, returns=True)


def _time(loading, t):
    """When an event begins [s]: after the last one, or where that ends."""
    if np.isfinite(loading.t_last):
        raise ParameterError(
            f"the history ends at t = {loading.t_last!r} s, and nothing can follow; "
            f"give steps to a constant speed, or put them into the rows of the series"
        )
    t = one_in_si("t", t, bound="> 0")
    return time_after(t, float(loading.t[-1]), loading.returns, "the history")


def time_after(t, last, returns, what):
    """t [s], if it comes after the last event, or where a ramp ends."""
    if returns and abs(t - last) <= 1e-12 * last:  # 0.1 s + 0.2 s is not quite 0.3 s
        return last
    if t <= last:
        raise ParameterError(
            f"t = {t!r} s must come after t = {last!r} s, up to which {what} is given; "
            f"give the steps in order of time"
        )
    return t


def speed_from(t, V):
    """The speed [m/s], >= 0, from t [s] on: float or DataArray, else ParameterError."""
    return to_si("V_lp", V, label=f"V_lp from t = {t!r} s on", bound=">= 0")


def end_of(t, duration, label):
    """When an event is over [s]."""
    lasting = one_in_si("t", duration, label=label, bound="> 0")
    if not t < t + lasting < np.inf:
        raise ParameterError(f"{label} = {duration!r} is too short or too long after t = {t!r} s")
    return t + lasting


def _changed(loading, t, segments, returns):
    """Fields of a `Loading` whose end from t [s] on gives way to segments, start -> V, rate."""
    kept = loading.t < t
    starts = np.concatenate([loading.t[kept], [*segments]])
    V, rate = (
        appended(column[..., kept], [values[i] for values in segments.values()], "V_lp")
        for i, column in enumerate((loading.V, loading.rate))
    )
    if is_array(V):  # one of them may not depend on what the other does
        rate = rate + 0.0 * V
    return {"t": starts, "V": V, "rate": rate, "returns": returns}
