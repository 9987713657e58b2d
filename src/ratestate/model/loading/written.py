"""A history in the words that make it again, to the last bit."""

import itertools
from typing import Any, NamedTuple

import numpy as np

from ...errors import ParameterError
from ..units import is_array

#: segments; so many are those of a record, which has no holds
MANY = 10_000


class Event(NamedTuple):
    """A call of a method of `Loading`: step(t, V), hold(t, duration) or ramp(t, V, duration).

    Speeds are floats, or DataArrays in those dimensions on which they depend.
    """

    kind: str
    t: float
    V: Any = None
    duration: float | None = None


def events_of(loading):
    """The speed [m/s] at t = 0, and the list of `Event`s, of a history that goes on for ever.

    ParameterError for ramps from other speeds than it has: no method of `Loading` makes them.
    A history with an end, such as a series, is for `rows_of`; that is not checked here.
    """
    V, rate = np.asarray(loading.V), np.asarray(loading.rate)
    ends, t = _ends(loading), loading.t.tolist()
    found = [Event("step", 0.0, V[..., 0])]
    k, now = 1, ends[..., 0]
    ramps = [(rate[..., i] != 0.0).any() for i in range(len(t))]
    sound = not ramps[-1] and not ramps[0]
    while k < len(t):
        following = k + 1 < len(t)
        resumes = next((i for i in range(k, len(t)) if V[..., i].any()), None)
        if ramps[k]:
            sound &= np.array_equal(V[..., k], now)
            now = ends[..., k]
            found.append(Event("ramp", t[k], now, _lasting(t[k], t[k + 1])))
        elif now.any() and resumes not in (None, k) and np.array_equal(V[..., resumes], now):
            found.append(Event("hold", t[k], None, _lasting(t[k], t[k + 1])))
        else:
            now = V[..., k]
            found.append(Event("step", t[k], now))
        # what a hold or ramp leads to is no event of its own
        returned = found[-1].kind != "step" and following
        k += 2 if returned and not ramps[k + 1] and np.array_equal(V[..., k + 1], now) else 1
    if not sound:
        raise ParameterError("this loading cannot be written as steps, holds and ramps")
    start, *events = _with_dimensions(loading, found)
    return start.V, events


class StressEvent(NamedTuple):
    """A call of a method of `Loading`: sigma_step(t, sigma) or sigma_ramp(t, sigma, duration)."""

    kind: str
    t: float
    sigma: Any
    duration: float | None = None


def stress_events_of(stress):
    """The list of `StressEvent`s that make a `NormalStress`, but for its sinusoid.

    Of one that is no series; that is not checked here.
    """
    found, k = [], 1
    while k < stress.t.size:
        first, last = stress.start[..., k], stress.end[..., k]
        t, sigma = float(stress.t[k]), last if is_array(last) else float(last)
        if np.array_equal(first, last):
            found.append(StressEvent("sigma_step", t, sigma))
            k += 1
            continue
        end = float(stress.t[k + 1])
        found.append(StressEvent("sigma_ramp", t, sigma, _lasting(t, end)))
        after = stress.start[..., k + 1 : k + 2]
        k += 2 if np.array_equal(after[..., 0], last) and _rests(stress, k + 1) else 1
    return found


def _rests(stress, k):
    """Whether normal stress is constant in segment k."""
    return np.array_equal(stress.start[..., k], stress.end[..., k])


def has_stress_rows(loading):
    """Whether the normal stress is that of a series, which `rows_of` gives."""
    stress = loading.normal_stress
    return stress is not None and not np.isnan(np.asarray(stress.start)[..., 0]).any()


def rows_of(loading):
    """Times (N,), speeds (N,) and normal stresses (N,) that `Loading.series` makes a history from.

    Both may be DataArrays; the stresses are None where they are no series.

    ParameterError for a ramp that leads to no speed >= 0.  That the history has an end is not
    checked here.
    """
    columns = [(loading.V, np.asarray(loading.V), _ends(loading))]
    if has_stress_rows(loading):
        stress = loading.normal_stress
        first, last = (column[..., :-1] for column in (stress.start, stress.end))
        columns.append((first, np.asarray(first), np.asarray(last)))
    starts = np.append(loading.t, loading.t_last)
    jump = np.zeros(loading.t.size - 1, bool)
    for _, first, last in columns:
        jump |= (last[..., :-1] != first[..., 1:]).any(axis=tuple(range(first.ndim - 1)))
    # each segment's end, and where the next begins at another speed or stress, that too
    at = np.repeat(np.arange(loading.t.size), np.append(np.where(jump, 2, 1), 1))
    is_end = np.append(True, np.diff(at) > 0)
    rows = [_rows(*column, at, is_end) for column in columns]
    return np.append(starts[0], starts[1:][at]), rows[0], rows[1] if len(rows) > 1 else None


def _rows(column, first, last, at, is_end):
    """Values of rows, from those at the starts and ends of segments."""
    following = first[..., np.minimum(at + 1, first.shape[-1] - 1)]
    values = np.append(first[..., :1], np.where(is_end, last[..., at], following), axis=-1)
    if not is_array(column):
        return values
    import xarray

    coords = {k: c for k, c in column.coords.items() if "segment" not in c.dims}
    return xarray.DataArray(values, coords, column.dims)


def _ends(loading):
    """Speeds at the ends of the segments from which their accelerations come out, to the bit.

    The acceleration is (end - V)/dt, rounded twice: the end is sought among the neighbours of
    V + rate dt, those first that need no jump to the next segment, or to where a hold leads.
    """
    V, rate = np.asarray(loading.V), np.asarray(loading.rate)
    dt = np.diff(np.append(loading.t, loading.t_last))
    with np.errstate(invalid="ignore"):
        rise = np.where(rate == 0.0, 0.0, rate * dt)
    moving = np.asarray(V.any(axis=tuple(range(V.ndim - 1))))
    after = np.arange(1, V.shape[-1] + 1).clip(max=V.shape[-1] - 1)
    resumed = [int(np.argmax(moving[k:])) + k for k in after] if V.shape[-1] < MANY else after
    near = [V[..., after], V[..., resumed], V + rise, np.zeros_like(V)]
    for steps, side in itertools.product(range(-2, 3), (-1, 0, 1)):
        change = rise
        for _ in range(abs(steps)):
            change = np.nextafter(change, np.inf * steps)
        end = V + change
        near.append(np.nextafter(end, np.inf * side) if side else end)
    found = np.full(V.shape, np.nan)
    for end in near:
        with np.errstate(over="ignore", invalid="ignore"):
            fits = np.isnan(found) & (end >= 0.0) & ((end - V) / dt == rate)
        found[fits] = end[fits]
    if np.isnan(found).any():
        raise ParameterError("this loading cannot be written: a ramp in it leads to no speed >= 0")
    return found


def _lasting(t, end):
    """The shortest duration [s], in digits, that takes t [s] to this end, to the bit."""
    about = end - t
    short = (float(f"{about:.{digits}g}") for digits in range(1, 18))
    near = (np.nextafter(about, 0.0), np.nextafter(about, np.inf))
    for duration in (*short, *near):
        if t + duration == end:
            return float(duration)
    raise ParameterError(f"no duration leads from t = {t!r} s to t = {end!r} s")


def _with_dimensions(loading, events):
    """Events with their speeds as floats, or DataArrays in the dimensions on which they depend."""
    if not is_array(loading.V):
        return [e._replace(V=None if e.V is None else float(e.V)) for e in events]
    frame = loading.V.isel(segment=0)
    speeds = {
        i: _lean(frame.copy(data=event.V)) for i, event in enumerate(events) if event.V is not None
    }
    # a dimension on which none depends, such as one of a single value, stays with the last
    lost = [d for d in frame.dims if all(d not in getattr(V, "dims", ()) for V in speeds.values())]
    last = max(speeds)
    if lost:
        kept = [d for d in frame.dims if d in lost or d in getattr(speeds[last], "dims", ())]
        whole = frame.copy(data=events[last].V)
        speeds[last] = whole.isel({d: 0 for d in frame.dims if d not in kept}, drop=True)
    return [event._replace(V=speeds.get(i)) for i, event in enumerate(events)]


def _lean(array):
    """An array without the dimensions on which it does not depend."""
    for dim in array.dims:
        one = array.isel({dim: 0}, drop=True)
        if (array == one).all():
            array = one
    return array if array.ndim else float(array)
