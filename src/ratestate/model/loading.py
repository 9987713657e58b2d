"""The class `Loading`: what the load point does, and how a history is made."""

import dataclasses

import numpy as np

from ..errors import ParameterError
from .arrays import check_aligned, continued, stack
from .history import History, NormalStress
from .segments import Sine, period_of, segments_of_rows, stress_of_rows
from .units import is_array, one_in_si, to_si


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Loading(History):
    """History of the load-point velocity from t = 0 on, and of the normal stress with it.

    Made by `constant`, `steps`, `series` or `sinusoid`; the first two go on with `step`, `hold`
    and `ramp`, and all with `sigma_step`, `sigma_ramp` and `sigma_sinusoid`.  These return a longer
    history, and the one at hand stays as it is.  Speeds and normal stresses may be named
    DataArrays; times are common to all cases.

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
    returns : bool
        Whether the last segment only ends a hold or ramp, so that another event may begin with it.
    normal_stress : NormalStress or None
        How sigma changes; None where it stays that of the slider.

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
            Time [s], > 0 and increasing, and the speed from then on [m/s], >= 0.

        Returns
        -------
        Loading
            The history.
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
            speeds[f"V_lp from t = {t!r} s on"] = _speed_from(t, step[1])
            times.append(t)
        V = stack(speeds)
        return cls(np.array(times), V, 0.0 * V)

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
        times, keep, V, rate = segments_of_rows(t, V_lp)
        stress = None if sigma is None else NormalStress(*stress_of_rows(times, keep, sigma))
        return cls(times[keep], V, rate, float(times[-1]), normal_stress=stress)

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
            The longer history.

        Examples
        --------
        >>> Loading.constant("1 mm/s").step("1 s", "3.2 mm/s").hold("2 s", "100 s")
        <Loading: 4 segments from t = 0 to inf s>
        """
        t = self._time(t)
        return self._then((t, _speed_from(t, V), 0.0), returns=False)

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
        t = self._time(t)
        end = _end_of(t, duration, "hold")
        return self._then((t, 0.0, 0.0), (end, self.V[..., -1], 0.0), returns=True)

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
        t = self._time(t)
        V, before = _speed_from(t, V), self.V[..., -1]
        end = _end_of(t, duration, "ramp")
        check_aligned({"V_lp before": before, f"V_lp from t = {end!r} s on": V})
        with np.errstate(over="ignore"):
            rate = (V - before) / (end - t)
        if not np.isfinite(rate).all():
            raise ParameterError(f"ramp = {duration!r} is too short; for a jump leave it out")
        return self._then((t, before, rate), (end, V, 0.0), returns=True)

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
        before, t = self._stress_before(t)
        sigma = _stress_from(t, sigma)
        return dataclasses.replace(self, normal_stress=before.then((t, sigma, sigma)))

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
        before, t = self._stress_before(t)
        sigma = _stress_from(t, sigma)
        pieces = (t, before.end[..., -1], sigma), (_end_of(t, duration, "ramp"), sigma, sigma)
        return dataclasses.replace(self, normal_stress=before.then(*pieces, returns=True))

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
        before = self._stress_so_far()
        if not np.all(np.isinf(before.period)):
            raise ParameterError("the normal stress has a sinusoid already, and can have only one")
        amplitude = to_si("sigma", amplitude, label="amplitude", bound=">= 0")
        period = period_of("a sinusoid of sigma", period, frequency)
        check_aligned({"amplitude": amplitude, "period": period})
        wave = dataclasses.replace(before, amplitude=amplitude, period=period)
        return dataclasses.replace(self, normal_stress=wave)

    def _then(self, *pieces, returns):
        """The history up to the first of these pieces (t, V, rate), and from then on them."""
        t, V, rate = continued(self.t, (self.V, self.rate), pieces, "V_lp")
        if is_array(V):  # one of them may not depend on what the other does
            rate = rate + 0.0 * V
        return dataclasses.replace(self, t=t, V=V, rate=rate, returns=returns)

    def _time(self, t):
        """When an event begins [s]: after the last one, or where that ends."""
        if np.isfinite(self.t_last):
            raise ParameterError(
                f"the history ends at t = {self.t_last!r} s, and nothing can follow; "
                f"give steps to a constant speed, or put them into the rows of the series"
            )
        t = one_in_si("t", t, bound="> 0")
        return _time_after(t, float(self.t[-1]), self.returns, "the history")

    def _stress_so_far(self):
        stress = self.normal_stress or NormalStress()
        if not np.isnan(np.asarray(stress.start)[..., 0]).all():
            raise ParameterError(
                "the series has a normal stress of its own; put the change into its rows"
            )
        return stress

    def _stress_before(self, t):
        """The stress so far, and t [s]: after its last event, and inside the history."""
        stress, t = self._stress_so_far(), one_in_si("t", t, bound="> 0")
        if t >= self.t_last:
            raise ParameterError(
                f"t = {t!r} s is not before the end of the history, {self.t_last!r} s"
            )
        return stress, _time_after(t, float(stress.t[-1]), stress.returns, "normal stress")

    def __repr__(self):
        stress = self.normal_stress
        more = "" if stress is None else f", and {stress.t.size} of normal stress"
        sweep = f", sweep over {', '.join(self.V.dims[:-1])}" if is_array(self.V) else ""
        return f"<Loading: {self.t.size} segments from t = 0 to {self.t_last:g} s{more}{sweep}>"


def _time_after(t, last, returns, what):
    """t [s], if it comes after the last event, or where a hold or ramp ends."""
    if returns and abs(t - last) <= 1e-12 * last:  # 0.1 s + 0.2 s is not quite 0.3 s
        return last
    if t <= last:
        raise ParameterError(
            f"t = {t!r} s must come after t = {last!r} s, up to which {what} is given; "
            f"give the steps in order of time"
        )
    return t


def _speed_from(t, V):
    return to_si("V_lp", V, label=f"V_lp from t = {t!r} s on", bound=">= 0")


def _stress_from(t, sigma):
    return to_si("sigma", sigma, label=f"sigma from t = {t!r} s on", bound="> 0")


def _end_of(t, duration, label):
    """When an event is over [s]."""
    lasting = one_in_si("t", duration, label=label, bound="> 0")
    if not t < t + lasting < np.inf:
        raise ParameterError(f"{label} = {duration!r} is too short or too long after t = {t!r} s")
    return t + lasting
