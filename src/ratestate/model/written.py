"""The calls of `Loading` that reproduce a history exactly."""

import itertools
from typing import Any, NamedTuple

import numpy as np

from ..errors import ParameterError
from .units import is_array

#: segments; so many are those of a record, which has no holds
MANY = 10_000


class Event(NamedTuple):
    """A call of a method of `Loading`: ``step(t, value)``, ``sigma_ramp(t, value, duration)``, ...

    The value, a speed or normal stress, is a float, or a DataArray in those dimensions on which it
    depends; that of a hold is None.
    """

    kind: str
    t: float
    value: Any = None
    duration: float | None = None


def events_of(loading):
    """The speed [m/s] at t = 0, and the list of `Event`s, of a history that goes on for ever.

    ParameterError for ramps from other speeds than it has: no method of `Loading` makes them.
    A history with an end, such as a series, is for `rows_of`; that is not checked here.
    """
    rate, first = np.asarray(loading.rate), Event("step", 0.0, np.asarray(loading.V)[..., 0])
    ramps = (rate != 0.0).any(axis=tuple(range(rate.ndim - 1)))
    found = [first, *_events(loading.t, np.asarray(loading.V), _ends(loading), ramps)]
    start, *events = _with_dimensions(loading.V, found)
    return start.value, events


def stress_events_of(stress):
    """The list of `Event`s that make a `NormalStress`, but for its sinusoid.

    One that is a series is for `rows_of`; that is not checked here.
    """
    start, end = np.asarray(stress.start), np.asarray(stress.end)
    ramps = ((start != end) & ~np.isnan(end)).any(axis=tuple(range(start.ndim - 1)))
    found = _with_dimensions(stress.start, _events(stress.t, start, end, ramps))
    return [event._replace(kind=f"sigma_{event.kind}") for event in found]


def _events(t, start, end, ramps):
    """The events after the first segment, each segment with its start, end and whether it moves."""
    found, k, now = [], 1, end[..., 0]
    sound = not ramps[0] and not ramps[-1]
    while k < t.size and sound:
        resumes = next((i for i in range(k, t.size) if start[..., i].any()), None)
        if ramps[k]:
            sound = np.array_equal(start[..., k], now, equal_nan=True)
            now = end[..., k]
            found.append(Event("ramp", float(t[k]), now, _lasting(t[k], t[k + 1])))
        elif now.any() and resumes not in (None, k) and np.array_equal(start[..., resumes], now):
            found.append(Event("hold", float(t[k]), None, _lasting(t[k], t[k + 1])))
        else:
            now = start[..., k]
            found.append(Event("step", float(t[k]), now))
        # what a hold or ramp leads to is no event of its own
        returned = found[-1].kind != "step" and k + 1 < t.size and not ramps[k + 1]
        k += 2 if returned and np.array_equal(start[..., k + 1], now) else 1
    if not sound:
        raise ParameterError("this loading cannot be written as steps, holds and ramps")
    return found


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
    columns = [(loading.V, _ends(loading))]
    if has_stress_rows(loading):
        stress = loading.normal_stress
        columns.append((stress.start[..., :-1], stress.end[..., :-1]))
    # the start and the end of each segment, but a start only if it differs from the end before
    starts = np.append(loading.t, loading.t_last)
    kept = np.arange(2 * loading.t.size) % 2 == 1
    kept[0] = True
    for first, last in columns:
        jumps = np.asarray(last)[..., :-1] != np.asarray(first)[..., 1:]
        kept[2::2] |= jumps.any(axis=tuple(range(jumps.ndim - 1)))
    rows = [_rows(*column)[..., kept] for column in columns]
    times = np.stack([starts[:-1], starts[1:]], axis=-1).ravel()[kept]
    return times, rows[0], rows[1] if len(rows) > 1 else None


def _rows(first, last):
    """Values at the starts and ends of segments, in turn; a DataArray if `first` is."""
    values = np.stack([first, last], axis=-1).reshape(*first.shape[:-1], -1)
    if not is_array(first):
        return values
    return (
        first.isel(segment=0, drop=True)
        .expand_dims(segment=values.shape[-1], axis=-1)
        .copy(data=values)
    )


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


def _with_dimensions(column, events):
    """Events with values as floats, or DataArrays in the dimensions on which they depend."""
    if not is_array(column) or not events:
        return [e._replace(value=None if e.value is None else float(e.value)) for e in events]
    frame = column.isel(segment=0)
    values = {i: _lean(frame.copy(data=e.value)) for i, e in enumerate(events) if e.kind != "hold"}
    # a dimension on which none depends, such as one of a single value, stays with the last
    lost = [d for d in frame.dims if all(d not in getattr(x, "dims", ()) for x in values.values())]
    last = max(values)
    if lost:
        kept = [d for d in frame.dims if d in lost or d in getattr(values[last], "dims", ())]
        whole = frame.copy(data=events[last].value)
        values[last] = whole.isel({d: 0 for d in frame.dims if d not in kept}, drop=True)
    return [event._replace(value=values.get(i)) for i, event in enumerate(events)]


def _lean(array):
    """An array without the dimensions on which it does not depend."""
    for dim in array.dims:
        one = array.isel({dim: 0}, drop=True)
        if (array == one).all():
            array = one
    return array if array.ndim else float(array)
