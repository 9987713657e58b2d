"""Sliders whose predictions are compared with a record; those of a fit with their covariance."""

from typing import NamedTuple

import numpy as np

from ...model.slider import SpringSlider
from ...model.units import is_array
from ..fitting.by_law import checked_by_law, error_of, slider_of
from ..fitting.unknowns import of_slider
from .messages import refusal


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
                raise refusal("slider.array", symbol=symbol)
        return {slider.law: Fitted(slider)}
    parts = checked_by_law(slider, "healing")
    return {law: _fitted(slider, law, part) for law, part in parts.items()}


def _fitted(result, law, part):
    """`Fitted` of one law's part of a fit."""
    slider = slider_of(result, law)
    own = of_slider(slider.friction_law)
    names = [name for name in part["parameter"].values.tolist() if name in own]
    errors = np.array([error_of(part, name) for name in names])
    correlation = part["correlation"].sel(parameter=names, other=names).values
    # (those of positive parameters are of their logarithms: to first order the same)
    with np.errstate(invalid="ignore"):
        return Fitted(slider, tuple(names), correlation * np.outer(errors, errors))
