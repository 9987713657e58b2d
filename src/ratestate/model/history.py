"""Histories of speed or normal stress: straight lines in time, with jumps between them."""

import dataclasses
import functools
from typing import Any

import numpy as np

from .arrays import as_column, as_times, concat
from .names import refusal
from .units import is_array, named, one_in_si, to_si

#: largest relative difference between the slider's sigma and the first sigma of a record
SIGMA_TOLERANCE = 1e-6
#: symbol -> range of its values, and what is given, for messages
KINDS = {"V_lp": (">= 0", "the history"), "sigma": ("> 0", "normal stress")}


@dataclasses.dataclass(frozen=True, eq=False)
class History:
    """A quantity in time: straight lines with jumps between them, and a sinusoid.

    Attributes
    ----------
    symbol : {"V_lp", "sigma"}
        The quantity.  A normal stress of NaN is the slider's sigma.
    t : ndarray, shape (S,)
        Start times of the segments [s], increasing from 0.
    start, end : ndarray, shape (S,), or DataArray with the sweep's dimensions, then ``segment``
        Values at the start and at the end of each segment, without the sinusoid.
    until : float
        End of the last segment [s].  If it is inf, the last segment is constant.
    ends_event : bool
        Whether the last segment follows a hold or ramp, so that another event may begin with it.
    amplitude, period : float or DataArray
        Amplitude, and period [s], of the sinusoid; 0 and inf if there is none.
    """

    symbol: str
    t: np.ndarray
    start: Any
    end: Any
    until: float = np.inf
    ends_event: bool = False
    amplitude: Any = 0.0
    period: Any = np.inf

    @classmethod
    def constant(cls, symbol, value):
        """Return the history of a constant value in SI, a float or DataArray."""
        column = concat({symbol: value})
        return cls(symbol, np.zeros(1), column, column)

    @property
    def durations(self):
        """Durations of the segments [s], shape (S,)."""
        return np.diff(self.t, append=self.until)

    @functools.cached_property
    def rate(self):
        """Slope of each segment, in the shape of ``start``."""
        return (self.end - self.start) / self.durations

    def step(self, t, value):
        """Return the history with a jump to a value at t."""
        t = self._event_time(t)
        value = self._checked(t, value)
        return self._followed_by((t, value, value))

    def hold(self, t, duration):
        """Return the history with the value 0 from t on, for a duration."""
        t, before = self._event_time(t), self.end[..., -1]
        seconds = _duration(t, duration, "hold")
        return self._followed_by((t, 0.0, 0.0), (t + seconds, before, before))

    def ramp(self, t, value, duration):
        """Return the history with a straight line to a value from t on."""
        t, before = self._event_time(t), self.end[..., -1]
        value, seconds = self._checked(t, value), _duration(t, duration, "ramp")
        extended = self._followed_by((t, before, value), (t + seconds, value, value))
        with np.errstate(over="ignore"):
            if np.isinf(extended.rate).any():
                raise refusal("history.short_ramp", duration=duration)
        return extended

    def _event_time(self, t):
        """Return the time [s] of a new event, which must follow the last event."""
        t, last = one_in_si("t", t, bound="> 0"), float(self.t[-1])
        if self.ends_event and abs(t - last) <= 1e-12 * last:  # 0.1 s + 0.2 s is not quite 0.3 s
            return last
        if t <= last:
            raise refusal("history.order", t=t, last=last, what=KINDS[self.symbol][1])
        return t

    def _checked(self, t, value):
        label = f"{self.symbol} from t = {t!r} s on"
        return to_si(self.symbol, value, label=label, bound=KINDS[self.symbol][0])

    def _followed_by(self, *pieces):
        """Return the history up to the first piece (t, start, end), then the pieces."""
        times, *added = zip(*pieces, strict=True)
        kept = self.t < times[0]
        names = [f"{self.symbol} from t = {t!r} s on" for t in times]
        start, end = (
            concat({f"{self.symbol} before": x[..., kept], **dict(zip(names, values, strict=True))})
            for x, values in zip((self.start, self.end), added, strict=True)
        )
        t = np.append(self.t[kept], times)
        return dataclasses.replace(self, t=t, start=start, end=end, ends_event=len(pieces) > 1)

    def segments_at(self, t):
        """Return the segments that contain times t [s]; at a jump, the later ones."""
        return np.searchsorted(self.t, t, side="right") - 1

    def look_up(self, t, *columns):
        """Return columns at times t [s], and the times since their segments began.

        All results have the shape of t.  If t or a column is a DataArray, they are DataArrays with
        the last dimension ``time``.
        """
        seconds = np.asarray(t, dtype=float)
        k = self.segments_at(seconds)
        elapsed = seconds - self.t[k]
        if not any(map(is_array, (t, *columns))):
            return [*(column[k] for column in columns), elapsed]
        times = as_times(t)
        selected = (as_column(column).isel(segment=times.copy(data=k)) for column in columns)
        ordered = (values.transpose(..., "time", missing_dims="ignore") for values in selected)
        return [*ordered, times.copy(data=elapsed)]

    def refined(self, t):
        """Return the same history in segments that begin at t [s], which has all of its own."""
        k, last = self.segments_at(t), self.until if np.isfinite(self.until) else t[-1]
        columns = self.start[..., k], self.end[..., k], self.durations[k]
        ends = (x - self.t[k] for x in (t, np.append(t[1:], last)))
        start, end = (_on_line(*columns, elapsed) for elapsed in ends)
        return dataclasses.replace(self, t=t, start=start, end=end)

    def at(self, t):
        """Return the values at times t [s], after a jump at t; shape as from `look_up`."""
        if any(map(is_array, (self.amplitude, self.period))):
            t = as_times(t)
        start, end, duration, elapsed = self.look_up(t, self.start, self.end, self.durations)
        phase = (as_times(t) if is_array(elapsed) else t) / self.period
        wave = self.amplitude * np.sin(2.0 * np.pi * (phase - np.round(phase)))
        values = _on_line(start, end, duration, elapsed) + wave
        if not is_array(values):
            return values
        return named(self.symbol, values.transpose(..., "time", missing_dims="ignore"))

    @property
    def oscillates(self):
        """Whether there is a sinusoid in any case, so that the quantity varies for ever."""
        return bool(np.any(np.not_equal(self.amplitude, 0.0)))

    @property
    def first_change(self):
        """Time of the first change in any case [s], or inf."""
        if self.oscillates:
            return 0.0
        start, end = (np.nan_to_num(column, nan=-1.0) for column in (self.start, self.end))
        changes = start != end
        changes[..., 1:] |= start[..., 1:] != end[..., :-1]
        return float(self.t[changes.reshape(-1, self.t.size).any(axis=0)].min(initial=np.inf))

    def with_sigma(self, sigma):
        """Return the history with the slider's sigma [Pa] in place of NaN."""
        start, end = (_fill_nan(column, sigma) for column in (self.start, self.end))
        return dataclasses.replace(self, start=start, end=end)

    def check_stress(self, sigma, t_end):
        """Raise ParameterError unless normal stress begins at sigma and is > 0 up to t_end [s].

        Arguments may be DataArrays.  If a sinusoid lies on a ramp, the lowest values of the ramp
        and of the sinusoid are added, although they may occur at different times.
        """
        first = self.start[..., 0]
        if np.any(np.abs(first - sigma) > SIGMA_TOLERANCE * sigma):
            values = {"first": float(np.max(first)), "sigma": float(np.max(sigma))}
            raise refusal("stress.other_start", **values)
        if not self.oscillates:
            return  # values of steps, ramps and records have been checked when they were given
        lowest, begin, end = self.with_sigma(sigma)._lowest(t_end)
        if lowest <= 0.0:
            raise refusal("stress.falls", lowest=lowest, begin=begin, end=end)

    def _lowest(self, t_end):
        """Return the lowest value up to t_end, and the ends of its segment [s]."""
        import xarray

        columns = self.t, np.append(self.t[1:], np.inf), self.start, self.end
        begin, following, start, end = map(as_column, columns)
        last = xarray.DataArray(t_end)
        end_time = xarray.where(following < last, following, last)
        base = np.minimum(start, start + (end_time - begin) / (following - begin) * (end - start))
        low = base + self.amplitude * _lowest_sine(begin / self.period, end_time / self.period)
        low = low.where(end_time > begin, np.inf)
        lowest = low.min([dim for dim in low.dims if dim != "segment"])
        k = int(lowest.values.argmin())
        return float(lowest[k]), float(begin[k]), float(end_time.isel(segment=k).max())


def _on_line(start, end, duration, elapsed):
    return start + elapsed / duration * (end - start)


def _duration(t, duration, label):
    seconds = one_in_si("t", duration, label=label, bound="> 0")
    if not t < t + seconds < np.inf:
        raise refusal("history.duration", symbol=label, duration=duration, t=t)
    return seconds


def _fill_nan(column, sigma):
    if not np.isnan(column).any():
        return column
    if is_array(column) or is_array(sigma):
        return as_column(column).fillna(sigma).transpose(..., "segment")
    return np.where(np.isnan(column), sigma, column)


def _lowest_sine(begin, end):
    """Return the minimum of sin(2 pi x) for x from begin to end, floats or arrays."""
    trough = np.ceil(begin - 0.75) + 0.75
    lower = np.minimum(np.sin(2.0 * np.pi * begin), np.sin(2.0 * np.pi * end))
    return lower - (1.0 + lower) * (trough <= end)  # np.where would lose the dimensions
