"""Segments of constant acceleration, and where they have come to at any time."""

import dataclasses
import functools
from typing import Any

import numpy as np

from ...errors import ParameterError
from ..arrays import column, running_sum
from ..units import is_array, named, to_si


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Segments:
    """A velocity, piecewise linear in time from t = 0 on; the fields are those of `Loading`."""

    t: np.ndarray
    V: Any
    rate: Any
    t_last: float = np.inf

    @property
    def V_first(self):
        """Speed at t = 0 [m/s], float or DataArray."""
        return named("V_load", self.V[..., 0])

    def covers(self, t_end):
        """Refuse a time that the history does not reach.

        Parameters
        ----------
        t_end : float or DataArray
            Time [s].

        Raises
        ------
        ParameterError
            The history ends before it.
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
            Times from 0 to `t_last`, in any order.

        Returns
        -------
        ndarray or DataArray
            Shape of t if no speed is a DataArray; else the sweep's dimensions, then those of t
            (``time`` for a plain 1-D array).

        Raises
        ------
        ParameterError
            A time before 0 or after the end of a series; one that is not a time.
        """
        V, rate, _, elapsed = self._at(t)
        return named("V_load", np.maximum(V + rate * elapsed, 0.0))  # rounding may pass 0

    def delta_lp(self, t):
        """Displacement of the load point [m] from t = 0 to times t [s].

        The exact integral of the piecewise linear speed, to a few units in the last place
        however many segments there are.

        Parameters
        ----------
        t : array or DataArray
            As of `V_load`.

        Returns
        -------
        ndarray or DataArray
            As of `V_load`.

        Raises
        ------
        ParameterError
            As of `V_load`.
        """
        V, rate, passed, elapsed = self._at(t)
        return named("delta_lp", passed + elapsed * (V + 0.5 * rate * elapsed))

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
        elapsed = seconds - self.t[k]
        columns = (self.V, self.rate, self._passed)
        if not is_array(t) and not is_array(self.V):
            return *(column[k] for column in columns), elapsed
        import xarray

        frame = t if is_array(t) else xarray.DataArray(seconds, dims=["time"][: seconds.ndim])
        arrays = (xarray.DataArray(c, dims=getattr(c, "dims", "segment")) for c in columns)
        picked = (array.isel(segment=frame.copy(data=k)) for array in arrays)
        ordered = (array.transpose(..., "time", missing_dims="ignore") for array in picked)
        return *ordered, frame.copy(data=elapsed)

    @functools.cached_property
    def _passed(self):
        """Displacement [m] at the start of each segment, shape of V."""
        V, rate, dt = np.asarray(self.V), np.asarray(self.rate), np.diff(self.t)
        pieces = dt * (V[..., :-1] + 0.5 * rate[..., :-1] * dt)
        passed = np.zeros(V.shape)
        passed[..., 1:] = running_sum(pieces)
        return self.V.copy(data=passed) if is_array(self.V) else passed
