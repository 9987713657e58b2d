"""Sliders whose predictions are compared with a record; those of a fit with their covariance."""

from typing import NamedTuple

import numpy as np
import xarray

from ...model.conversion import in_si
from ...model.slider import SpringSlider
from ...model.units import is_array
from ..fitting.by_law import (
    checked_by_law,
    error_of,
    is_of_steps,
    results_by_law_of_steps,
    slider_of,
)
from ..fitting.unknowns import OF_MACHINE, of_slider
from ..messages import healing as sentences


class Fitted(NamedTuple):
    """A slider, and its parameters that a fit estimated, with their covariance [SI] (k, k)."""

    slider: SpringSlider
    free: tuple = ()  # symbols
    covariance: np.ndarray = np.zeros((0, 0))

    def propagated(self, derivatives):
        """Standard errors (n,) of what has these derivatives (n, k) by the free parameters.

        inf where one of them is unbounded.
        """
        if not np.isfinite(self.covariance).all():
            return np.full(len(derivatives), np.inf)
        return np.sqrt(np.einsum("ni,ij,nj->n", derivatives, self.covariance, derivatives))


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
    if isinstance(slider, xarray.Dataset) and is_of_steps(slider):
        parts, errors = results_by_law_of_steps(in_si(slider)), _errors_of_steps
    else:
        parts, errors = checked_by_law(slider, "healing"), _errors_of_fit
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
    """As `_errors_of_fit`, of the joint fit of all steps, which is not of all parameters.

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
