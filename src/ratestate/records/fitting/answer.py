"""The Dataset of a fit: one law's, and several laws' side by side."""

import xarray

from ...dynamics.results import record_loading
from .likelihood.posterior import prior_words
from .result import (
    curves,
    estimate_variables,
    posterior_variables,
    profile_variables,
    statistics,
    text_variables,
)
from .words.compare import compared
from .words.doubts import in_words

#: variables of the record itself
RECORDED = ("friction", "delta_lp")


def result_of(known, data, slider):
    """The variables of an `Uncertain`, and the words on it as attributes."""
    solution, numbers = known.solution, known.numbers
    result = xarray.merge(
        [
            estimate_variables(known.estimates),
            profile_variables(known.profiles, numbers),
            posterior_variables(known.sampled, numbers),
            curves(solution),
            statistics(solution),
        ]
    )
    words, problems = in_words(known, data, slider)
    result = result.assign(text_variables(words, problems))
    if known.sampled is not None:
        result.attrs["prior"] = prior_words(known.sampled.prior)
    record_loading(result, solution.problem.record.loading)
    return result


def add_comparison(results, aic, *, colored=False):
    """Give the results of several laws what tells which one the record prefers.

    Parameters
    ----------
    results : dict, law -> Dataset
    aic : dict, law -> Akaike information criterion, or chi-square where parameters are as many
    colored : bool, whether residuals are correlated
    """
    table, words = compared(results, aic, colored)
    for law, result in results.items():
        for name, variable in table.sel(law=law, drop=True).items():
            result[name] = variable
        result.attrs["comparison"] = words


def side_by_side(results):
    """Results under several laws (dict, law -> Dataset) as one, along ``law``."""
    found = list(results.values())
    # what was recorded is the same under all laws
    recorded = [name for name in RECORDED if all(one[name].equals(found[0][name]) for one in found)]
    joined = xarray.concat(
        [
            one.drop_vars(recorded).assign_coords(
                {d: range(one.sizes[d]) for d in one.dims if d not in one.coords}
            )
            for one in found
        ],
        "law",
        join="outer",
        combine_attrs="drop_conflicts",
    )
    for name, variable in joined.data_vars.items():
        if variable.dtype == object:  # text that not all laws have as much of
            joined[name] = variable.fillna("").astype(str)
    return joined.assign({name: found[0][name].drop_vars("law") for name in recorded})
