"""What the load point does: a velocity, piecewise linear in time, with jumps allowed."""

import dataclasses
import functools
from typing import Any

import numpy as np

from .arrays import column, running_sum, stack
from .errors import ParameterError
from .units import is_array, named, to_si


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Loading:
    """History of the load-point velocity from t = 0 on; made by `steps`, `constant` or `series`.

    Attributes
    ----------
    t : ndarray, shape (S,)
        Starts of the segments [s], increasing from 0.
    V : ndarray, shape (S,), or DataArray with the sweep's dimensions and then ``segment``
        Speed [m/s] at the start of each segment.
    rate : like V
        Acceleration [m/s^2] within each segment; 0 where the speed is constant.
    t_last : float
        Where the history ends [s]: inf, but for a series.
    """

    t: np.ndarray
    V: Any
    rate: Any
    t_last: float = np.inf

    @classmethod
    def constant(cls, V):
        """One speed V [m/s], >= 0, for ever."""
        V = stack({"V": to_si("V_lp", V, label="V", bound=">= 0")})
        return cls(np.zeros(1), V, 0.0 * V)

    @classmethod
    def steps(cls, V_start, *steps):
        """Speeds that change at once: V_start, and V1 from t1 on, V2 from t2 on, ...

        Parameters
        ----------
        V_start : float, str, pint.Quantity or DataArray
            Speed until the first step [m/s], >= 0; a hold is a speed of 0.
        *steps : tuple (t, V)
            Time [s], > 0 and increasing, and the speed from then on [m/s], >= 0.  Speeds may be
            named DataArrays; times are common to all cases.

        Raises
        ------
        ParameterError
            A value of a wrong unit or range, times that do not increase, arrays that clash.
        """
        times, speeds = [0.0], {"V_start": to_si("V_lp", V_start, label="V_start", bound=">= 0")}
        for step in steps:
            if not isinstance(step, tuple | list) or len(step) != 2:
                raise ParameterError(f"step {step!r} is not a pair (t, V) such as (1.0, 3.2e-3)")
            t = to_si("t", step[0], label=f"t of step {len(times)}", bound="> 0")
            if is_array(t):
                raise ParameterError("the time of a step is one number, common to all cases")
            if t <= times[-1]:
                raise ParameterError(
                    f"t = {t!r} s of step {len(times)} must come after t = {times[-1]!r} s; "
                    f"give the steps in order of time"
                )
            label = f"V_lp from t = {t!r} s on"
            speeds[label] = to_si("V_lp", step[1], label=label, bound=">= 0")
            times.append(t)
        V = stack(speeds)
        return cls(np.array(times), V, 0.0 * V)

    @classmethod
    def series(cls, t, V_lp):
        """A sampled history, such as a laboratory record, taken as piecewise linear.

        Parameters
        ----------
        t : sequence of N >= 2 times
            Times [s], not decreasing from 0.  The same time in two rows is a jump.
        V_lp : sequence of N speeds
            Speeds [m/s], >= 0; each may be a string with a unit or a named DataArray.

        Raises
        ------
        ParameterError
            A wrong unit or range, times that decrease or come thrice; names the row, from 0 on.
        """
        times, V = column("t", t), column("V_lp", V_lp)
        if is_array(times) or times.size < 2 or V.shape[-1] != times.size:
            raise ParameterError(
                f"t has {times.size} and V_lp {V.shape[-1]} values; "
                f"a series needs as many times as speeds, and at least 2"
            )
        dt = np.diff(times)
        if times[0] != 0:
            raise ParameterError(f"t[0] = {times[0]:.6g} s must be 0: subtract it from all times")
        if (dt < 0).any():
            i = int(np.argmax(dt < 0))
            raise ParameterError(
                f"t[{i + 1}] = {times[i + 1]} s is less than t[{i}] = {times[i]} s: times must not "
                f"decrease; mend the record"
            )
        jump = np.concatenate([[True], dt == 0, [True]])  # nor may a jump be at either end
        if (jump[1:] & jump[:-1]).any():
            i = int(np.argmax(jump[1:] & jump[:-1]))
            where = "at an end of the series" if i in (0, times.size - 1) else "a third time"
            raise ParameterError(
                f"t[{i}] = {times[i]} s is repeated {where}: a jump is one time in two rows "
                f"between others; drop a row (V_start of `simulate` gives a start at another speed)"
            )
        keep = np.flatnonzero(dt > 0)
        start = V[..., keep]
        with np.errstate(over="ignore"):
            rate = (V[..., keep + 1] - np.asarray(start)) / dt[keep]
        if not np.isfinite(rate).all():
            raise ParameterError("two times are too close for a ramp; for a jump repeat the time")
        return cls(times[keep], start, rate, float(times[-1]))

    @property
    def V_first(self):
        """Speed at t = 0 [m/s], float or DataArray."""
        return named("V_load", self.V[..., 0])

    def covers(self, t_end):
        """Raise ParameterError unless the history reaches to t_end [s] (float or DataArray)."""
        if (last := float(np.max(t_end))) > self.t_last:
            raise ParameterError(
                f"t_end = {last!r} s is beyond the end of the loading series, {self.t_last!r} s; "
                f"shorten t_end or extend the series"
            )

    def V_load(self, t):
        """Speed of the load point [m/s] at times t [s]; at a jump, the speed after it.

        Parameters
        ----------
        t : array or DataArray
            Times from 0 to `t_last`, in any order.

        Returns
        -------
        ndarray or DataArray
            Shape of t if no speed is a DataArray; else the sweep's dimensions, then those of t
            (``time`` for a plain 1-D array).

        Raises
        ------
        ParameterError
            A time before 0 or after the end of a series.
        """
        V, rate, _, elapsed = self._at(t)
        return named("V_load", np.maximum(V + rate * elapsed, 0.0))  # rounding may pass 0

    def delta_lp(self, t):
        """Displacement of the load point [m] from t = 0 to times t [s], as `V_load`.

        The exact integral of the piecewise linear speed, to a few units in the last place
        however many segments there are.
        """
        V, rate, passed, elapsed = self._at(t)
        return named("delta_lp", passed + elapsed * (V + 0.5 * rate * elapsed))

    def _at(self, t):
        """V, rate, displacement so far of the segments that hold t, and the times since then."""
        seconds = np.asarray(t, dtype=float)
        outside = ~((seconds >= 0) & (seconds <= self.t_last))
        if outside.any():
            raise ParameterError(
                f"t = {seconds[outside].flat[0]} s is outside the loading, 0 to {self.t_last!r} s"
            )
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

    def __repr__(self):
        sweep = f", sweep over {', '.join(self.V.dims[:-1])}" if is_array(self.V) else ""
        return f"<Loading: {self.t.size} segments from t = 0 to {self.t_last:g} s{sweep}>"
