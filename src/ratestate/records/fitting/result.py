"""The Dataset of a fit: one law's, and several laws' side by side."""

import xarray

from ...dynamics.results import record_loading
from .diagnostics.checks import diagnose
from .diagnostics.model_comparison import compare_laws
from .likelihood.posterior import prior_text
from .variables import (
    band_variables,
    curve_variables,
    estimate_variables,
    posterior_variables,
    profile_variables,
    statistics,
    text_variables,
)


def dataset_of(inference, data, slider):
    """The Dataset of an `Inference`, with notes and warnings on it."""
    solution, quantities = inference.solution, inference.quantities
    record = solution.problem.record
    result = xarray.merge(
        [
            estimate_variables(inference.estimates),
            profile_variables(inference.profiles, quantities),
            posterior_variables(inference.posterior, quantities),
            curve_variables(record.time, record.friction, solution.fitted_friction),
            band_variables(solution),
            statistics(solution),
        ]
    )
    result = result.assign(text_variables(*diagnose(inference, data, slider)))
    if inference.posterior is not None:
        result.attrs["prior"] = prior_text(inference.posterior.prior)
    record_loading(result, record.loading)
    return result


def add_comparison(results, aic, *, colored=False):
    """Add the comparison of the laws to each of their results.

    Parameters
    ----------
    results : dict, law -> Dataset
    aic : dict, law -> Akaike information criterion, or chi-square if all laws have as many
        parameters
    colored : bool, whether residuals are correlated
    """
    table, text = compare_laws(results, aic, colored)
    for law, result in results.items():
        for name, variable in table.sel(law=law, drop=True).items():
            result[name] = variable
        result.attrs["comparison"] = text


def side_by_side(results):
    """Results under several laws (dict, law -> Dataset) as one, along ``law``."""
    joined = xarray.concat(
        [
            result.assign_coords(
                {d: range(result.sizes[d]) for d in result.dims if d not in result.coords}
            )
            for result in results.values()
        ],
        "law",
        join="outer",
        combine_attrs="drop_conflicts",
    )
    for name, variable in joined.data_vars.items():
        if variable.dtype == object:  # text, padded where a law has less of it
            joined[name] = variable.fillna("").astype(str)
    return joined
