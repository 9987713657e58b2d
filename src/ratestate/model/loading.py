"""The class `Loading`: a history of load-point speed and normal stress."""

from dataclasses import dataclass, replace

import numpy as np

from .arrays import check_aligned, column_to_si
from .history import History
from .load_point import LoadPoint, recorded
from .names import refusal
from .segments import histories_from_rows, period_of, sinusoid_history
from .units import is_array, one_in_si, to_si


@dataclass(frozen=True, eq=False, repr=False)
class Loading(LoadPoint):
    """History of the load-point velocity, and of the normal stress, from t = 0 on.

    Make a loading with `constant`, `steps`, `series` or `sinusoid`.  Extend the first two with
    `step`, `hold` and `ramp`, and all four with `sigma_step`, `sigma_ramp` and `sigma_sinusoid`.
    These methods return a new loading and do not change the old one.  Speeds and normal stresses
    may be named DataArrays, which make a sweep.  All cases of a sweep share the same times.

    Attributes
    ----------
    speed : History
        Speed of the load point [m/s].  `t`, `V` and `rate` of the loading have its segments.
    t_last : float
        End of the history [s]; inf unless the loading is a series or a sinusoid.
    normal_stress : History or None
        Normal stress [Pa] at ``start`` and ``end`` of its segments from ``t`` on, NaN while it is
        the slider's; None if it does not change.
    calls : tuple of Call
        The calls that made the loading, with their arguments as given.

    Raises
    ------
    ParameterError
        If a value has a wrong unit or is out of range, or if arrays clash.  Also if an event
        begins before the last one ends, or after the end of a series or sinusoid.

    Examples
    --------
    >>> Loading.constant("1 mm/s").step("1 s", "3.2 mm/s").hold("2 s", "100 s")
    <Loading: 4 segments from t = 0 to inf s>
    >>> Loading.constant("10 um/s").sigma_step("2 s", "2.1 MPa").sigma_step("4 s", "2 MPa")
    <Loading: 1 segments from t = 0 to inf s, and 3 of normal stress>
    """

    @classmethod
    @recorded
    def constant(cls, V_lp):
        """Return a loading with a constant speed.

        Parameters
        ----------
        V_lp : float, str, pint.Quantity or DataArray
            Speed of the load point [m/s], >= 0.
        """
        return cls(History.constant("V_lp", to_si("V_lp", V_lp, bound=">= 0")))

    @classmethod
    def steps(cls, V_lp, *steps):
        """Return a loading of velocity steps: V_lp, V1 from t1 on, V2 from t2 on, ...

        Parameters
        ----------
        V_lp : float, str, pint.Quantity or DataArray
            Speed of the load point until the first step [m/s], >= 0; a hold is a speed of 0.
        *steps : tuple (t, V_lp)
            Time of each step [s], > 0 and increasing, and the speed after it [m/s], >= 0.

        Returns
        -------
        Loading
            The loading.
        """
        loading = cls.constant(V_lp)
        for step in steps:
            if not isinstance(step, tuple | list) or len(step) != 2:
                raise refusal("loading.no_pair", step=step)
            loading = loading.step(*step)
        return loading

    @classmethod
    @recorded
    def series(cls, t, V_lp, *, sigma=None):
        """Return a piecewise linear loading from samples, such as a laboratory record.

        Parameters
        ----------
        t : sequence of N >= 2 times
            Times [s], starting at 0 and not decreasing.  A time in two rows is a jump.  A time in
            three rows, or a jump at the first or last time, is an error.
        V_lp : sequence of N speeds
            Speeds [m/s], >= 0; each may be a string with a unit or a named DataArray.
        sigma : sequence of N stresses, optional
            Normal stresses [Pa], > 0, in the same forms.  The first must equal the slider's sigma.
        """
        given = {"t": t, "V_lp": V_lp} | ({} if sigma is None else {"sigma": sigma})
        columns = (column_to_si(symbol, values) for symbol, values in given.items())
        speed, stress = histories_from_rows(*columns)
        return cls(speed, speed.until, stress)

    @classmethod
    @recorded
    def sinusoid(cls, V_lp, amplitude, *, t_end, period=None, frequency=None):
        """Return a loading with the speed V_lp + amplitude sin(2 pi t/period).

        The speed consists of straight lines: 256 per period, and at most 10^6.  Their fundamental
        is exactly this sinusoid.  The error of the speed is at most 5.1e-5 of its amplitude.  The
        error of the displacement is at most 1.3e-7 of the displacement's amplitude.

        Parameters
        ----------
        V_lp : float, str, pint.Quantity or DataArray
            Mean speed [m/s], > 0.
        amplitude : float, str, pint.Quantity or DataArray
            Amplitude of the speed [m/s], from 0 to V_lp.
        t_end : float, str, pint.Quantity or DataArray
            End of the history [s], > 0.  For a DataArray it is the latest value.
        period, frequency : float, str or pint.Quantity
            Period [s] or frequency [Hz], > 0, common to all cases.  Give one of them.
        """
        wave = {
            "V_lp": to_si("V_lp", V_lp),
            "amplitude": to_si("V_lp", amplitude, label="amplitude", bound=">= 0"),
            "period": period_of("a sinusoid", period, frequency),
            "t_end": float(np.max(to_si("t_end", t_end))),
        }
        return cls(sinusoid_history(**wave), wave["t_end"])

    @recorded
    def step(self, t, V_lp):
        """Add a velocity step: from time t on, the speed is V_lp.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Time of the step [s]: after the last event, or at the end of a hold or ramp.
        V_lp : float, str, pint.Quantity or DataArray
            Speed after the step [m/s], >= 0.
        """
        return self._with_speed("step", t, V_lp)

    @recorded
    def hold(self, t, duration):
        """Add a hold: from time t the load point rests, then it resumes its old speed.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Start of the hold [s]: after the last event, or at the end of a hold or ramp.
        duration : float, str or pint.Quantity
            Duration of the hold [s], > 0.
        """
        return self._with_speed("hold", t, duration)

    @recorded
    def ramp(self, t, V_lp, duration):
        """Add a ramp: from time t the speed changes linearly to V_lp.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Start of the ramp [s]: after the last event, or at the end of a hold or ramp.
        V_lp : float, str, pint.Quantity or DataArray
            Speed at the end of the ramp, and after it [m/s], >= 0.
        duration : float, str or pint.Quantity
            Duration of the ramp [s], > 0.
        """
        return self._with_speed("ramp", t, V_lp, duration)

    @recorded
    def sigma_step(self, t, sigma):
        """Add a step of normal stress: from time t on, the normal stress is sigma.

        A slider with mass keeps its velocity during the step.  Without mass, its velocity jumps so
        that friction balances the spring.  If it has no damping either, a large fall of sigma may
        need a velocity beyond double precision; use a short `sigma_ramp` then.  The state changes
        according to the slider's alpha.
        Under the law of Nagata and without mass, a step differs from a short ramp.  During a ramp,
        friction balances the spring at all times.  A step describes the limit of vanishing mass.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Time of the step [s], > 0: after the last change of normal stress, or at the end of a
            ramp of normal stress.
        sigma : float, str, pint.Quantity or DataArray
            Normal stress after the step [Pa], > 0.
        """
        return self._with_stress("step", t, sigma)

    @recorded
    def sigma_ramp(self, t, sigma, duration):
        """Add a ramp of normal stress: from time t it changes linearly to sigma.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Start of the ramp [s], as for `sigma_step`.
        sigma : float, str, pint.Quantity or DataArray
            Normal stress at the end of the ramp, and after it [Pa], > 0.
        duration : float, str or pint.Quantity
            Duration of the ramp [s], > 0.
        """
        return self._with_stress("ramp", t, sigma, duration)

    @recorded
    def sigma_sinusoid(self, amplitude, *, period=None, frequency=None):
        """Add amplitude sin(2 pi t/period) to the normal stress; only one can be added.

        Parameters
        ----------
        amplitude : float, str, pint.Quantity or DataArray
            Amplitude [Pa], >= 0.  `simulate` checks that sigma stays > 0.
        period, frequency : float, str, pint.Quantity or DataArray
            Period [s] or frequency [Hz], > 0.  Give one of them.
        """
        before = self._extendable_stress()
        if not np.all(np.isinf(before.period)):
            raise refusal("loading.two_sinusoids")
        wave = {
            "amplitude": to_si("sigma", amplitude, label="amplitude", bound=">= 0"),
            "period": period_of("a sinusoid of sigma", period, frequency),
        }
        check_aligned(wave)
        return replace(self, normal_stress=replace(before, **wave))

    def _with_speed(self, event, *arguments):
        """Return the loading with an event, a method of `History`, added to its speed."""
        if np.isfinite(self.t_last):
            raise refusal("loading.ended", last=self.t_last)
        return replace(self, speed=getattr(self.speed, event)(*arguments))

    def _with_stress(self, event, t, *arguments):
        """Return the loading with an event added to its normal stress."""
        stress, t = self._extendable_stress(), one_in_si("t", t, bound="> 0")
        if t >= self.t_last:
            raise refusal("loading.late", t=t, last=self.t_last)
        return replace(self, normal_stress=getattr(stress, event)(t, *arguments))

    def _extendable_stress(self):
        stress = self._stress_history
        if not np.isnan(np.asarray(stress.start)[..., 0]).all():
            raise refusal("loading.stress_of_series")
        return stress

    def __repr__(self):
        stress = self.normal_stress
        more = "" if stress is None else f", and {stress.t.size} of normal stress"
        sweep = f", sweep over {', '.join(self.V.dims[:-1])}" if is_array(self.V) else ""
        return f"<Loading: {self.t.size} segments from t = 0 to {self.t_last:g} s{more}{sweep}>"


def as_loading(value):
    """Return a loading; a speed is made a constant loading."""
    return value if isinstance(value, Loading) else Loading.constant(value)
