"""A fit of the dropped record, under the law of the page and from the values of its fields."""

import warnings

import numpy as np

import ratestate as rs

from .deadline import TimeUp
from .entries import BadEntries, state_of

#: seconds that a fit may take
SECONDS = 300.0
#: parameters that are fitted; K only if the page's is finite
FREE = ("a", "b", "Dc", "K")


def fit_of(record, entries, deadline):
    """Return the fitted friction (m,) of a record, and sentences: estimates, then warnings.

    ParameterError if the entries or the record cannot be used, and if the time is up;
    `Stopped` if it was cancelled.
    """
    try:
        slider = state_of(entries).slider
    except BadEntries as error:
        raise rs.ParameterError(str(error)) from None
    if "sigma" in record:
        slider = slider.replace(sigma=float(np.median(record.sigma)))
    free = FREE if np.isfinite(slider.K) else FREE[:-1]
    try:
        with deadline.part(), warnings.catch_warnings():
            warnings.simplefilter("ignore", rs.FitWarning)  # they are in the result
            result = rs.fit(record, slider, free)
    except TimeUp:
        raise rs.ParameterError(
            f"the fit takes more than {deadline.seconds:g} s",
            "Give times of a single step below, or fit the record with ratestate fit.",
        ) from None
    fitted = np.interp(record.time, result.time, result.friction_fit)
    texts = [f"Fit under the {slider.law} law: {_estimates(result, free)}."]
    return fitted, texts + result.warnings.item().splitlines()


def _estimates(result, free):
    """Return the estimates with their standard errors as text."""
    parts = []
    for name in free:
        value, error = float(result[name]), float(result.standard_error.sel(parameter=name))
        number, _, unit = rs.readable(name, value).partition(" ")
        if np.isfinite(error):
            number += f" \N{PLUS-MINUS SIGN} {error * float(number) / value:.2g}"
        else:
            unit += " (not determined)"
        parts.append(f"{name} = {number} {unit}".rstrip())
    return ", ".join(parts)
