"""Speed and displacement of the load point, and normal stress, at any time in a loading."""

import dataclasses
import functools
import inspect
from typing import Any

import numpy as np

from .arrays import column_to_si, running_sum
from .history import History
from .names import refusal
from .units import is_array, named, one_in_si, to_si


@dataclasses.dataclass(frozen=True)
class Call:
    """A call of a method of `Loading`.

    Arguments are kept as they were given if they are texts, and otherwise in SI: numbers as floats,
    columns of a record as arrays.
    """

    method: str
    arguments: dict[str, Any]

    def apply_to(self, loading):
        """Return the result of the call on a loading, or on the class `Loading`."""
        return getattr(loading, self.method)(**self.arguments)

    def symbol(self, argument):
        """Return the symbol of the quantity that this argument is."""
        amplitude = "sigma" if self.changes_stress else "V_lp"
        return {"duration": "t", "amplitude": amplitude}.get(argument, argument)

    @property
    def changes_stress(self):
        """Whether the call changes the normal stress instead of the speed."""
        return self.method.startswith("sigma")

    @property
    def arguments_in_si(self):
        """Arguments as floats and arrays in SI."""
        return {
            name: to_si(self.symbol(name), value, bound="") if isinstance(value, str) else value
            for name, value in self.arguments.items()
        }


#: end of the docstring of a method that makes or extends a loading
RETURNS = """

Returns
-------
Loading
    The new loading.
"""


def recorded(method):
    """Make a method of `Loading` add its call to the loading that it returns."""
    signature = inspect.signature(method)
    method.__doc__ = (inspect.getdoc(method) or "") + RETURNS

    @functools.wraps(method)
    def call_and_record(loading, *args, **kwargs):
        result = method(loading, *args, **kwargs)
        _, *given = signature.bind(loading, *args, **kwargs).arguments.items()
        call = Call(method.__name__, {name: value for name, value in given if value is not None})
        kept = {name: _value_to_record(call, name, value) for name, value in call.arguments.items()}
        return dataclasses.replace(result, calls=(*loading.calls, Call(call.method, kept)))

    return call_and_record


def _value_to_record(call, name, value):
    if isinstance(value, str):
        return value
    if call.method == "series":
        return column_to_si(name, value)
    value = to_si(call.symbol(name), value, bound="")
    return float(np.max(value)) if name == "t_end" else value


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class LoadPoint:
    """Base class of `Loading`: speed, displacement and normal stress at any time."""

    speed: History
    t_last: float = np.inf
    normal_stress: History | None = None
    calls: tuple[Call, ...] = ()

    @property
    def t(self):
        """Start times of the segments [s], increasing from 0: array, shape (S,)."""
        return self.speed.t

    @property
    def V(self):
        """Speed [m/s] at the start of each segment: (S,), or DataArray (..., segment)."""
        return self.speed.start

    @property
    def rate(self):
        """Acceleration [m/s^2] in each segment, in the shape of V."""
        return self.speed.rate

    @property
    def parameters(self):
        """Arguments of all calls in SI, such as ``{"1 step": {"t": 1.0, "V_lp": 0.003}}``."""
        return {f"{i} {call.method}": call.arguments_in_si for i, call in enumerate(self.calls)}

    @property
    def V_first(self):
        """Speed at t = 0 [m/s]: float or DataArray."""
        return named("V_load", self.V[..., 0])

    @property
    def mean_speed(self):
        """Mean speed of a sinusoid [m/s]; None for any other loading."""
        first = self.calls[0]
        return first.arguments_in_si["V_lp"] if first.method == "sinusoid" else None

    @property
    def stress_oscillates(self):
        """Whether normal stress has a sinusoid, so that it varies for ever."""
        return self.normal_stress is not None and self.normal_stress.oscillates

    def covers(self, t_end):
        """Raise ParameterError if the history ends before t_end.

        Parameters
        ----------
        t_end : float or DataArray
            Time [s].
        """
        if (last := float(np.max(t_end))) > self.t_last:
            raise refusal("loading.too_short", t_end=last, last=self.t_last)

    def V_load(self, t):
        """Return the speed of the load point [m/s] at times t [s]; at a jump, after it.

        Parameters
        ----------
        t : float, str, pint.Quantity, sequence, array or DataArray
            Times from 0 to `t_last`, in any order.  Other times raise ParameterError.

        Returns
        -------
        float, ndarray or DataArray
            Shape of t if no speed is a DataArray.  Otherwise the dimensions of the sweep, followed
            by the dimensions of t (``time`` for a plain array, which must be 1-D).
        """
        V, rate, elapsed = self.speed.look_up(self._times_in_si(t), self.V, self.rate)
        return named("V_load", np.maximum(V + rate * elapsed, 0.0))  # < 0 by rounding

    def delta_lp(self, t):
        """Return the displacement of the load point [m] from t = 0 to times t [s].

        This is the exact integral of the piecewise linear speed.  Its rounding error is a few units
        in the last place, however many segments there are.

        Parameters
        ----------
        t : float, str, pint.Quantity, sequence, array or DataArray
            As for `V_load`.

        Returns
        -------
        float, ndarray or DataArray
            As from `V_load`.
        """
        columns = self.V, self.rate, self._displacements
        V, rate, delta, elapsed = self.speed.look_up(self._times_in_si(t), *columns)
        return named("delta_lp", delta + elapsed * (V + 0.5 * rate * elapsed))

    def sigma(self, t, sigma):
        """Return the normal stress [Pa] at times t [s]; at a jump, the stress after it.

        Parameters
        ----------
        t : float, str, pint.Quantity, sequence, array or DataArray
            As for `V_load`.
        sigma : float, str, pint.Quantity or DataArray
            Normal stress of the slider [Pa], > 0, at t = 0.

        Returns
        -------
        float, ndarray or DataArray
            As from `V_load`, with the dimensions of stresses in place of speeds.
        """
        t = self._times_in_si(t)
        return self._stress_history.with_sigma(to_si("sigma", sigma)).at(t)

    def slider_at(self, t, slider):
        """Return the slider with sigma set to the normal stress at time t.

        The critical stiffness, critical velocity and `stability` of this slider hold at time t.

        Parameters
        ----------
        t : float, str or pint.Quantity
            Time [s], from 0 to `t_last`.  If t is the float inf, sigma is the final normal stress,
            or its mean if it has a sinusoid.
        slider : SpringSlider
            Slider with the normal stress at t = 0.

        Returns
        -------
        SpringSlider
            The new slider; the given one if the loading does not change the normal stress.

        Examples
        --------
        >>> import ratestate as rs
        >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m")
        >>> pull = rs.Loading.constant("10 um/s").sigma_ramp("2 s", "4 MPa", "1 s")
        >>> [pull.slider_at(t, slider).sigma for t in (0.0, 2.5, float("inf"))]
        [2000000.0, 3000000.0, 4000000.0]
        """
        if isinstance(t, float) and t == np.inf:
            sigma = self._stress_history.with_sigma(slider.sigma).end[..., -1]
        else:
            sigma = self.sigma(one_in_si("t", t), slider.sigma)
        return slider.replace(sigma=sigma) if self.normal_stress else slider

    @property
    def _stress_history(self):
        return self.normal_stress or History.constant("sigma", np.nan)

    def _times_in_si(self, t):
        """Return times [s], array or DataArray; ParameterError if outside the history."""
        if isinstance(t, list | tuple) or (isinstance(t, np.ndarray) and t.dtype.kind not in "iuf"):
            t = column_to_si("t", t)
        elif not isinstance(t, np.ndarray):
            t = to_si("t", t)
        seconds = np.asarray(t, dtype=float)
        is_outside = ~((seconds >= 0) & (seconds <= self.t_last))
        if is_outside.any():
            raise refusal("loading.outside", t=seconds[is_outside].flat[0], last=self.t_last)
        return t if is_array(t) else seconds

    @functools.cached_property
    def _displacements(self):
        """Displacement [m] at the start of each segment, in the shape of V."""
        V, rate, dt = np.asarray(self.V), np.asarray(self.rate), np.diff(self.t)
        delta = np.zeros(V.shape)
        delta[..., 1:] = running_sum(dt * (V[..., :-1] + 0.5 * rate[..., :-1] * dt))
        return self.V.copy(data=delta) if is_array(self.V) else delta
