"""A loading from a text file: two columns of a table, with or without a header."""

import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...errors import ParameterError
from ...model.loading import Loading
from ...model.quantities import QUANTITIES
from ...model.units import to_si
from .magnitudes import magnitude_problem
from .problems import Problems, error_line, expected, nearest, shown
from .text_tables import number_in, rows_of

BAD_LISTED = 5  # rows
COLUMNS_LIKE = '["time [s]", "V_lp [um/s]"]'
UNITS_LIKE = '["s", "um/s"]'
SYMBOLS = ("t", "V_lp")


class Column(NamedTuple):
    """A column of the file: where, its name in messages, and its unit."""

    number: int  # from 0 on
    name: str
    unit: str


def read_record(
    table: dict[str, Any], folder: Path, problems: Problems
) -> tuple[Loading, float] | None:
    """The loading in a file, and its last speed [m/s]; None if there are problems.

    Parameters
    ----------
    table : dict
        [loading], with ``file``, ``columns`` and maybe ``units``.
    folder : Path
        Folder to which the file's path is relative.
    """
    before = len(problems)
    wanted = _pair("columns", table.get("columns"), (str, int), COLUMNS_LIKE, problems)
    units = None
    if "units" in table:
        units = _pair("units", table["units"], (str,), UNITS_LIKE, problems)
    rows = None
    with problems.at("[loading] file"):
        rows = rows_of(table["file"], folder)
    if rows is None or wanted is None:
        return None
    columns = _columns(rows, wanted, units, problems)
    if len(problems) > before or columns is None:
        return None
    return _history(rows, columns, problems)


def _pair(key: str, value: Any, kinds: Any, like: str, problems: Problems) -> list[Any] | None:
    """A pair of strings, or of integers where `kinds` allows them."""
    place, wanted = f"[loading] {key}", f"expected a pair, of times and of speeds, such as {like}"
    if value is None:
        problems.add(place, f"is missing, {wanted}")
        return None
    sound = isinstance(value, list) and len(value) == 2
    if not sound or not all(isinstance(x, kinds) and not isinstance(x, bool) for x in value):
        problems.add(place, f"{shown(value)} is no pair, {wanted}")
        return None
    return list(value)


def _columns(
    rows: list[tuple[int, list[str]]],
    wanted: list[Any],
    units: list[str] | None,
    problems: Problems,
) -> list[Column] | None:
    """The two columns in `wanted`; a header is removed from the rows."""
    head = rows[0][1]
    # named columns need a header; of numbered ones the first cell says whether there is one
    numbered = [column - 1 for column in wanted if isinstance(column, int)]
    cells = [head[i] for i in numbered if 0 <= i < len(head)] if len(numbered) == 2 else head
    titled = any(number_in(cell) is None for cell in cells)
    found = []
    for i, (symbol, column) in enumerate(zip(SYMBOLS, wanted, strict=True)):
        place = f"[loading] columns[{i}]"
        index = _index(column, head, titled, place, problems)
        if index is None:
            continue
        name = head[index] if titled else f"column {index + 1}"
        _, in_header = _split(name)
        unit = in_header if units is None else units[i]
        if not unit:
            what = f"{shown(name)} has no unit, expected units such as units = ['s', 'um/s']"
            problems.add(place, what)
            continue
        try:
            to_si(symbol, f"1 {unit}", bound="")
        except ParameterError as error:
            place = place if units is None else f"[loading] units[{i}]"
            what = error_line(error).removeprefix(f"{symbol} = {f'1 {unit}'!r} ")
            what = what.replace(f"has an unknown unit {unit!r}", "is unknown", 1)
            problems.add(place, f"the unit {shown(unit)} {what}")
            continue
        found.append(Column(index, name, unit))
    if titled:
        del rows[0]
    return found if len(found) == 2 else None


def _index(
    wanted: str | int, head: list[str], titled: bool, place: str, problems: Problems
) -> int | None:
    """Index of a column that is given by number or name."""
    if isinstance(wanted, int):
        if 1 <= wanted <= len(head):
            return wanted - 1
        what = f"{shown(wanted)} is no column, expected a number from 1 to {len(head)} such as 1"
        problems.add(place, what)
        return None
    if not titled:
        what = f"{shown(wanted)} cannot be found, for the file has no header"
        problems.add(place, f"{what}, expected the number of one such as {len(head)}")
        return None
    titles = [" ".join(cell.split()) for cell in head]
    names = [_split(title)[0] for title in titles]
    wanted = " ".join(wanted.split())
    for list_ in (titles, names):
        if list_.count(wanted) == 1:
            return list_.index(wanted)
    listed = ", ".join(shown(title) for title in titles[:20])
    near = nearest(wanted, titles) or nearest(wanted, names)
    meant = f"; did you mean {shown(near)}?" if near else ""
    how = "is the name of several columns" if names.count(wanted) > 1 else "is no column"
    problems.add(place, f"{shown(wanted)} {how}, expected one of {listed}{meant}")
    return None


def _split(title: str) -> tuple[str, str]:
    """Name and unit of a header such as "time [s]" or "V_lp (um/s)"; "" where it has none."""
    match = re.fullmatch(r"(.{0,200}?)\s*[\[(]([^\[\]()]{0,50})[\])]", title)
    return (match[1].strip(), match[2].strip()) if match else (title, "")


def _history(
    rows: list[tuple[int, list[str]]], columns: list[Column], problems: Problems
) -> tuple[Loading, float] | None:
    """The loading and its last speed; bad rows are noted with the numbers of their lines."""
    import xarray

    bad = 0
    values: list[list[float]] = []
    for line, row in rows:
        pair: list[float] = []
        for column in columns:
            cell = row[column.number] if column.number < len(row) else ""
            x = number_in(cell)
            if x is None:
                bad += 1
                if bad <= BAD_LISTED:
                    what = f"line {line}: {shown(cell)} in {shown(column.name)} is no number"
                    problems.add("[loading] file", f"{what}, expected one such as 0.5")
            else:
                pair.append(x)
        values.append(pair)
    if bad > BAD_LISTED:
        what = f"and {bad - BAD_LISTED} cells more are no numbers, expected numbers such as 0.5"
        problems.add("[loading] file", what)
    if bad:
        return None
    table = np.array(values, float).reshape(-1, 2)
    t, V = (
        xarray.DataArray(table[:, i], dims="row", attrs={"units": column.unit})
        for i, column in enumerate(columns)
    )
    wanted = "expected (counting rows from 0 on, without the header) times and speeds"
    with problems.at("[loading] file", expected=wanted, like="0,1 and 2.5,1"):
        for symbol, array in zip(SYMBOLS, (t, V), strict=True):
            largest = float(np.abs(to_si(symbol, array, bound="")).max())
            if complaint := magnitude_problem(symbol, max(largest, 1.0)):
                given = f"{symbol} = {largest:.6g} {QUANTITIES[symbol].unit}"
                raise ParameterError(f"{given} {complaint}; {expected(symbol)}")
        loading = Loading.series(t, V)
        return loading, float(to_si("V_lp", V[-1:], bound=">= 0")[0])
    return None
