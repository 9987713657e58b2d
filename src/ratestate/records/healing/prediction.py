"""Predictions of healing and relaxation, by simulating the load point's history.

A slider slides steadily before the hold, at the recorded speed.  Errors of fitted parameters are
propagated linearly, by central differences.
"""

from typing import NamedTuple

import numpy as np
import xarray

from ...dynamics.simulation.simulate import simulate
from ...errors import QuasiStaticInstability, RateStateError
from ...model.loading import Loading
from ...model.slider import SpringSlider
from ...model.units import is_array
from ..fitting.by_law import checked_by_law, error_of, fitted_slider, has_steps
from ..fitting.unknowns import MACHINE_PARAMETERS, motion_symbols
from ..messages import healing as sentences

#: relative step of a difference; start of the hold in the run, as a fraction of its duration
STEP, LEAD = 1e-4, 1e-3
#: number of times around the largest friction; number of solver steps on either side they span
POINTS, BESIDE = 2000, 2
RTOL = 1e-9
#: dimension of the sliders for differences
CASE = "difference"


class Fitted(NamedTuple):
    """A slider, and the parameters that a fit has estimated, with their covariance."""

    slider: SpringSlider
    free: tuple = ()  # symbols of the k estimated parameters
    covariance: np.ndarray = np.zeros((0, 0))  # (k, k) [SI]

    @property
    def steps(self):
        """Return the steps (k,) of the free parameters for differences."""
        sizes = [abs(getattr(self.slider, symbol)) or self.slider.a for symbol in self.free]
        return STEP * np.array(sizes)

    @property
    def cases(self):
        """Return a sweep: the slider, then with each parameter larger, then with each smaller."""
        changes = np.diag(self.steps)
        values = {
            symbol: getattr(self.slider, symbol) + np.concatenate([[0.0], change, -change])
            for symbol, change in zip(self.free, changes, strict=True)
        }
        return self.slider.replace(**{s: xarray.DataArray(x, dims=CASE) for s, x in values.items()})

    def error(self, values):
        """Return standard errors (n,) of quantities with these values (n, 1 + 2k) in the cases.

        They are inf if a parameter is unbounded.
        """
        if not np.isfinite(self.covariance).all():
            return np.full(len(values), np.inf)
        larger, smaller = np.split(values[:, 1:], 2, axis=1)
        derivatives = (larger - smaller) / (2.0 * self.steps)
        return np.sqrt(np.einsum("ni,ij,nj->n", derivatives, self.covariance, derivatives))


def sliders_of(slider):
    """Return law -> `Fitted` for a SpringSlider or a result of `fit`; {} for None.

    Anything else, or a slider that is a sweep, raises ParameterError.
    """
    if slider is None:
        return {}
    if isinstance(slider, SpringSlider):
        for symbol, value in slider.parameters.items():
            if is_array(value):
                raise sentences.refusal("slider.array", symbol=symbol)
        return {slider.law: Fitted(slider)}
    parts = checked_by_law(slider, "healing")
    return {law: _fitted(slider, law, part) for law, part in parts.items()}


def _fitted(result, law, part):
    """Return the `Fitted` of one law of a result of `fit`."""
    slider = fitted_slider(result, law)
    symbols = motion_symbols(slider.friction_law)
    names = [name for name in part["parameter"].values.tolist() if name in symbols]
    if has_steps(result):
        errors, correlation = _errors_of_steps(part, names)
    else:
        errors = np.array([error_of(part, name) for name in names])
        correlation = part["correlation"].sel(parameter=names, other=names).values
    # (correlations of logarithms equal those of the parameters to first order)
    with np.errstate(invalid="ignore"):
        return Fitted(slider, tuple(names), correlation * np.outer(errors, errors))


def _errors_of_steps(part, names):
    """Return standard errors (k,) [SI] of the joint fit of all steps, and correlation (k, k).

    Errors of the machine's parameters are the errors in one step and the scatter between steps, as
    the stiffness in a hold may differ from the median.  Without a joint fit: ParameterError.
    """
    chosen = part.sel(parameter=names)
    errors = chosen["shared_error"].values
    scatter = chosen["scatter"].fillna(0.0)
    separate = np.hypot(chosen["standard_error"].median("step"), scatter).values
    for i in np.flatnonzero(np.isnan(errors)):
        if names[i] not in MACHINE_PARAMETERS:
            raise sentences.refusal("slider.no_joint_fit", law=str(part["law"].item()))
        errors[i] = separate[i]
    correlation = chosen["shared_correlation"].sel(other=names).fillna(0.0).values
    np.fill_diagonal(correlation, 1.0)
    return errors, correlation


def predict(fitted, hold, kind):
    """Return healing and relaxation of a `Hold` in the cases of a `Fitted` (2, 1 + 2k).

    And a message: "", or why the values are NaN.

    kind : kind of friction, "tau" or "mu"
    """
    slider, cases = fitted.slider, fitted.cases
    no_result = np.full((2, 1 + 2 * len(fitted.free)), np.nan)
    lead, after = LEAD * hold.duration, hold.after
    end = lead + hold.duration
    loading = Loading.steps(hold.before.V, (lead, 0.0), (end, after.V))
    try:
        window = _about_peak(slider, loading, end, end + after.end - after.start, kind)
        if window is None:
            return no_result, sentences("prediction.no_peak", law=slider.law)
        times = np.concatenate([[0.0, end], np.linspace(window[0], window[1], POINTS)])
        run = simulate(cases, loading, float(times[-1]), times=times, rtol=RTOL)
    except RateStateError as error:
        return no_result, sentences("prediction.failed", law=slider.law, reason=str(error))
    friction = _friction(run, cases, kind).transpose(..., "time").values.reshape(-1, times.size)
    level, low, high = friction[:, 0], friction[:, 1], friction[:, 2:].max(axis=1)
    return np.array([high - level, level - low]), ""


def _about_peak(slider, loading, end, last, kind):
    """Return times [s] around the largest friction after the hold; None if it is at an end."""
    try:
        run = simulate(slider, loading, last, rtol=RTOL)
    except QuasiStaticInstability as error:  # the instability may come after the peak
        run = error.best
    later = run.isel(time=(run["time"].values >= end))
    t, friction = later["time"].values, _friction(later, slider, kind).values
    at = int(np.argmax(friction)) if t.size else 0
    if not 0 < at < t.size - 1:
        return None
    return t[max(at - BESIDE, 0)], t[min(at + BESIDE, t.size - 1)]


def _friction(run, slider, kind):
    return run["mu"] if kind == "mu" else run["tau"] / slider.sigma
