"""The class `Loading`: what the load point does, and how a history is made."""

from dataclasses import dataclass, replace

import numpy as np

from ..errors import ParameterError
from .arrays import check_aligned, column_to_si
from .history import History
from .load_point import Call, LoadPoint
from .segments import histories_from_rows, period_of, sinusoid_history
from .units import is_array, one_in_si, to_si

#: methods that a `Call` may be of
METHODS = (
    *("constant", "series", "sinusoid", "step", "hold", "ramp"),
    *("sigma_step", "sigma_ramp", "sigma_sinusoid"),
)


@dataclass(frozen=True, eq=False, repr=False)
class Loading(LoadPoint):
    """History of the load-point velocity from t = 0 on, and of the normal stress with it.

    Made by `constant`, `steps`, `series` or `sinusoid`; the first two go on with `step`, `hold`
    and `ramp`, and all with `sigma_step`, `sigma_ramp` and `sigma_sinusoid`.  These return a longer
    history, and the one at hand stays as it is.  Speeds and normal stresses may be named
    DataArrays; times are common to all cases.

    Attributes
    ----------
    speed : History
        Speed of the load point [m/s]; ``t``, ``V`` and ``rate`` are parts of it.
    t_last : float
        End of the history [s]; inf unless the loading is a series or a sinusoid.
    normal_stress : NormalStress or None
        How sigma changes; None if sigma stays the slider's.
    calls : tuple of Call
        The calls that made the loading, with their arguments in SI.

    Raises
    ------
    ParameterError
        By all methods: a value of a wrong unit or range, an event before the end of the last one
        or after the end of a series or sinusoid, arrays that clash.
    """

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
        """
        V = to_si("V_lp", V, label="V", bound=">= 0")
        return cls(History.constant("V", V), calls=(Call("constant", {"V": V}),))

    @classmethod
    def steps(cls, V_start, *steps):
        """Speeds that change at once: V_start, and V1 from t1 on, V2 from t2 on, ...

        Parameters
        ----------
        V_start : float, str, pint.Quantity or DataArray
            Speed until the first step [m/s], >= 0; a hold is a speed of 0.
        *steps : tuple (t, V)
            Time [s], > 0 and increasing, and the speed from then on [m/s], >= 0.

        Returns
        -------
        Loading
            The history.
        """
        loading = cls.constant(to_si("V_lp", V_start, label="V_start", bound=">= 0"))
        for step in steps:
            if not isinstance(step, tuple | list) or len(step) != 2:
                raise ParameterError(f"step {step!r} is not a pair (t, V) such as (1.0, 3.2e-3)")
            loading = loading.step(*step)
        return loading

    @classmethod
    def series(cls, t, V_lp, *, sigma=None):
        """A sampled history, such as a laboratory record, taken as piecewise linear.

        Parameters
        ----------
        t : sequence of N >= 2 times
            Times [s], not decreasing from 0.  The same time in two rows is a jump, in three an
            error.
        V_lp : sequence of N speeds
            Speeds [m/s], >= 0; each may be a string with a unit or a named DataArray.
        sigma : sequence of N stresses, optional
            Normal stress [Pa], > 0, likewise; the first is the slider's sigma.

        Returns
        -------
        Loading
            The history.
        """
        given = {"t": t, "V_lp": V_lp} | ({} if sigma is None else {"sigma": sigma})
        columns = {symbol: column_to_si(symbol, values) for symbol, values in given.items()}
        speed, stress = histories_from_rows(*columns.values())
        return cls(speed, speed.until, stress, (Call("series", columns),))

    @classmethod
    def sinusoid(cls, V_lp, amplitude, *, t_end, period=None, frequency=None):
        """A speed V_lp + amplitude sin(2 pi t/period), from t = 0 to t_end.

        Straight lines, 256 a period and 10^6 at most, whose fundamental is exactly this one.  The
        speed is off by up to 5.1e-5 of the amplitude, the displacement by up to 1.3e-7 of its own
        amplitude.

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

        Returns
        -------
        Loading
            The history.
        """
        wave = {
            "V_lp": to_si("V_lp", V_lp),
            "amplitude": to_si("V_lp", amplitude, label="amplitude", bound=">= 0"),
            "period": period_of("a sinusoid", period, frequency),
            "t_end": float(np.max(to_si("t_end", t_end))),
        }
        return cls(sinusoid_history(**wave), wave["t_end"], calls=(Call("sinusoid", wave),))

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
            The longer history.

        Examples
        --------
        >>> Loading.constant("1 mm/s").step("1 s", "3.2 mm/s").hold("2 s", "100 s")
        <Loading: 4 segments from t = 0 to inf s>
        """
        t = self._check_speed_time(t)
        V = _value_after("V_lp", t, V, ">= 0")
        return self._append(Call("step", {"t": t, "V": V}), (t, V, V))

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
            The longer history.
        """
        t, V = self._check_speed_time(t), self.V[..., -1]
        duration = _duration(t, duration, "hold")
        call = Call("hold", {"t": t, "duration": duration})
        return self._append(call, (t, 0.0, 0.0), (t + duration, V, V))

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
            The longer history.
        """
        t, before = self._check_speed_time(t), self.V[..., -1]
        V, seconds = _value_after("V_lp", t, V, ">= 0"), _duration(t, duration, "ramp")
        call = Call("ramp", {"t": t, "V": V, "duration": seconds})
        longer = self._append(call, (t, before, V), (t + seconds, V, V))
        with np.errstate(over="ignore"):
            if not np.isfinite(longer.rate).all():
                raise ParameterError(f"ramp = {duration!r} is too short; for a jump leave it out")
        return longer

    def sigma_step(self, t, sigma):
        """The same history, with another normal stress from time t on.

        The slider's velocity does not jump with it; without mass it is at once the one at which
        friction balances the spring.  (Without damping too, a large fall may ask for a speed beyond
        double precision: take a short `sigma_ramp`.)  The state follows by the slider's alpha.
        Without mass it differs under the law of Nagata from a short ramp, in which friction follows
        the spring throughout: a step is what a slider of ever smaller mass does.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Later than the last change of normal stress, or where a ramp of it ends [s], > 0.
        sigma : float, str, pint.Quantity or DataArray
            Normal stress from then on [Pa], > 0.

        Returns
        -------
        Loading
            The other history.

        Examples
        --------
        >>> Loading.constant("10 um/s").sigma_step("2 s", "2.1 MPa").sigma_step("4 s", "2 MPa")
        <Loading: 1 segments from t = 0 to inf s, and 3 of normal stress>
        """
        t = self._check_stress_time(t)
        sigma = _value_after("sigma", t, sigma, "> 0")
        return self._append(Call("sigma_step", {"t": t, "sigma": sigma}), (t, sigma, sigma))

    def sigma_ramp(self, t, sigma, duration):
        """The same history, with a steady change of normal stress to sigma.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Its start [s], as for `sigma_step`.
        sigma : float, str, pint.Quantity or DataArray
            Normal stress in the end [Pa], > 0.
        duration : float, str or pint.Quantity
            Length of the change [s], > 0.

        Returns
        -------
        Loading
            The other history.
        """
        t, before = self._check_stress_time(t), self._extendable_stress().end[..., -1]
        sigma, seconds = _value_after("sigma", t, sigma, "> 0"), _duration(t, duration, "ramp")
        call = Call("sigma_ramp", {"t": t, "sigma": sigma, "duration": seconds})
        return self._append(call, (t, before, sigma), (t + seconds, sigma, sigma))

    def sigma_sinusoid(self, amplitude, *, period=None, frequency=None):
        """The same history, with amplitude sin(2 pi t/period) added to the normal stress.

        Parameters
        ----------
        amplitude : float, str, pint.Quantity or DataArray
            [Pa], >= 0; such that sigma stays > 0, which shows when the slider is known.
        period, frequency : float, str, pint.Quantity or DataArray
            One of them, > 0, [s] or [Hz].

        Returns
        -------
        Loading
            The other history, with one sinusoid of normal stress at most.
        """
        before = self._extendable_stress()
        if not np.all(np.isinf(before.period)):
            raise ParameterError("the normal stress has a sinusoid already, and can have only one")
        wave = {
            "amplitude": to_si("sigma", amplitude, label="amplitude", bound=">= 0"),
            "period": period_of("a sinusoid of sigma", period, frequency),
        }
        check_aligned(wave)
        return self._add_call(Call("sigma_sinusoid", wave), normal_stress=replace(before, **wave))

    def _append(self, call, *pieces):
        """The speed or the normal stress up to the first of these pieces, and then these."""
        if call.changes_stress:
            stress = self._extendable_stress().followed_by("sigma", *pieces)
            return self._add_call(call, normal_stress=stress)
        return self._add_call(call, speed=self.speed.followed_by("V_lp", *pieces))

    def _add_call(self, call, **history):
        return replace(self, calls=(*self.calls, call), **history)

    def _check_speed_time(self, t):
        """When an event begins [s]: after the last one, or where that ends."""
        if np.isfinite(self.t_last):
            raise ParameterError(
                f"the history ends at t = {self.t_last!r} s, and nothing can follow; "
                f"give steps to a constant speed, or put them into the rows of the series"
            )
        return self.speed.check_time(one_in_si("t", t, bound="> 0"), "the history")

    def _extendable_stress(self):
        stress = self._stress_history
        if not np.isnan(np.asarray(stress.start)[..., 0]).all():
            raise ParameterError(
                "the series has a normal stress of its own; put the change into its rows"
            )
        return stress

    def _check_stress_time(self, t):
        """When normal stress changes [s]: after its last change, and inside the history."""
        stress, t = self._extendable_stress(), one_in_si("t", t, bound="> 0")
        if t >= self.t_last:
            raise ParameterError(
                f"t = {t!r} s is not before the end of the history, {self.t_last!r} s"
            )
        return stress.check_time(t, "normal stress")

    def __repr__(self):
        stress = self.normal_stress
        more = "" if stress is None else f", and {stress.t.size} of normal stress"
        sweep = f", sweep over {', '.join(self.V.dims[:-1])}" if is_array(self.V) else ""
        return f"<Loading: {self.t.size} segments from t = 0 to {self.t_last:g} s{more}{sweep}>"


def _value_after(symbol, t, value, bound):
    return to_si(symbol, value, label=f"{symbol} from t = {t!r} s on", bound=bound)


def _duration(t, duration, label):
    """The length [s] of an event that begins at t [s]."""
    seconds = one_in_si("t", duration, label=label, bound="> 0")
    if not t < t + seconds < np.inf:
        raise ParameterError(f"{label} = {duration!r} is too short or too long after t = {t!r} s")
    return seconds
