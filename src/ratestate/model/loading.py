"""The class `Loading`: a history of load-point speed and normal stress."""

from dataclasses import dataclass, replace

import numpy as np

from ..errors import ParameterError
from .arrays import check_aligned, column_to_si
from .history import History
from .load_point import LoadPoint, recorded
from .segments import histories_from_rows, period_of, sinusoid_history
from .units import is_array, one_in_si, to_si


@dataclass(frozen=True, eq=False, repr=False)
class Loading(LoadPoint):
    """History of the load-point velocity, and of the normal stress, from t = 0 on.

    Make a loading by `constant`, `steps`, `series` or `sinusoid`.  Extend the first two by `step`,
    `hold` and `ramp`, and all four by `sigma_step`, `sigma_ramp` and `sigma_sinusoid`.  These
    methods return a new loading and do not change the old one.  Speeds and normal stresses may be
    named DataArrays.  All cases share the same times.

    Attributes
    ----------
    speed : History
        Speed of the load point [m/s]; ``t``, ``V`` and ``rate`` belong to it.
    t_last : float
        End of the history [s]; inf unless the loading is a series or a sinusoid.
    normal_stress : NormalStress or None
        History of the normal stress; None if it does not change.
    calls : tuple of Call
        The calls that made the loading, with their arguments as given.

    Raises
    ------
    ParameterError
        By all methods, if a value has a wrong unit or is out of range, if an event begins before
        the last one ends or after the end of a series or sinusoid, or if arrays clash.
    """

    @classmethod
    @recorded
    def constant(cls, V):
        """Return a loading with a constant speed.

        Parameters
        ----------
        V : float, str, pint.Quantity or DataArray
            Speed [m/s], >= 0.

        Returns
        -------
        Loading
            The loading.
        """
        V = to_si("V_lp", V, label="V", bound=">= 0")
        return cls(History.constant("V", V))

    @classmethod
    def steps(cls, V_start, *steps):
        """Return a loading of velocity steps: V_start, V1 from t1 on, V2 from t2 on, ...

        Parameters
        ----------
        V_start : float, str, pint.Quantity or DataArray
            Speed until the first step [m/s], >= 0; a hold is a speed of 0.
        *steps : tuple (t, V)
            Time of each step [s], > 0 and increasing, and the speed after it [m/s], >= 0.

        Returns
        -------
        Loading
            The loading.
        """
        to_si("V_lp", V_start, label="V_start", bound=">= 0")  # its messages name V_start
        loading = cls.constant(V_start)
        for step in steps:
            if not isinstance(step, tuple | list) or len(step) != 2:
                raise ParameterError(
                    f"the step {step!r} is not a pair (t, V)", "Give pairs such as (1.0, 3.2e-3)."
                )
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
            three rows is an error.
        V_lp : sequence of N speeds
            Speeds [m/s], >= 0; each may be a string with a unit or a named DataArray.
        sigma : sequence of N stresses, optional
            Normal stresses [Pa], > 0, in the same forms.  The first equals the slider's sigma.

        Returns
        -------
        Loading
            The loading.
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
        t_end : float, str or pint.Quantity
            End of the history [s], > 0; the latest time of a DataArray.
        period, frequency : float, str or pint.Quantity
            Period [s] or frequency [Hz], > 0, common to all cases.  Give one of them.

        Returns
        -------
        Loading
            The loading.
        """
        wave = {
            "V_lp": to_si("V_lp", V_lp),
            "amplitude": to_si("V_lp", amplitude, label="amplitude", bound=">= 0"),
            "period": period_of("a sinusoid", period, frequency),
            "t_end": float(np.max(to_si("t_end", t_end))),
        }
        return cls(sinusoid_history(**wave), wave["t_end"])

    @recorded
    def step(self, t, V):
        """Add a velocity step: from time t on, the speed is V.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Time of the step [s]: after the last event, or at the end of a hold or ramp.
        V : float, str, pint.Quantity or DataArray
            Speed after the step [m/s], >= 0.

        Returns
        -------
        Loading
            The extended loading.

        Examples
        --------
        >>> Loading.constant("1 mm/s").step("1 s", "3.2 mm/s").hold("2 s", "100 s")
        <Loading: 4 segments from t = 0 to inf s>
        """
        t = self._check_speed_time(t)
        V = _value_after("V_lp", t, V, ">= 0")
        return self._with_speeds((t, V, V))

    @recorded
    def hold(self, t, duration):
        """Add a hold: from time t the load point rests, then it resumes its old speed.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Start of the hold [s]: after the last event, or at the end of a hold or ramp.
        duration : float, str or pint.Quantity
            Duration of the hold [s], > 0.

        Returns
        -------
        Loading
            The extended loading.
        """
        t, V = self._check_speed_time(t), self.V[..., -1]
        duration = _duration(t, duration, "hold")
        return self._with_speeds((t, 0.0, 0.0), (t + duration, V, V))

    @recorded
    def ramp(self, t, V, duration):
        """Add a ramp: from time t the speed changes linearly to V.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Start of the ramp [s]: after the last event, or at the end of a hold or ramp.
        V : float, str, pint.Quantity or DataArray
            Speed at the end of the ramp, and after it [m/s], >= 0.
        duration : float, str or pint.Quantity
            Duration of the ramp [s], > 0.

        Returns
        -------
        Loading
            The extended loading.
        """
        t, before = self._check_speed_time(t), self.V[..., -1]
        V, seconds = _value_after("V_lp", t, V, ">= 0"), _duration(t, duration, "ramp")
        longer = self._with_speeds((t, before, V), (t + seconds, V, V))
        with np.errstate(over="ignore"):
            if not np.isfinite(longer.rate).all():
                raise ParameterError(
                    "is too short",
                    "For a jump leave the ramp out.",
                    symbol="ramp",
                    value=repr(duration),
                )
        return longer

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

        Returns
        -------
        Loading
            The extended loading.

        Examples
        --------
        >>> Loading.constant("10 um/s").sigma_step("2 s", "2.1 MPa").sigma_step("4 s", "2 MPa")
        <Loading: 1 segments from t = 0 to inf s, and 3 of normal stress>
        """
        t = self._check_stress_time(t)
        sigma = _value_after("sigma", t, sigma, "> 0")
        return self._with_stresses((t, sigma, sigma))

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

        Returns
        -------
        Loading
            The extended loading.
        """
        t, before = self._check_stress_time(t), self._extendable_stress().end[..., -1]
        sigma, seconds = _value_after("sigma", t, sigma, "> 0"), _duration(t, duration, "ramp")
        return self._with_stresses((t, before, sigma), (t + seconds, sigma, sigma))

    @recorded
    def sigma_sinusoid(self, amplitude, *, period=None, frequency=None):
        """Add amplitude sin(2 pi t/period) to the normal stress; only one can be added.

        Parameters
        ----------
        amplitude : float, str, pint.Quantity or DataArray
            Amplitude [Pa], >= 0.  `simulate` checks that sigma stays > 0.
        period, frequency : float, str, pint.Quantity or DataArray
            Period [s] or frequency [Hz], > 0.  Give one of them.

        Returns
        -------
        Loading
            The extended loading.
        """
        before = self._extendable_stress()
        if not np.all(np.isinf(before.period)):
            raise ParameterError("the normal stress has a sinusoid already", "Give only one.")
        wave = {
            "amplitude": to_si("sigma", amplitude, label="amplitude", bound=">= 0"),
            "period": period_of("a sinusoid of sigma", period, frequency),
        }
        check_aligned(wave)
        return replace(self, normal_stress=replace(before, **wave))

    def _with_speeds(self, *pieces):
        """Return the loading with pieces (t, start, end) added to its speed."""
        return replace(self, speed=self.speed.followed_by("V_lp", *pieces))

    def _with_stresses(self, *pieces):
        """Return the loading with pieces (t, start, end) added to its normal stress."""
        stress = self._extendable_stress().followed_by("sigma", *pieces)
        return replace(self, normal_stress=stress)

    def _check_speed_time(self, t):
        if np.isfinite(self.t_last):
            raise ParameterError(
                f"the history ends at t = {self.t_last!r} s, and nothing can follow",
                "Give steps to a constant speed, or put them into the rows of the series.",
            )
        return self.speed.check_time(one_in_si("t", t, bound="> 0"), "the history")

    def _extendable_stress(self):
        stress = self._stress_history
        if not np.isnan(np.asarray(stress.start)[..., 0]).all():
            raise ParameterError(
                "the series has a normal stress of its own", "Put the change into its rows."
            )
        return stress

    def _check_stress_time(self, t):
        stress, t = self._extendable_stress(), one_in_si("t", t, bound="> 0")
        if t >= self.t_last:
            raise ParameterError(
                f"is not before the end of the history, {self.t_last!r} s",
                "Give an earlier time.",
                symbol="t",
                value=repr(t),
                unit="s",
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
    seconds = one_in_si("t", duration, label=label, bound="> 0")
    if not t < t + seconds < np.inf:
        raise ParameterError(
            f"is too short or too long after t = {t!r} s",
            "Give another duration.",
            symbol=label,
            value=repr(duration),
        )
    return seconds
