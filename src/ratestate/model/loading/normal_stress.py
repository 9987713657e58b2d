"""Normal stress in time: steps, ramps, a record, and a sinusoid on top of them."""

import dataclasses
from typing import Any

import numpy as np

from ...errors import ParameterError
from ..arrays import appended, column
from ..units import is_array, named

#: by how much, of itself, the slider's sigma may differ from that at which a record begins
AGREE = 1e-6


@dataclasses.dataclass(frozen=True, eq=False)
class NormalStress:
    """Normal stress, piecewise linear in time but for a sinusoid; NaN stands for the slider's own.

    Attributes
    ----------
    t : ndarray, shape (S,)
        Starts of the segments [s], increasing from 0.
    start, end : ndarray, shape (S,), or DataArray with the sweep's dimensions, then ``segment``
        Normal stress [Pa] at the start and at the end of each; that at the end of the last one
        holds from there on.
    amplitude, period : float or DataArray
        Of the sinusoid [Pa] and [s]; 0 and inf where there is none.
    returns : bool
        Whether the last segment only ends a ramp, so that another event may begin with it.
    """

    t: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(1))
    start: Any = dataclasses.field(default_factory=lambda: np.array([np.nan]))
    end: Any = dataclasses.field(default_factory=lambda: np.array([np.nan]))
    amplitude: Any = 0.0
    period: Any = np.inf
    returns: bool = False

    @classmethod
    def of_record(cls, t, keep, sigma):
        """That of a record with these times [s], of which `keep` are the starts of segments."""
        sigma = column("sigma", sigma)
        if sigma.shape[-1] != t.size:
            raise ParameterError(
                f"sigma has {sigma.shape[-1]} values for {t.size} times; give one at each time"
            )
        if not np.all(np.greater(sigma, 0.0)):
            i = int(np.argmin(np.asarray(sigma).min(axis=tuple(range(sigma.ndim - 1)))))
            raise ParameterError(
                f"sigma[{i}] = {float(np.min(sigma)):.6g} Pa: normal stress must stay > 0; mend "
                f"the record"
            )
        rows = np.append(keep, t.size - 1)  # from the last time on it stays
        ends = np.append(keep + 1, t.size - 1)
        return cls(t[rows], sigma[..., rows], sigma[..., ends])

    def then(self, t, sigma):
        """The same up to t [s], and from then on sigma [Pa]."""
        return self._ended(t, [(t, sigma, sigma)], returns=False)

    def then_ramp(self, t, sigma, end):
        """The same up to t, then a ramp to sigma, where it comes to at `end` [s]."""
        before = self.end[..., -1]
        return self._ended(t, [(t, before, sigma), (end, sigma, sigma)], returns=True)

    def _ended(self, t, segments, returns):
        kept = self.t < t
        starts, first, last = zip(*segments, strict=True)
        return dataclasses.replace(
            self,
            t=np.concatenate([self.t[kept], starts]),
            start=appended(self.start[..., kept], first, "sigma"),
            end=appended(self.end[..., kept], last, "sigma"),
            returns=returns,
        )

    @property
    def oscillates(self):
        """Whether it has a sinusoid, in any case; it then never comes to rest."""
        return bool(np.any(np.not_equal(self.amplitude, 0.0)))

    @property
    def first_change(self):
        """When normal stress first changes [s], in any case; inf for never."""
        if self.oscillates:
            return 0.0
        moves = ~_same(self.start, self.end)
        jumps = np.append(False, ~_same(self.start[..., 1:], self.end[..., :-1]))
        return float(min(self.t[moves | jumps], default=np.inf))

    def at(self, t, sigma):
        """Normal stress [Pa] at times t [s], after a jump there, of a slider that begins at sigma.

        As `Segments.V_load` for arrays.
        """
        known = self.of_slider(sigma)
        seconds = np.asarray(t, dtype=float)
        k = self.segments_at(seconds)
        part = self.part_passed(seconds, k)
        if not any(map(is_array, (t, known.start, known.end, self.amplitude, self.period))):
            start, end = known.start[k], known.end[k]
            return start + part * (end - start) + self._wave(seconds)
        import xarray

        frame = t if is_array(t) else xarray.DataArray(seconds, dims=["time"][: seconds.ndim])
        place = frame.copy(data=k)
        start, end = (_along_segments(x).isel(segment=place) for x in (known.start, known.end))
        found = start + frame.copy(data=part) * (end - start) + self._wave(frame)
        return named("sigma", found.transpose(..., "time", missing_dims="ignore"))

    def last(self, sigma):
        """What it comes to in the end [Pa], but for its sinusoid; as `at`."""
        return self.of_slider(sigma).end[..., -1]

    def segments_at(self, t):
        """The numbers of the segments that hold times t [s], or begin then."""
        return np.searchsorted(self.t, t, side="right") - 1

    def part_passed(self, t, k):
        """What part of segments k has passed at times t [s]; in the last all of it is the same."""
        lasting = np.append(np.diff(self.t), 1.0)
        return np.minimum((t - self.t[k]) / lasting[k], 1.0)

    def of_slider(self, sigma):
        """The same with this sigma [Pa] of the slider in place of NaN."""
        start, end = (_filled(column, sigma) for column in (self.start, self.end))
        return dataclasses.replace(self, start=start, end=end)

    def _wave(self, seconds):
        """The sinusoid at these times [s]."""
        phase = seconds / self.period
        return self.amplitude * np.sin(2.0 * np.pi * (phase - np.round(phase)))

    def check(self, sigma, t_end):
        """Raise ParameterError unless normal stress begins at sigma and is > 0 up to t_end [s].

        All may be DataArrays.  A sinusoid on a ramp counts with the lowest of both.
        """
        first = self.start[..., 0]
        if np.any(np.abs(first - sigma) > AGREE * sigma):
            raise ParameterError(
                f"the series begins at sigma = {float(np.max(first)):.9g} Pa, and the slider has "
                f"sigma = {float(np.max(sigma)):.9g} Pa; give the slider that of the series"
            )
        if not self.oscillates:
            return  # what it goes through is > 0, each by itself
        lowest, begin, end = self._lowest(sigma, t_end)
        if lowest <= 0.0:
            raise ParameterError(
                f"sigma would fall to {lowest:.6g} Pa between t = {begin:.6g} s and t = "
                f"{end:.6g} s; it must stay > 0: give a smaller amplitude, or a larger sigma"
            )

    def _lowest(self, sigma, t_end):
        """The lowest normal stress [Pa] of all cases, and from where to where [s] it is met.

        A segment counts up to t_end [s], and not at all where that comes before it.
        """
        import xarray

        begin, following = (
            xarray.DataArray(t, dims="segment") for t in (self.t, np.append(self.t[1:], np.inf))
        )
        known = self.of_slider(sigma)
        start, end = map(_along_segments, (known.start, known.end))
        last = xarray.DataArray(t_end)
        until = xarray.where(following < last, following, last)
        part = (until - begin) / (following - begin)
        base = np.minimum(start, start + part * (end - start))
        low = base + self.amplitude * _lowest_sine(begin / self.period, until / self.period)
        low = low.where(until > begin, np.inf)
        each = low.min([dim for dim in low.dims if dim != "segment"])
        k = int(each.values.argmin())
        return float(each[k]), float(begin[k]), float(until.isel(segment=k).max())


def _along_segments(column):
    """A column as a DataArray, with ``segment`` last."""
    import xarray

    return column if is_array(column) else xarray.DataArray(column, dims="segment")


def _filled(column, sigma):
    """A column with sigma, float or DataArray, where it is NaN."""
    if not np.isnan(column).any():
        return column
    if is_array(column) or is_array(sigma):
        return _along_segments(column).fillna(sigma).transpose(..., "segment")
    return np.where(np.isnan(column), sigma, column)


def _same(one, other):
    """(S,) where two columns are equal in all cases, the slider's own sigma among their values."""
    one, other = np.asarray(one), np.asarray(other)
    equal = (one == other) | (np.isnan(one) & np.isnan(other))
    return equal.all(axis=tuple(range(equal.ndim - 1)))


def _lowest_sine(begin, end):
    """The smallest sin(2 pi x) between two x, of arrays too."""
    trough = np.ceil(begin - 0.75) + 0.75
    lower = np.minimum(np.sin(2.0 * np.pi * begin), np.sin(2.0 * np.pi * end))
    return lower - (1.0 + lower) * (trough <= end)  # (np.where would lose the dimensions)
