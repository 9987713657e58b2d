"""A loading from two or three columns of a file, which the reader of laboratory records opens."""

import functools
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...errors import ParameterError
from ...model.loading import Loading
from ...model.parameters import parameter_to_si, quantity_of
from ...model.quantities import QUANTITIES, remedy
from ...model.units import to_si
from ...records.reading.columns import Column, Table, requested_column
from ...records.reading.open_table import open_table
from ...records.reading.titles import plain_unit
from .known_keys import LIKE
from .problems import Place, message, refusal
from .values import unusual

LONGEST = 10**6  # rows
BAD_LISTED = 5  # cells
#: of columns, the last if there are three
SYMBOLS = ("t", "V_lp", "sigma")


class Record(NamedTuple):
    """A loading and its last speed [m/s]; None each if there are problems."""

    loading: Loading | None = None
    last: float | None = None


def read_record(table: dict[str, Any], folder: Path, place: Place, area: dict[str, Any]) -> Record:
    """The loading in a file, whose name is relative to a folder, as the table [loading] says.

    area : as of `loading_table`
    Problems are noted at `place`, and the `Record` then is empty.
    """
    before = len(place.problems)
    wanted = _columns("columns", table, str | int, (2, 3), place)
    units = None
    if "units" in table and wanted is not None:
        units = _columns("units", table, str, (len(wanted),), place)
    found = place.at("file").noting(lambda: _table_of(table["file"], folder))
    if found is None or wanted is None:
        return Record()
    columns = []
    for i, (symbol, request) in enumerate(zip(SYMBOLS, wanted, strict=False)):
        at = place.at("columns").at(i)
        index = functools.partial(requested_column, found, symbol, request)
        if (k := at.noting(index, f"columns: {symbol}")) is not None:
            own = found.columns[k]
            unit, where = (
                (units[i], place.at("units").at(i)) if units else (plain_unit(own.unit), at)
            )
            columns.append(own._replace(unit=unit))
            _check_unit(symbol, columns[-1], where, area)
    if len(place.problems) == before:
        make = functools.partial(_history, found, columns, place.at("file"), area)
        return place.at("file").noting(make) or Record()
    return Record()


def _columns(
    key: str, table: dict[str, Any], kinds: Any, lengths: tuple[int, ...], place: Place
) -> list[Any] | None:
    """Two or three strings, or integers if `kinds` allows them."""
    wanted = message("columns.pair_wanted", like=LIKE[key])
    value = table.get(key)
    if value is None:
        place.missing(key, wanted)
        return None
    sound = isinstance(value, list) and len(value) in lengths
    if not sound or not all(isinstance(x, kinds) and not isinstance(x, bool) for x in value):
        place.at(key).add("columns.no_pair", given=value, wanted=wanted)
        return None
    return list(value)


def _table_of(file: Any, folder: Path) -> Table:
    """The table in a file; ParameterError if it cannot be read, or has too many rows."""
    if not isinstance(file, str) or not file.isprintable():
        raise refusal("record.no_name", given=file)
    try:
        table: Table = open_table(folder / file)
    except ParameterError as error:
        raise refusal("record.unreadable", problem=error.problem) from None
    if max(column.values.size for column in table.columns) > LONGEST:
        raise refusal("record.too_many_rows", given=file, most=LONGEST)
    return table


def _check_unit(symbol: str, column: Column, place: Place, area: dict[str, Any]) -> None:
    """Note that a column has no unit, or one of another quantity."""
    unit = column.unit
    if not unit:
        place.add("columns.no_unit", given=column.title)
        return
    try:
        parameter_to_si(symbol, f"1 {unit}", area)
    except ParameterError as error:
        error.value = repr(unit)
        error.problem = error.problem.replace(f"has an unknown unit {unit!r}", "is unknown")
        place.note(error, error.symbol)


def _history(found: Table, columns: list[Column], place: Place, area: dict[str, Any]) -> Record:
    """The loading and its last speed; cells without a number are noted by row."""
    import xarray

    bad = [(row, x) for x in columns for row in np.flatnonzero(~np.isfinite(x.values)).tolist()]
    for row, x in bad[:BAD_LISTED]:
        where = {"row": found.row_label(row), "column": x.title}
        place.add("record.no_number", cell=found.cell(row, x), **where)
    if len(bad) > BAD_LISTED:
        place.add("record.more_no_numbers", n=len(bad) - BAD_LISTED)
    if bad:
        return Record()
    arrays = [xarray.DataArray(x.values, dims="row", attrs={"units": x.unit}) for x in columns]
    quantities = [quantity_of(symbol, x) for symbol, x in zip(SYMBOLS, arrays, strict=False)]
    for quantity, array in zip(quantities, arrays, strict=True):
        largest = float(np.abs(to_si(quantity, array, bound="")).max())
        if sizes := unusual(quantity, max(largest, 1.0)):
            value = f"{quantity} = {largest:.6g} {QUANTITIES[quantity].unit}"
            raise refusal("value.unusual", x=value, sizes=sizes, wanted=remedy(quantity))
    t, V, *stress = arrays
    if "normal_force" in quantities:
        stress = [column_per_area(stress[0].values, columns[2].unit, area)]
    try:
        loading = Loading.series(t, V, sigma=stress[0] if stress else None)
    except ParameterError as error:
        error.problem += " (rows are counted from 0, without the header)"
        raise
    return Record(loading, float(to_si("V_lp", V[-1:], bound=">= 0")[0]))


def column_per_area(forces: Any, unit: str, area: dict[str, Any]) -> Any:
    """Forces (n,) in this unit, divided by the area; ParameterError if none is given.

    (n,) [Pa], or a list of DataArrays if the area is one.
    """
    import xarray

    parameter_to_si("sigma", f"{forces[0]:.6g} {unit}", area)  # (an error of text says more)
    rows = xarray.DataArray(forces, dims="row", attrs={"units": unit})
    stress = parameter_to_si("sigma", rows, area)
    return stress.values if stress.ndim == 1 else list(stress.transpose("row", ...))
