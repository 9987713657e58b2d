"""Stiffness, mass and damping as text, for a notebook or a log."""

import json

import pandas

from ...model.conversion import in_si
from ...model.quantities import power_of, prefixed_unit, readable, with_error
from ..kit.results import lines_of
from ..messages import machine as sentences


def summary(result):
    """Stiffness, mass and damping of a machine as plain text, to print.

    Parameters
    ----------
    result : xarray.Dataset
        From `machine_stiffness`.

    Returns
    -------
    str
        K, M and the damping +- standard errors; tables of the slopes and ring-downs; remarks.

    Raises
    ------
    ParameterError
        No result of `machine_stiffness`.
    """
    title = getattr(result, "attrs", {}).get("title")
    if title != "ratestate machine_stiffness" or "slope_K" not in result:
        raise sentences.refusal("result.other", caller="summary")
    result = in_si(result)
    lines = [estimate(result, symbol) for symbol in ("K", "M", "damping")]
    for table in (slopes(result), ring_downs(result)):
        lines += ["", *lines_of(table)] if len(table) else []
    remarks = json.loads(result.attrs["remarks"])
    return "\n".join([*lines, *([""] if remarks else []), *remarks])


def estimate(result, symbol):
    """A line such as ``K = 20.03 +- 0.07 GPa/m``."""
    value, error = float(result[symbol]), float(result[f"{symbol}_error"])
    if value != value:
        return f"{symbol}: not found"
    return f"{symbol} = {value_with_unit(value, error, result[symbol].attrs['units'])}"


def slopes(result):
    """A pandas DataFrame of texts, a row for each slope."""
    K, errors = result["slope_K"].values, result["slope_K_error"].values
    columns = {
        "kind": result["slope_kind"].values.astype(str),
        "start": [readable("t", value, 6) for value in result["slope_start"].values],
        "K": [value_with_unit(*one, "Pa/m") for one in zip(K, errors, strict=True)],
        "straight line": [readable("K", value) for value in result["slope_straight"].values],
        "used": ["yes" if used else "no" for used in result["slope_used"].values],
    }
    return pandas.DataFrame(columns, index=pandas.RangeIndex(1, K.size + 1))


def ring_downs(result):
    """A pandas DataFrame of texts, a row for each ring-down."""
    columns = {
        "start": [readable("t", value, 6) for value in result["ring_down_start"].values],
        "V_lp": [readable("V_lp", value, 3) for value in result["ring_down_V"].values],
    }
    units = {"omega": "rad/s", "decay": "1/s", "M": "kg/m^2", "damping": "Pa s/m"}
    for name, unit in units.items():
        pairs = zip(
            result[f"ring_down_{name}"].values,
            result[f"ring_down_{name}_error"].values,
            strict=True,
        )
        columns[name] = [value_with_unit(*pair, unit) for pair in pairs]
    index = pandas.RangeIndex(1, result.sizes["ring_down"] + 1)
    return pandas.DataFrame(columns, index=index)


def value_with_unit(value, error, unit, power=None):
    """A value +- error in a unit that fits, or of this power of ten; "-" for NaN."""
    if value != value:
        return "-"
    power = power_of(unit, value) if power is None else power
    number = with_error(value / 10.0**power, error / 10.0**power)
    return f"{number} {prefixed_unit(unit, power)}"
