"""Speed and normal stress in time: piecewise linear, with jumps allowed."""

import dataclasses
import functools
from typing import Any

import numpy as np

from ..errors import ParameterError
from .arrays import as_column, as_frame, column, continued, picked, running_sum
from .segments import Sine
from .units import is_array, named, one_in_si, to_si

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
        Normal stress [Pa] at the start and at the end of each segment.  The last end holds from
        there on.
    amplitude, period : float or DataArray
        Amplitude [Pa] and period [s] of the sinusoid; 0 and inf if there is none.
    returns : bool
        Whether the last segment only ends a ramp, so that another event may begin with it.
    """

    t: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(1))
    start: Any = dataclasses.field(default_factory=lambda: np.array([np.nan]))
    end: Any = dataclasses.field(default_factory=lambda: np.array([np.nan]))
    amplitude: Any = 0.0
    period: Any = np.inf
    returns: bool = False

    def then(self, *pieces, returns=False):
        """The history up to the first of these pieces (t, start, end), and from then on them."""
        t, start, end = continued(self.t, (self.start, self.end), pieces, "sigma")
        return dataclasses.replace(self, t=t, start=start, end=end, returns=returns)

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

        Shapes are those of `History.V_load` for arrays.
        """
        known, seconds = self.of_slider(sigma), np.asarray(t, dtype=float)
        k = self.segments_at(seconds)
        numbers = self.part_passed(seconds, k), seconds
        if any(map(is_array, (self.amplitude, self.period))):
            t = as_frame(t)
        start, end, part, when = picked(t, k, (known.start, known.end), numbers)
        phase = when / self.period
        wave = self.amplitude * np.sin(2.0 * np.pi * (phase - np.round(phase)))
        found = start + part * (end - start) + wave
        if not is_array(found):
            return found
        return named("sigma", found.transpose(..., "time", missing_dims="ignore"))

    def segments_at(self, t):
        """Numbers of the segments that hold times t [s], or begin then."""
        return np.searchsorted(self.t, t, side="right") - 1

    def part_passed(self, t, k):
        """The part of segments k that has passed at times t [s]; the last one is constant."""
        lasting = np.append(np.diff(self.t), 1.0)
        return np.minimum((t - self.t[k]) / lasting[k], 1.0)

    def of_slider(self, sigma):
        """The history with this sigma [Pa] of the slider in place of NaN."""
        start, end = (_filled(column, sigma) for column in (self.start, self.end))
        return dataclasses.replace(self, start=start, end=end)

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
            return  # each value of a step, ramp or record is > 0 by itself
        lowest, begin, end = self._lowest(sigma, t_end)
        if lowest <= 0.0:
            raise ParameterError(
                f"sigma would fall to {lowest:.6g} Pa between t = {begin:.6g} s and t = "
                f"{end:.6g} s; it must stay > 0: give a smaller amplitude, or a larger sigma"
            )

    def _lowest(self, sigma, t_end):
        """The lowest normal stress [Pa] up to t_end [s] in any case, and its segment's ends [s]."""
        import xarray

        begin, following = map(as_column, (self.t, np.append(self.t[1:], np.inf)))
        known = self.of_slider(sigma)
        start, end = map(as_column, (known.start, known.end))
        last = xarray.DataArray(t_end)
        until = xarray.where(following < last, following, last)
        base = np.minimum(start, start + (until - begin) / (following - begin) * (end - start))
        low = base + self.amplitude * _lowest_sine(begin / self.period, until / self.period)
        low = low.where(until > begin, np.inf)
        each = low.min([dim for dim in low.dims if dim != "segment"])
        k = int(each.values.argmin())
        return float(each[k]), float(begin[k]), float(until.isel(segment=k).max())


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class History:
    """Speed of the load point, and the normal stress with it; the fields are those of `Loading`."""

    t: np.ndarray
    V: Any
    rate: Any
    t_last: float = np.inf
    sine: Sine | None = None
    returns: bool = False
    normal_stress: NormalStress | None = None

    @property
    def V_first(self):
        """Speed at t = 0 [m/s], float or DataArray."""
        return named("V_load", self.V[..., 0])

    @property
    def stress_oscillates(self):
        """Whether normal stress has a sinusoid, and so varies for ever."""
        return self.normal_stress is not None and self.normal_stress.oscillates

    def covers(self, t_end):
        """Raise ParameterError if the history ends before a time.

        Parameters
        ----------
        t_end : float or DataArray
            Time [s].
        """
        if (last := float(np.max(t_end))) > self.t_last:
            raise ParameterError(
                f"t_end = {last!r} s is beyond the end of the loading series, {self.t_last!r} s; "
                f"shorten t_end or extend the series"
            )

    def V_load(self, t):
        """Speed of the load point [m/s] at times t [s]; at a jump, the speed after it.

        Parameters
        ----------
        t : array, DataArray, float, str or pint.Quantity
            Times from 0 to `t_last`, in any order; others raise ParameterError.

        Returns
        -------
        ndarray or DataArray
            Shape of t if no speed is a DataArray; else the sweep's dimensions, then those of t
            (``time`` for a plain 1-D array).
        """
        V, rate, _, elapsed = self._at(t)
        return named("V_load", np.maximum(V + rate * elapsed, 0.0))  # rounding may pass 0

    def delta_lp(self, t):
        """Displacement of the load point [m] from t = 0 to times t [s].

        The exact integral of the piecewise linear speed, to a few units in the last place
        however many segments there are.

        Parameters
        ----------
        t : array, DataArray, float, str or pint.Quantity
            As for `V_load`.

        Returns
        -------
        ndarray or DataArray
            As from `V_load`.
        """
        V, rate, passed, elapsed = self._at(t)
        return named("delta_lp", passed + elapsed * (V + 0.5 * rate * elapsed))

    def sigma(self, t, sigma):
        """Normal stress [Pa] at times t [s] on a slider whose own is sigma; after a jump there.

        Parameters
        ----------
        t : array, DataArray, float, str or pint.Quantity
            As for `V_load`.
        sigma : float, str, pint.Quantity or DataArray
            Normal stress of the slider [Pa], > 0.

        Returns
        -------
        ndarray or DataArray
            As from `V_load`.
        """
        known = self.normal_stress or NormalStress()
        return known.at(self._checked(t), to_si("sigma", sigma))

    def slider_at(self, t, slider):
        """The slider as it is at time t: with the normal stress of then as its own.

        Its critical stiffness and velocity, and its `stability`, are then those of that time.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Time [s], from 0 to `t_last`; inf for the normal stress that the history comes to in
            the end, or, under a sinusoid, then oscillates about.
        slider : SpringSlider
            With the normal stress of the beginning.

        Returns
        -------
        SpringSlider
            The same slider where nothing changes normal stress.

        Examples
        --------
        >>> import ratestate as rs
        >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m")
        >>> pull = rs.Loading.constant("10 um/s").sigma_ramp("2 s", "4 MPa", "1 s")
        >>> [pull.slider_at(t, slider).sigma for t in (0.0, 2.5, float("inf"))]
        [2000000.0, 3000000.0, 4000000.0]
        """
        stress = self.normal_stress or NormalStress()
        if isinstance(t, float) and t == np.inf:
            sigma = stress.of_slider(slider.sigma).end[..., -1]
        else:
            sigma = self.sigma(one_in_si("t", t), slider.sigma)
        return slider.replace(sigma=sigma) if self.normal_stress else slider

    def _checked(self, t):
        """Return times in SI, an array or DataArray; ParameterError for one outside the history."""
        if isinstance(t, list | tuple) or (isinstance(t, np.ndarray) and t.dtype.kind not in "iuf"):
            t = column("t", t)
        elif not isinstance(t, np.ndarray):
            t = to_si("t", t)
        seconds = np.asarray(t, dtype=float)
        outside = ~((seconds >= 0) & (seconds <= self.t_last))
        if outside.any():
            raise ParameterError(
                f"t = {seconds[outside].flat[0]} s is outside the loading, 0 to {self.t_last!r} s"
            )
        return t if is_array(t) else seconds

    def _at(self, t):
        """V, rate, displacement so far of the segments that hold t, and the times since then."""
        t = self._checked(t)
        seconds = np.asarray(t)
        k = np.searchsorted(self.t, seconds, side="right") - 1
        return picked(t, k, (self.V, self.rate, self._passed), [seconds - self.t[k]])

    @functools.cached_property
    def _passed(self):
        """Displacement [m] at the start of each segment, shape of V."""
        V, rate, dt = np.asarray(self.V), np.asarray(self.rate), np.diff(self.t)
        passed = np.zeros(V.shape)
        passed[..., 1:] = running_sum(dt * (V[..., :-1] + 0.5 * rate[..., :-1] * dt))
        return self.V.copy(data=passed) if is_array(self.V) else passed


def _filled(column, sigma):
    """A column with sigma, float or DataArray, in place of NaN."""
    if not np.isnan(column).any():
        return column
    if is_array(column) or is_array(sigma):
        return as_column(column).fillna(sigma).transpose(..., "segment")
    return np.where(np.isnan(column), sigma, column)


def _same(one, other):
    """(S,) whether two columns are equal in all cases; NaN, the slider's own, equals itself."""
    one, other = np.asarray(one), np.asarray(other)
    equal = (one == other) | (np.isnan(one) & np.isnan(other))
    return equal.all(axis=tuple(range(equal.ndim - 1)))


def _lowest_sine(begin, end):
    """The smallest sin(2 pi x) between two x, of arrays too."""
    trough = np.ceil(begin - 0.75) + 0.75
    lower = np.minimum(np.sin(2.0 * np.pi * begin), np.sin(2.0 * np.pi * end))
    return lower - (1.0 + lower) * (trough <= end)  # (np.where would lose the dimensions)
