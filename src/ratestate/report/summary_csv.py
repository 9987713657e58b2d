"""CSV of the quantities that describe a whole record, one row each."""

from typing import Any

import xarray

from ..files.csv_tables import FORMAT, laboratory_unit
from ..model.quantities import QUANTITIES
from ..records.fitting.by_law import has_steps, results_by_law

#: heading -> variable along ``parameter`` of fits of steps, and whether it has the quantity's unit
OF_STEPS = {
    "value": ("shared", True),
    "error": ("shared_error", True),
    "scatter": ("scatter", True),
    "up/down": ("up_over_down", False),
    "up/down error": ("up_over_down_error", False),
    "up/down p value": ("up_over_down_p_value", False),
}
#: heading -> end of the name of a variable of an evaluation, and whether it has the unit
OF_RECORD = {
    "value": ("", True),
    "error": ("_error", True),
    "scatter over errors": ("_scatter", False),
}


def summary_csv(result: xarray.Dataset) -> str:
    """Return the quantities of a result as CSV, each in its unit in tables, under each law.

    Fits of steps give the quantities of all steps together.  Quantities of other results
    are all single numbers that have an error.
    """
    import pandas

    if has_steps(result):
        rows, numbers = _of_steps(result), OF_STEPS
    else:
        rows, numbers = _of_record(result), OF_RECORD
    law = ["law"] if has_steps(result) or "law" in result.dims else []
    columns = [*law, "quantity", "unit", *numbers]
    return pandas.DataFrame(rows, columns=columns, dtype=object).to_csv(**FORMAT)


def _of_steps(result: xarray.Dataset) -> list[dict[str, Any]]:
    rows = []
    for law, part in results_by_law(result).items():
        for name in part["parameter"].values.tolist():
            estimates = part.sel(parameter=name)
            numbers = {head: (estimates[key], unit) for head, (key, unit) in OF_STEPS.items()}
            if any(bool(value.notnull()) for value, _ in numbers.values()):
                rows.append(_row(name, law, numbers))
    return rows


def _of_record(result: xarray.Dataset) -> list[dict[str, Any]]:
    rows = []
    for name, variable in result.data_vars.items():
        if f"{name}_error" not in result or variable.dims not in ((), ("law",)):
            continue
        for law in result["law"].values.tolist() if variable.dims else [""]:
            part = result.sel(law=law) if law else result
            keys = {head: (f"{name}{end}", unit) for head, (end, unit) in OF_RECORD.items()}
            numbers = {head: (part[key], unit) for head, (key, unit) in keys.items() if key in part}
            rows.append(_row(str(name), law, numbers))
    return rows


def _row(name: str, law: str, numbers: dict[str, Any]) -> dict[str, Any]:
    """Return law, quantity, its unit, and numbers, from SI; what is missing is empty."""
    unit, size = laboratory_unit(name, QUANTITIES[name].unit)
    cells = {
        head: "" if value.isnull() else f"{float(value) / (size if has_unit else 1.0):.10g}"
        for head, (value, has_unit) in numbers.items()
    }
    return {"law": law, "quantity": name.replace("_", " "), "unit": unit} | cells
