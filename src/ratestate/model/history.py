"""Histories of speed or normal stress: straight lines in time, with jumps between them."""

import dataclasses
import functools
from typing import Any

import numpy as np

from ..errors import ParameterError
from .arrays import as_column, as_times, concat
from .units import is_array, named

#: largest relative difference between the slider's sigma and the first sigma of a record
SIGMA_TOLERANCE = 1e-6


@dataclasses.dataclass(frozen=True, eq=False)
class History:
    """A quantity in time, piecewise linear with jumps.

    Attributes
    ----------
    t : ndarray, shape (S,)
        Start times of the segments [s], increasing from 0.
    start, end : ndarray, shape (S,), or DataArray with the sweep's dimensions, then ``segment``
        Values at the start and at the end of each segment.
    until : float
        End of the last segment [s].  If it is inf, the last segment is constant.
    ends_event : bool
        Whether the last segment follows a hold or ramp, so that another event may begin with it.
    """

    t: np.ndarray
    start: Any
    end: Any
    until: float = np.inf
    ends_event: bool = False

    @classmethod
    def constant(cls, symbol, value):
        """Return the history of a constant value, a float or DataArray."""
        column = concat({symbol: value})
        return cls(np.zeros(1), column, column)

    @property
    def durations(self):
        """Durations of the segments [s], shape (S,)."""
        return np.diff(self.t, append=self.until)

    @functools.cached_property
    def rate(self):
        """Slope of each segment, in the shape of ``start``."""
        return (self.end - self.start) / self.durations

    def followed_by(self, symbol, *pieces):
        """Return the history up to the first piece (t, start, end), then the pieces.

        Raises ParameterError, with the symbol of the quantity, if DataArrays clash.
        """
        times, *added = zip(*pieces, strict=True)
        kept = self.t < times[0]
        names = [f"{symbol} from t = {t!r} s on" for t in times]
        start, end = (
            concat({f"{symbol} before": column[..., kept], **dict(zip(names, values, strict=True))})
            for column, values in zip((self.start, self.end), added, strict=True)
        )
        t = np.append(self.t[kept], times)
        return dataclasses.replace(self, t=t, start=start, end=end, ends_event=len(pieces) > 1)

    def check_time(self, t, what):
        """Return the time t [s] of a new event, which must follow the last event."""
        last = float(self.t[-1])
        if self.ends_event and abs(t - last) <= 1e-12 * last:  # 0.1 s + 0.2 s is not quite 0.3 s
            return last
        if t <= last:
            raise ParameterError(
                f"must come after t = {last!r} s, up to which {what} is given",
                "Give the steps in order of time.",
                symbol="t",
                value=repr(t),
                unit="s",
            )
        return t

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


@dataclasses.dataclass(frozen=True, eq=False)
class NormalStress(History):
    """Normal stress [Pa]: straight lines and a sinusoid; NaN is the slider's sigma.

    Attributes
    ----------
    amplitude, period : float or DataArray
        Amplitude [Pa] and period [s] of the sinusoid; 0 and inf if there is none.
    """

    amplitude: Any = 0.0
    period: Any = np.inf

    @property
    def oscillates(self):
        """Whether normal stress has a sinusoid in any case; it then varies for ever."""
        return bool(np.any(np.not_equal(self.amplitude, 0.0)))

    @property
    def first_change(self):
        """Time of the first change of normal stress in any case [s], or inf."""
        if self.oscillates:
            return 0.0
        start, end = (np.nan_to_num(column, nan=-1.0) for column in (self.start, self.end))
        changes = start != end
        changes[..., 1:] |= start[..., 1:] != end[..., :-1]
        return float(self.t[changes.reshape(-1, self.t.size).any(axis=0)].min(initial=np.inf))

    def at(self, t, sigma):
        """Return the stress [Pa] at times t [s] if it begins at sigma; after a jump at t.

        The result has the same shape as from `Loading.V_load`.
        """
        if any(map(is_array, (self.amplitude, self.period))):
            t = as_times(t)
        stress = self.with_sigma(sigma)
        start, end, duration, elapsed = stress.look_up(t, stress.start, stress.end, self.durations)
        phase = (as_times(t) if is_array(elapsed) else t) / self.period
        wave = self.amplitude * np.sin(2.0 * np.pi * (phase - np.round(phase)))
        values = start + elapsed / duration * (end - start) + wave
        if not is_array(values):
            return values
        return named("sigma", values.transpose(..., "time", missing_dims="ignore"))

    def with_sigma(self, sigma):
        """Return the history with the slider's sigma [Pa] in place of NaN."""
        start, end = (_fill_nan(column, sigma) for column in (self.start, self.end))
        return dataclasses.replace(self, start=start, end=end)

    def check(self, sigma, t_end):
        """Raise ParameterError unless stress begins at sigma and is > 0 up to t_end [s].

        Arguments may be DataArrays.  If a sinusoid lies on a ramp, the lowest values of the ramp
        and of the sinusoid are added, although they may occur at different times.
        """
        first = self.start[..., 0]
        if np.any(np.abs(first - sigma) > SIGMA_TOLERANCE * sigma):
            raise ParameterError(
                (
                    f"the series begins at sigma = {float(np.max(first)):.9g} Pa, and the slider "
                    f"has sigma = {float(np.max(sigma)):.9g} Pa"
                ),
                "Give the slider the sigma at which the series begins.",
            )
        if not self.oscillates:
            return  # values of steps, ramps and records have been checked when they were given
        lowest, begin, end = self._lowest(sigma, t_end)
        if lowest <= 0.0:
            raise ParameterError(
                (
                    f"would fall to {lowest:.6g} Pa between t = {begin:.6g} s and t = {end:.6g} "
                    "s, and must stay > 0"
                ),
                "Give a smaller amplitude, or a larger sigma.",
                symbol="sigma",
            )

    def _lowest(self, sigma, t_end):
        """Return the lowest normal stress [Pa] up to t_end, and its segment's ends [s]."""
        import xarray

        begin, following = map(as_column, (self.t, np.append(self.t[1:], np.inf)))
        stress = self.with_sigma(sigma)
        start, end = map(as_column, (stress.start, stress.end))
        last = xarray.DataArray(t_end)
        until = xarray.where(following < last, following, last)
        base = np.minimum(start, start + (until - begin) / (following - begin) * (end - start))
        low = base + self.amplitude * _lowest_sine(begin / self.period, until / self.period)
        low = low.where(until > begin, np.inf)
        each = low.min([dim for dim in low.dims if dim != "segment"])
        k = int(each.values.argmin())
        return float(each[k]), float(begin[k]), float(until.isel(segment=k).max())


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
