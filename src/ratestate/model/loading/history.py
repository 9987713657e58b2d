"""The class `Loading`: how a history is made."""

import dataclasses

import numpy as np

from ...errors import ParameterError
from ..arrays import stack
from ..units import is_array, one_in_si, to_si
from . import events, record
from .normal_stress import NormalStress
from .shapes import Sine
from .stress_history import StressHistory


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Loading(StressHistory):
    """History of the load-point velocity from t = 0 on.

    Made by `constant`, `steps`, `series` or `sinusoid`; the first two go on with `step`, `hold`
    and `ramp`, and all with `sigma_step`, `sigma_ramp` and `sigma_sinusoid`.

    Attributes
    ----------
    t : ndarray, shape (S,)
        Starts of the segments [s], increasing from 0.
    V : ndarray, shape (S,), or DataArray with the sweep's dimensions and then ``segment``
        Speed [m/s] at the start of each segment.
    rate : like V
        Acceleration [m/s^2] within each segment; 0 where the speed is constant.
    t_last : float
        Where the history ends [s]: inf, but for a series and a sinusoid.
    sine : Sine or None
        What a sinusoid was made from.
    returns : True or None
        Whether the last segment only ends a hold or ramp, so that another event may begin with it.
    normal_stress : NormalStress or None
        How sigma changes; None where it stays that of the slider.
    """

    sine: Sine | None = None
    returns: bool | None = None

    @property
    def shape(self):
        """What a periodic loading was made from, ``Sine``; None for any other."""
        return self.sine

    @classmethod
    def constant(cls, V):
        """One speed for ever.

        Parameters
        ----------
        V : float, str, pint.Quantity or DataArray
            Speed [m/s], >= 0.

        Returns
        -------
        Loading
            The history.

        Raises
        ------
        ParameterError
            A wrong unit or range.
        """
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
            t = one_in_si("t", step[0], label=f"t of step {len(times)}", bound="> 0")
            if t <= times[-1]:
                raise ParameterError(
                    f"t = {t!r} s of step {len(times)} must come after t = {times[-1]!r} s; "
                    f"give the steps in order of time"
                )
            speeds[f"V_lp from t = {t!r} s on"] = events.speed_from(t, step[1])
            times.append(t)
        V = stack(speeds)
        return cls(np.array(times), V, 0.0 * V)

    @classmethod
    def series(cls, t, V_lp, *, sigma=None):
        """A sampled history, such as a laboratory record, taken as piecewise linear.

        Parameters
        ----------
        t : sequence of N >= 2 times
            Times [s], not decreasing from 0.  The same time in two rows is a jump.
        V_lp : sequence of N speeds
            Speeds [m/s], >= 0; each may be a string with a unit or a named DataArray.
        sigma : sequence of N stresses, optional
            Normal stress [Pa], > 0, likewise; the first is the slider's sigma.

        Raises
        ------
        ParameterError
            A wrong unit or range, times that decrease or come thrice; names the row, from 0 on.
        """
        times, keep, V, rate = record.segments(t, V_lp)
        stress = None if sigma is None else NormalStress.of_record(times, keep, sigma)
        return cls(times[keep], V, rate, float(times[-1]), normal_stress=stress)

    @classmethod
    def sinusoid(cls, V_lp, amplitude, *, t_end, period=None, frequency=None):
        """A speed V_lp + amplitude sin(2 pi t/period), from t = 0 to t_end.

        Straight lines, 256 a period, whose fundamental is exactly this one.  The speed is off by up
        to 5.1e-5 of the amplitude, the displacement by up to 1.3e-7 of its own amplitude.

        Parameters
        ----------
        V_lp : float, str, pint.Quantity or DataArray
            Mean speed [m/s], > 0.
        amplitude : float, str, pint.Quantity or DataArray
            From 0 to V_lp [m/s].
        t_end : float, str or pint.Quantity
            Where the history ends [s], > 0; of a DataArray, the latest.
        period, frequency : float, str or pint.Quantity
            One of them, > 0, [s] or [Hz], common to all cases.

        Raises
        ------
        ParameterError
            A value of a wrong unit or range, arrays that clash, more than 10^6 lines.
        """
        sine = Sine.checked(V_lp, amplitude, period, frequency)
        t, V, rate, t_last = sine.lines(t_end)
        return cls(t, V, rate, t_last, sine)

    def step(self, t, V):
        """The same history up to time t [s], and from then on the speed V [m/s], >= 0.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Later than what happens last in the history, or where a hold or ramp ends.
        V : float, str, pint.Quantity or DataArray
            Speed from then on [m/s], >= 0.

        Returns
        -------
        Loading
            The longer history; this one stays as it is.

        Raises
        ------
        ParameterError
            A wrong unit or range; a history with an end, such as a series.

        Examples
        --------
        >>> Loading.constant("1 mm/s").step("1 s", "3.2 mm/s").hold("2 s", "100 s")
        <Loading: 4 segments from t = 0 to inf s>
        """
        return dataclasses.replace(self, **events.step(self, t, V))

    def hold(self, t, duration):
        """The same history up to time t, then rest for a while, then the speed before it.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Its start [s], from the end of what happens last in the history on.
        duration : float, str or pint.Quantity
            Length of the rest [s], > 0.

        Returns
        -------
        Loading
            The longer history; this one stays as it is.

        Raises
        ------
        ParameterError
            A wrong unit or range; a history with an end, such as a series.
        """
        return dataclasses.replace(self, **events.hold(self, t, duration))

    def ramp(self, t, V, duration):
        """The same history up to time t, then a steady change of speed to V.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Its start [s], from the end of what happens last in the history on.
        V : float, str, pint.Quantity or DataArray
            Speed in the end [m/s], >= 0.
        duration : float, str or pint.Quantity
            Length of the change [s], > 0.

        Returns
        -------
        Loading
            The longer history; this one stays as it is.

        Raises
        ------
        ParameterError
            A wrong unit or range; a history with an end, such as a series.
        """
        return dataclasses.replace(self, **events.ramp(self, t, V, duration))

    def __repr__(self):
        stress = self.normal_stress
        more = "" if stress is None else f", and {stress.t.size} of normal stress"
        sweep = f", sweep over {', '.join(self.V.dims[:-1])}" if is_array(self.V) else ""
        return f"<Loading: {self.t.size} segments from t = 0 to {self.t_last:g} s{more}{sweep}>"
