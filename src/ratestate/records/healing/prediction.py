"""What sliders, perhaps of a fit, predict for holds: simulations of the load point's history.

A slider slides steadily before the hold, at the speed that was recorded.  Errors of fitted
parameters are propagated linearly, by central differences.
"""

from typing import NamedTuple

import numpy as np
import xarray

from ...dynamics.simulation.simulate import simulate
from ...errors import QuasiStaticInstability, RateStateError
from ...model.loading import Loading
from ...model.slider import SpringSlider
from ...model.units import is_array
from ..fitting.by_law import checked_by_law, error_of, is_of_steps, slider_of
from ..fitting.unknowns import OF_MACHINE, of_slider
from ..messages import healing as sentences

#: step of a difference, over a parameter; start of the hold in the run, over its duration
STEP, LEAD = 1e-4, 1e-3
#: points about the largest friction, within so many of the solver's steps on either side
POINTS, BESIDE = 2000, 2
RTOL = 1e-9
#: dimension of the sliders of a difference
CASE = "difference"


class Fitted(NamedTuple):
    """A slider, and its parameters that a fit estimated, with their covariance [SI] (k, k)."""

    slider: SpringSlider
    free: tuple = ()  # symbols
    covariance: np.ndarray = np.zeros((0, 0))

    @property
    def steps(self):
        """(k,) steps of differences by the free parameters."""
        sizes = [abs(getattr(self.slider, symbol)) or self.slider.a for symbol in self.free]
        return STEP * np.array(sizes)

    @property
    def cases(self):
        """The slider, and with each free parameter larger, then smaller by its step: a sweep."""
        if not self.free:
            return self.slider
        changes = np.diag(self.steps)
        values = {
            symbol: getattr(self.slider, symbol) + np.concatenate([[0.0], change, -change])
            for symbol, change in zip(self.free, changes, strict=True)
        }
        return self.slider.replace(**{s: xarray.DataArray(x, dims=CASE) for s, x in values.items()})

    def error(self, values):
        """Standard errors (n,) of what has these values (n, 1 + 2k) in the cases.

        inf if a parameter is unbounded.
        """
        if not np.isfinite(self.covariance).all():
            return np.full(len(values), np.inf)
        larger, smaller = np.split(values[:, 1:], 2, axis=1)
        by = (larger - smaller) / (2.0 * self.steps)
        return np.sqrt(np.einsum("ni,ij,nj->n", by, self.covariance, by))


def sliders_of(slider):
    """law -> `Fitted`, from a SpringSlider or a result of `fit`; {} from None.

    ParameterError for anything else, and for a slider that is a sweep.
    """
    if slider is None:
        return {}
    if isinstance(slider, SpringSlider):
        for symbol, value in slider.parameters.items():
            if is_array(value):
                raise sentences.refusal("slider.array", symbol=symbol)
        return {slider.law: Fitted(slider)}
    parts = checked_by_law(slider, "healing")
    errors = _errors_of_steps if is_of_steps(slider) else _errors_of_fit
    return {law: _fitted(slider, law, part, errors) for law, part in parts.items()}


def _fitted(result, law, part, errors):
    """`Fitted` of one law's part of a fit; errors : function of the part and names, as below."""
    slider = slider_of(result, law)
    own = of_slider(slider.friction_law)
    names = [name for name in part["parameter"].values.tolist() if name in own]
    sizes, correlation = errors(part, names)
    # (those of positive parameters are of their logarithms: to first order the same)
    with np.errstate(invalid="ignore"):
        return Fitted(slider, tuple(names), correlation * np.outer(sizes, sizes))


def _errors_of_fit(part, names):
    """Standard errors (k,) [SI] of a fit's estimates, and their correlation (k, k)."""
    errors = np.array([error_of(part, name) for name in names])
    return errors, part["correlation"].sel(parameter=names, other=names).values


def _errors_of_steps(part, names):
    """Standard errors (k,) [SI] of the joint fit of all steps, and their correlation (k, k).

    Of the machine's parameters the errors are those of one step, with the scatter between steps,
    for a hold may have another stiffness than the median of all.  ParameterError without a joint
    fit.
    """
    here = part.sel(parameter=names)
    errors = here["shared_error"].values
    separate = np.hypot(here["standard_error"].median("step"), here["scatter"].fillna(0.0)).values
    for i in np.flatnonzero(np.isnan(errors)):
        if names[i] not in OF_MACHINE:
            raise sentences.refusal("slider.no_joint_fit", law=str(part["law"].item()))
        errors[i] = separate[i]
    correlation = here["shared_correlation"].sel(other=names).fillna(0.0).values
    np.fill_diagonal(correlation, 1.0)
    return errors, correlation


def predict(fitted, hold, kind):
    """Healing and relaxation of a `Hold` in the cases of a `Fitted` (2, 1 + 2k); a message.

    The values are NaN if the message, else "", says why there are none.

    kind : of friction, "tau" or "mu"
    """
    slider, cases = fitted.slider, fitted.cases
    none = np.full((2, 1 + 2 * len(fitted.free)), np.nan)
    lead, after = LEAD * hold.duration, hold.after
    end = lead + hold.duration
    loading = Loading.steps(hold.before.V, (lead, 0.0), (end, after.V))
    try:
        window = _about_peak(slider, loading, end, end + after.end - after.start, kind)
        if window is None:
            return none, sentences("prediction.no_peak", law=slider.law)
        times = np.concatenate([[0.0, end], np.linspace(window[0], window[1], POINTS)])
        run = simulate(cases, loading, float(times[-1]), times=times, rtol=RTOL)
    except RateStateError as error:
        return none, sentences("prediction.failed", law=slider.law, reason=str(error))
    friction = _friction(run, cases, kind).transpose(..., "time").values.reshape(-1, times.size)
    level, low, high = friction[:, 0], friction[:, 1], friction[:, 2:].max(axis=1)
    return np.array([high - level, level - low]), ""


def _about_peak(slider, loading, end, last, kind):
    """Times [s] before and after the largest friction from the hold's end on; None if at an end."""
    try:
        run = simulate(slider, loading, last, rtol=RTOL)
    except QuasiStaticInstability as error:  # it may be after the peak
        run = error.best
    later = run.isel(time=(run["time"].values >= end))
    t, friction = later["time"].values, _friction(later, slider, kind).values
    at = int(np.argmax(friction)) if t.size else 0
    if not 0 < at < t.size - 1:
        return None
    return t[max(at - BESIDE, 0)], t[min(at + BESIDE, t.size - 1)]


def _friction(run, slider, kind):
    """Friction as it is recorded: of the spring, or of the interface."""
    return run["mu"] if kind == "mu" else run["tau"] / slider.sigma
