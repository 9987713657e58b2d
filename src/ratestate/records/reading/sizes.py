"""Columns in SI: their units, and checks of what is in them."""

import re

import numpy as np

from ...errors import ParameterError
from ...model.quantities import QUANTITIES
from ...model.units import OF_WHOLE_CONTACT, to_si
from .messages import refusal
from .table import quoted
from .titles import LIKE, USUAL, plain

CLOCK = re.compile(r"\d:\d\d|\d{4}-\d\d-\d\d|\d/\d+/\d")


def checked_units(units):
    """Units given by the caller, or ParameterError."""
    units = {} if units is None else units
    sound = isinstance(units, dict) and all(isinstance(unit, str) for unit in units.values())
    if not sound or not units.keys() <= LIKE.keys():
        raise refusal("units.type", units=units, symbols=", ".join(LIKE))
    return units


def unit_of(column, symbol, units):
    """The unit of a column: the one given, else the one beside it in the file."""
    unit = plain(units.get(symbol, column.unit))
    if not unit and symbol == "friction" and symbol not in units:
        return "1"
    names = {"title": quoted(column.title), "symbol": symbol, "like": LIKE[symbol]}
    if not unit:
        raise refusal("units.none", **names)
    try:
        to_si(symbol, f"1 {unit}", bound="")
    except ParameterError as error:
        what = str(error).rpartition("; expected")[0] or str(error)
        what = what.removeprefix(f"{symbol} = {f'1 {unit}'!r} ")
        where = f"units: {symbol} =" if symbol in units else "the unit"
        other = "" if OF_WHOLE_CONTACT in what else ", or name another column in columns"
        names |= {"unit": unit, "what": what}
        raise refusal("units.kind", where=where, other=other, **names) from None
    return unit


def in_si(symbol, values, unit):
    """Values of a column in SI; NaN stays NaN."""
    import xarray

    good = np.isfinite(values)
    converted = np.full(values.shape, np.nan)
    if good.any():
        rows = xarray.DataArray(values[good], dims="row", attrs={"units": unit})
        converted[good] = to_si(symbol, rows, label=symbol, bound="").values
    return converted


def check_numbers(table, symbol, column, rows=slice(None)):
    """Refuse a column without any number in these rows."""
    numbers = column.values[rows]
    if np.isfinite(numbers).any():
        return
    row = int(np.arange(column.values.size)[rows][0])
    where = {"title": quoted(column.title), "symbol": symbol, "row": table.row_label(row)}
    cell = table.cell(row, column)
    dated = symbol == "time" and CLOCK.search(cell)
    raise refusal("column.dates" if dated else "column.no_numbers", cell=cell, **where)


def check_sizes(symbol, values, column, unit):
    """Refuse a column that is dead, or of a size that nobody can have measured."""
    names = {"title": quoted(column.title), "symbol": symbol, "unit": unit}
    # sigma may be constant, and V_load in a record without a step
    if symbol not in ("sigma", "V_load") and not np.ptp(values) > 0.0:
        what = "tau, and so friction perhaps," if symbol == "tau" else symbol
        raise refusal("column.dead", what=what, value=values[0], rows=values.size, **names)
    span = symbol in ("time", "delta_lp")
    size = float(np.ptp(values) if span else np.median(np.abs(values)))
    if symbol == "friction":
        size = max(size, float(np.quantile(np.abs(values), 0.9)))
    low, high = USUAL[symbol]
    if size > 0.0 and not low <= size <= high:
        sentence = "friction" if symbol == "friction" else "span" if span else "size"
        si = QUANTITIES[symbol].unit
        raise refusal(f"column.{sentence}", size=size, low=low, high=high, si=si, **names)
