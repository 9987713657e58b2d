"""Normal stress beside a history of speeds: how it is made, and what it is at any time."""

import dataclasses

import numpy as np

from ...errors import ParameterError
from ..arrays import check_aligned
from ..units import one_in_si, to_si
from .events import end_of, time_after
from .normal_stress import NormalStress
from .segments import Segments
from .shapes import period_of


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class StressHistory(Segments):
    """A velocity and the normal stress beside it; the fields are those of `Loading`."""

    normal_stress: NormalStress | None = dataclasses.field(default=None, kw_only=True)

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
            The other history; this one stays as it is.

        Raises
        ------
        ParameterError
            A wrong unit or range; a series that has a normal stress of its own; t after the end
            of the history.

        Examples
        --------
        >>> Loading.constant("10 um/s").sigma_step("2 s", "2.1 MPa").sigma_step("4 s", "2 MPa")
        <Loading: 1 segments from t = 0 to inf s, and 3 of normal stress>
        """
        before, t = self._stress_before(t)
        return dataclasses.replace(self, normal_stress=before.then(t, _stress_from(t, sigma)))

    def sigma_ramp(self, t, sigma, duration):
        """The same history, with a steady change of normal stress to sigma.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Its start [s], as of `sigma_step`.
        sigma : float, str, pint.Quantity or DataArray
            Normal stress in the end [Pa], > 0.
        duration : float, str or pint.Quantity
            Length of the change [s], > 0.

        Returns
        -------
        Loading
            The other history; this one stays as it is.

        Raises
        ------
        ParameterError
            As of `sigma_step`.
        """
        before, t = self._stress_before(t)
        ramp = before.then_ramp(t, _stress_from(t, sigma), end_of(t, duration, "ramp"))
        return dataclasses.replace(self, normal_stress=ramp)

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
            The other history; this one stays as it is.

        Raises
        ------
        ParameterError
            As of `sigma_step`; a normal stress that has a sinusoid already.
        """
        before = self._stress_so_far()
        if not np.all(np.isinf(before.period)):
            raise ParameterError("the normal stress has a sinusoid already, and can have only one")
        amplitude = to_si("sigma", amplitude, label="amplitude", bound=">= 0")
        period = period_of("a sinusoid of sigma", period, frequency)
        check_aligned({"amplitude": amplitude, "period": period})
        wave = dataclasses.replace(before, amplitude=amplitude, period=period)
        return dataclasses.replace(self, normal_stress=wave)

    def sigma(self, t, sigma):
        """Normal stress [Pa] at times t [s] on a slider whose own is sigma; after a jump there.

        Parameters
        ----------
        t : array, DataArray, float, str or pint.Quantity
            Times from 0 to `t_last`, in any order.
        sigma : float, str, pint.Quantity or DataArray
            Normal stress of the slider [Pa].

        Returns
        -------
        ndarray or DataArray
            As of `V_load`.

        Raises
        ------
        ParameterError
            A time before 0 or after the end of a series; a value that is not a time, or not a
            normal stress > 0.
        """
        known = self.normal_stress or NormalStress()
        return known.at(self._checked(t), to_si("sigma", sigma))

    def slider_at(self, t, slider):
        """The slider as it is at time t: with the normal stress of then as its own.

        Its critical stiffness and velocity, and its `stability`, are then those of that time.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Time [s], >= 0; inf for the normal stress that the history comes to in the end, or,
            under a sinusoid, then oscillates about.
        slider : SpringSlider
            With the normal stress of the beginning.

        Returns
        -------
        SpringSlider
            The same slider where nothing changes normal stress.

        Raises
        ------
        ParameterError
            A time before 0 or, but for inf, after the end of a series; a value that is not
            one time.

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
            sigma = stress.last(slider.sigma)
        else:
            sigma = self.sigma(one_in_si("t", t), slider.sigma)
        return slider.replace(sigma=sigma) if self.normal_stress else slider

    @property
    def stress_oscillates(self):
        """Whether normal stress has a sinusoid, and so varies for ever."""
        return self.normal_stress is not None and self.normal_stress.oscillates

    def _stress_so_far(self):
        stress = self.normal_stress or NormalStress()
        if not np.isnan(np.asarray(stress.start)[..., 0]).all():
            raise ParameterError(
                "the series has a normal stress of its own; put the change into its rows"
            )
        return stress

    def _stress_before(self, t):
        """That so far, and t [s], when an event begins: after the last, and within the history."""
        stress, t = self._stress_so_far(), one_in_si("t", t, bound="> 0")
        if t >= self.t_last:
            raise ParameterError(
                f"t = {t!r} s is not before the end of the history, {self.t_last!r} s"
            )
        return stress, time_after(t, float(stress.t[-1]), stress.returns, "normal stress")


def _stress_from(t, sigma):
    """Normal stress [Pa], > 0, from t [s] on: float or DataArray, else ParameterError."""
    return to_si("sigma", sigma, label=f"sigma from t = {t!r} s on", bound="> 0")
