"""Fits of steps as rows of a table: what goes into a CSV."""

import numpy as np
import xarray

from .table import results_by_law_of_steps

#: variables of each step, in order, before the estimates and after them
BEFORE = (
    "kind",
    "step_t",
    "step_delta_lp",
    "V_before",
    "V_after",
    "t_hold",
    "sigma",
    "sigma_after",
)
AFTER = ("rms", "aic", "aic_difference", "samples", "status", "warnings", "message")


def rows_of(result):
    """The Dataset of a row for each step, under one law after the other, along ``step``.

    Estimates of a result of steps with their standard errors, as ``a`` and ``a_error``.
    """
    parts = results_by_law_of_steps(result)
    names = result["parameter"].values.tolist()
    tables = [_of_law(part, law, names, len(parts) > 1) for law, part in parts.items()]
    return xarray.concat(tables, "step", combine_attrs="drop_conflicts")


def _of_law(part, law, names, several):
    """The rows under one law; with a column for it where there are several."""
    columns = {"law": ("step", np.full(part.sizes["step"], law))} if several else {}
    columns |= {name: part[name].variable for name in BEFORE}
    for name in names:
        error = part["standard_error"].sel(parameter=name).assign_attrs(part[name].attrs)
        columns |= {name: part[name].variable, f"{name}_error": error.variable}
    columns |= {name: part[name].variable for name in AFTER if name in part}
    return xarray.Dataset(columns, {"step": part["step"].variable})
