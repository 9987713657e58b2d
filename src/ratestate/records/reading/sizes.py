"""Columns in SI: their units, and checks of their sizes against them."""

import numpy as np

from ...errors import ParameterError
from ...model.quantities import QUANTITIES, readable
from ...model.units import to_si
from .columns import PATTERNS
from .table import quoted
from .titles import plain

#: symbol -> least and largest typical size [SI] of what friction is measured with, by any machine
USUAL = {
    "time": (1e-6, 1e11),
    "delta_lp": (1e-9, 1e3),
    "V_load": (1e-13, 100.0),
    "friction": (1e-4, 3.0),
    "tau": (10.0, 1e11),
    "sigma": (100.0, 1e11),
}
#: symbol -> a unit to suggest
LIKE = {"time": "s", "delta_lp": "um", "V_load": "um/s", "tau": "MPa", "sigma": "MPa"}


def unit_of(column, symbol, units):
    """The unit of a column: the one given, else the one beside it in the file.

    Raises
    ------
    ParameterError
        None where one is needed; one of another kind.
    """
    given = symbol in units
    unit = plain(units[symbol] if given else column.unit)
    if symbol == "friction" and not given and not unit:
        return "1"
    remedy = f"give units={{'{symbol}': '{LIKE.get(symbol, '1')}'}} or what it is in"
    if not unit:
        raise ParameterError(f"the column {quoted(column.title)} ({symbol}) has no unit; {remedy}")
    try:
        to_si(symbol, f"1 {unit}", bound="")
    except ParameterError as error:
        what = str(error).rpartition("; expected")[0] or str(error)
        what = what.removeprefix(f"{symbol} = {f'1 {unit}'!r} ")
        where = f"units: {symbol} = {unit!r}" if given else f"the unit {unit!r}"
        other = "" if "divided" in what else ", or name another column in columns"
        raise ParameterError(
            f"{where} of the column {quoted(column.title)} {what}; {remedy}{other}"
        ) from None
    return unit


def checked_units(units):
    """Units given by the caller, or ParameterError."""
    units = {} if units is None else units
    sound = isinstance(units, dict) and all(isinstance(unit, str) for unit in units.values())
    if not sound or not set(units) <= set(PATTERNS):
        raise ParameterError(
            f"units = {units!r} must give texts for some of {', '.join(PATTERNS)}, such as "
            f"units={{'time': 's', 'delta_lp': 'um'}}"
        )
    return units


def in_si(symbol, values, unit):
    """Values of a column in SI; NaN stays NaN."""
    import xarray

    good = np.isfinite(values)
    converted = np.full(values.shape, np.nan)
    if good.any():
        rows = xarray.DataArray(values[good], dims="row", attrs={"units": unit})
        converted[good] = to_si(symbol, rows, label=symbol, bound="").values
    return converted


def check_sizes(symbol, values, column, unit):
    """Refuse values of a size that nobody can have measured: their unit must be another."""
    span = symbol in ("time", "delta_lp")
    size = float(np.ptp(values) if span else np.median(np.abs(values)))
    if symbol == "friction":
        size = max(size, float(np.quantile(np.abs(values), 0.9)))
    low, high = USUAL[symbol]
    if size == 0.0 or low <= size <= high:
        return
    si = "" if QUANTITIES[symbol].unit == "1" else f" {QUANTITIES[symbol].unit}"
    what = f"spans {readable(symbol, size)}" if span else f"is typically {readable(symbol, size)}"
    remedy = f"if {unit!r} is not its unit, give units={{'{symbol}': ...}}; else another column"
    if symbol == "friction":
        remedy = "if it is in per cent, give units={'friction': '%'}; if it is a stress, name it so"
        remedy += " in columns={'tau': ...}"
    raise ParameterError(
        f"the column {quoted(column.title)} ({symbol}) {what}, and no record is of such a size "
        f"({low:g} to {high:g}{si}); {remedy}"
    )
