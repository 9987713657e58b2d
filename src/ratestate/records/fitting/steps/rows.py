"""Fits of steps as rows of a table: what goes into a CSV."""

import numpy as np
import xarray

from .table import results_by_law_of_steps

#: variables of each step, in order, before the estimates and after them -> heads of their columns
BEFORE = {
    "kind": "kind",
    "step_t": "time",
    "step_delta_lp": "load-point displacement",
    "V_before": "V before",
    "V_after": "V after",
    "t_hold": "hold time",
    "sigma": "sigma",
}
AFTER = {
    "rms": "r.m.s. residual",
    "aic": "AIC",
    "aic_difference": "AIC over the least",
    "samples": "samples",
    "status": "status",
    "warnings": "warnings",
    "message": "message",
}
#: of estimates whose symbol is none
NAMES = {"a_minus_b": "a - b", "trend_slip": "trend with slip", "trend_time": "trend with time"}


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
    columns |= {name: _headed(part[name], head) for name, head in BEFORE.items()}
    for name in names:
        columns[name] = _headed(part[name], NAMES.get(name, name))
        error = part["standard_error"].sel(parameter=name)
        columns[f"{name}_error"] = _headed(error.assign_attrs(part[name].attrs), name)
    columns |= {name: _headed(part[name], head) for name, head in AFTER.items() if name in part}
    return xarray.Dataset(columns, {"step": _headed(part["step"], "step")})


def _headed(array, head):
    """An array as a Variable with this long name, which heads its column."""
    variable = array.variable.copy(deep=False)
    variable.attrs = array.attrs | {"long_name": head}
    return variable
