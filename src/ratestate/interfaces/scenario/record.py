"""A loading from a text file: two or three columns of a table, with or without a header.

Cells are separated by commas, semicolons or tabs.
"""

import csv
import functools
import io
import math
import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...errors import ParameterError
from ...model.loading import Loading
from ...model.names import nearest
from ...model.parameters import parameter_to_si, quantity_of
from ...model.quantities import QUANTITIES
from ...model.units import to_si
from .known_keys import LIKE
from .problems import Place, error_line, expected, message, refusal, shown
from .values import unusual

ENDINGS = (".csv", ".tsv", ".txt")
LARGEST = 100 * 10**6  # bytes
LONGEST = 10**6  # rows
BAD_LISTED = 5  # cells
#: of columns, the last if there are three
SYMBOLS = ("t", "V_lp", "sigma")
Row = tuple[int, list[str]]


class Record(NamedTuple):
    """A loading and its last speed [m/s]; None each if there are problems."""

    loading: Loading | None = None
    last: float | None = None


class Column(NamedTuple):
    """A column of the file: where, its name in messages, and its unit."""

    at: int
    name: str
    unit: str


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
    rows = place.at("file").noting(lambda: _rows_of(table["file"], folder))
    if rows is None or wanted is None:
        return Record()
    head = rows[0][1]
    # named columns need a header; of numbered ones the first cell says whether there is one
    numbered = [column - 1 for column in wanted if isinstance(column, int)]
    all_numbered = len(numbered) == len(wanted)
    cells = [head[i] for i in numbered if 0 <= i < len(head)] if all_numbered else head
    titled = any(math.isnan(_number_in(cell)) for cell in cells)
    found = [
        _column(i, wanted[i], units[i] if units else None, head, titled, place, area)
        for i in range(len(wanted))
    ]
    columns = [column for column in found if column]
    if len(place.problems) > before:
        return Record()
    read = functools.partial(_history, rows[titled:], columns, place.at("file"), area)
    rows_wanted = message("record.history_wanted")
    record = place.at("file").noting(read, wanted=rows_wanted, like="0,1 and 2.5,1")
    return record or Record()


def _columns(
    key: str, table: dict[str, Any], kinds: Any, lengths: tuple[int, ...], place: Place
) -> list[Any] | None:
    """Two or three strings, or integers where `kinds` allows them."""
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


def _column(
    i: int,
    wanted: str | int,
    unit: str | None,
    head: list[str],
    titled: bool,
    place: Place,
    area: dict[str, Any],
) -> Column | None:
    """A column, by its number or name; its unit is that of the header, unless one is given."""
    at_unit = place.at("units" if unit else "columns").at(i)
    place = place.at("columns").at(i)
    index = place.noting(lambda: _index(wanted, head, titled))
    if index is None:
        return None
    name = head[index] if titled else f"column {index + 1}"
    if unit is None:
        unit = _split(name)[1]
    if not unit:
        place.add("columns.no_unit", given=name)
        return None
    try:
        parameter_to_si(SYMBOLS[i], f"1 {unit}", area)
    except ParameterError as error:
        what = error_line(error).removeprefix(f"{SYMBOLS[i]} = {f'1 {unit}'!r} ")
        what = what.replace(f"has an unknown unit {unit!r}", "is unknown", 1)
        at_unit.add("columns.bad_unit", given=unit, what=what)
    return Column(index, name, unit)


def _index(wanted: str | int, head: list[str], titled: bool) -> int:
    """Index of a column that is given by number or name; ParameterError if there is none."""
    if isinstance(wanted, int):
        if 1 <= wanted <= len(head):
            return wanted - 1
        raise refusal("columns.no_number", given=wanted, n=len(head))
    if not titled:
        raise refusal("columns.no_header", given=wanted, n=len(head))
    titles = [" ".join(cell.split()) for cell in head]
    names = [_split(title)[0] for title in titles]
    wanted = " ".join(wanted.split())
    for labels in (titles, names):
        if labels.count(wanted) == 1:
            return labels.index(wanted)
    listed = ", ".join(map(shown, titles[:20]))
    near = nearest(wanted, titles) or nearest(wanted, names)
    meant = f"; did you mean {shown(near)}?" if near else ""
    name = "columns.several" if names.count(wanted) > 1 else "columns.no_name"
    raise refusal(name, given=wanted, listed=listed, meant=meant)


def _split(title: str) -> tuple[str, str]:
    """Name and unit of a header such as "time [s]" or "V_lp (um/s)"; "" where it has none."""
    match = re.fullmatch(r"(.{0,200}?)\s*[\[(]([^\[\]()]{0,50})[\])]", title)
    return (match[1].strip(), match[2].strip()) if match else (title, "")


def _history(rows: list[Row], columns: list[Column], place: Place, area: dict[str, Any]) -> Record:
    """The loading and its last speed; bad cells are noted with the numbers of their lines."""
    import xarray

    table = np.array([[_number_in(_cell(row, c)) for c in columns] for _, row in rows])
    bad = np.argwhere(np.isnan(table))
    for i, j in bad[:BAD_LISTED]:
        (line, row), column = rows[i], columns[j]
        cell = _cell(row, column)
        place.add("record.no_number", given=cell, line=line, column=column.name)
    if len(bad) > BAD_LISTED:
        place.add("record.more_no_numbers", n=len(bad) - BAD_LISTED)
    if len(bad):
        return Record()
    arrays = [
        xarray.DataArray(values, dims="row", attrs={"units": column.unit})
        for values, column in zip(table.reshape(-1, len(columns)).T, columns, strict=True)
    ]
    quantities = [quantity_of(symbol, x) for symbol, x in zip(SYMBOLS, arrays, strict=False)]
    for quantity, array in zip(quantities, arrays, strict=True):
        largest = float(np.abs(to_si(quantity, array, bound="")).max())
        if sizes := unusual(quantity, max(largest, 1.0)):
            x = f"{quantity} = {largest:.6g} {QUANTITIES[quantity].unit}"
            raise refusal("value.unusual", x=x, sizes=sizes, wanted=expected(quantity))
    t, V, *stress = arrays
    if "normal_force" in quantities:
        stress = [column_per_area(stress[0].values, columns[2].unit, area)]
    loading = Loading.series(t, V, sigma=stress[0] if stress else None)
    return Record(loading, float(to_si("V_lp", V[-1:], bound=">= 0")[0]))


def _cell(row: list[str], column: Column) -> str:
    """A row's cell in a column; "" if the row is too short."""
    return row[column.at] if column.at < len(row) else ""


def _rows_of(file: Any, folder: Path) -> list[tuple[int, list[str]]]:
    """The rows of a file that are not empty, each with the number of its line."""
    wanted = message("record.wanted", endings=", ".join(ENDINGS))
    if not isinstance(file, str) or not file.isprintable() or len(file) > 1000:
        raise refusal("record.no_name", given=file, wanted=wanted)
    path = folder / file
    if path.suffix.lower() not in ENDINGS:
        raise refusal("record.ending", given=file, wanted=wanted)
    try:
        if not path.is_file():
            raise refusal("record.missing", given=str(path), wanted=wanted)
        if (size := path.stat().st_size) > LARGEST:
            raise refusal("record.too_large", given=file, size=size, most=LARGEST)
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise refusal("record.unreadable", given=file, what=error.strerror, wanted=wanted) from None
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise refusal("record.not_utf8", given=file, line=line) from None
    first = text[:10000].lstrip().split("\n", 1)[0]
    delimiter = next((mark for mark in "\t;" if mark in first), ",")
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    rows = []
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                rows.append((reader.line_num, [cell.strip() for cell in row]))
            if len(rows) > LONGEST + 1:
                raise refusal("record.too_many_rows", given=file, most=LONGEST)
    except csv.Error as error:
        raise refusal("record.bad_row", given=file, line=reader.line_num, what=error) from None
    if not rows:
        raise refusal("record.empty", given=file)
    return rows


def _number_in(cell: str) -> float:
    """A finite number, or NaN."""
    try:
        x = float(cell)
    except ValueError:
        return math.nan
    return x if math.isfinite(x) else math.nan


def column_per_area(forces: Any, unit: str, area: dict[str, Any]) -> Any:
    """Forces (n,) in this unit, divided by the area; ParameterError where none is given.

    (n,) [Pa], or a list of DataArrays where the area is one.
    """
    import xarray

    parameter_to_si("sigma", f"{forces[0]:.6g} {unit}", area)  # (an error of text says more)
    rows = xarray.DataArray(forces, dims="row", attrs={"units": unit})
    stress = parameter_to_si("sigma", rows, area)
    return stress.values if stress.ndim == 1 else list(stress.transpose("row", ...))
