"""Numbers out of lines of text, fast where all cells are numbers."""

import csv
import itertools
import math
import re
from typing import NamedTuple

import numpy as np

from .clock import Clock, seconds_in

COMMENTS = "#%"
PART = 500  # lines
#: most cells without a number whose text is kept, for messages
ODD = 100_000
#: decimal mark -> numbers with blanks or other marks between groups of three digits: 1,234.5
_GROUPED = {
    mark: re.compile(
        rf"[-+]?[1-9]\d{{0,2}}(?P<gap>[ '{other}])\d{{3}}(?:(?P=gap)\d{{3}})*(?:[{mark}]\d*)?"
    )
    for mark, other in (".,", ",.")
}
#: a number with a decimal comma may have points between groups of digits
_POINTS = re.compile(r"(?<![.:\d])\d{1,3}\.\d{3}(?!\d)")
_FORTRAN = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+))[dD]([-+]?\d+)")  # 1.0D+02


class Layout(NamedTuple):
    """How a line of numbers is written."""

    delimiter: str | None  # None: spaces, as many as there are
    decimal: str  # "." or ","
    titles: list[str]  # of the columns
    clocks: dict[int, Clock]  # of the columns of clock times


class Rows(NamedTuple):
    """The rows in some lines."""

    values: np.ndarray  # (rows, columns), NaN where there is no number
    lines: np.ndarray  # (rows,) which of the lines each is
    odd: dict[tuple[int, str], str]  # (row, title) -> cell that is no number


def is_comment(line):
    """Whether a line is a remark."""
    return line.lstrip().startswith(tuple(COMMENTS))


def is_full(line):
    """Whether a line is neither blank nor a remark."""
    return bool(line.strip()) and not is_comment(line)


def cells_of(line, delimiter):
    """The cells of a line of numbers, those at its end that are empty as well."""
    line = line.strip(" ") if delimiter == "\t" else line.strip()
    if '"' in line and delimiter is not None:  # which may stand within quotes too
        cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    else:
        cells = line.split(delimiter)
    return [cell.strip(" \"'") for cell in cells]


def trimmed(cells, least=0):
    """Cells without the empty ones at their end, but `least` in any case."""
    end = len(cells)
    while end > least and not cells[end - 1]:
        end -= 1
    return cells[:end]


def number_in(cell, decimal="."):
    """A number out of a cell, NaN if it is none."""
    if ":" in cell or "_" in cell:  # a clock time; there may be one in each row
        return np.nan
    if _GROUPED[decimal].fullmatch(cell):
        cell = re.sub(rf"[^\d{decimal}+-]", "", cell)
    if decimal == ",":
        cell = cell.replace(",", ".")
    try:
        return float(cell)
    except ValueError:
        match = _FORTRAN.fullmatch(cell)
        return float("e".join(match.groups())) if match else np.nan


def rows_in(lines, layout, room=ODD):
    """The `Rows` in lines, with their ends or without; blank ones and remarks are none.

    room : how many odd cells are kept, or some more
    """
    plain = lines
    if layout.decimal == ",":
        plain = [line.replace(",", ".") for line in lines]
    if layout.decimal == "." or not any(map(_POINTS.search, lines)):
        if (values := _all_numbers(plain, layout)) is not None:
            return Rows(values, np.arange(len(lines)), {})
        if (rows := _beside_texts(plain, layout, room)) is not None:
            return rows
    places = [i for i, line in enumerate(lines) if is_full(line)]
    values = np.full((len(places), len(layout.titles)), np.nan)
    odd: dict[tuple[int, str], str] = {}
    for first in range(0, len(places), PART):
        part = [lines[i].rstrip("\n") for i in places[first : first + PART]]
        numbers = _all_numbers(part, layout) if layout.decimal == "." else None
        if numbers is None:
            numbers, own = _one_by_one(part, layout)
            if len(odd) < room:
                odd |= {(first + row, title): cell for (row, title), cell in own.items()}
        values[first : first + PART] = numbers
    return Rows(values, np.array(places, int), odd)


def _all_numbers(lines, layout, columns=None):
    """(lines, columns) numbers, None unless each line is a row of them.

    columns : list of the columns that are read, from 0; all by default
    """
    options = {"delimiter": layout.delimiter, "comments": None, "ndmin": 2, "usecols": columns}
    try:
        values = np.loadtxt(lines, **options)
    except ValueError:
        return None
    width = len(layout.titles if columns is None else columns)
    return values if values.shape == (len(lines), width) else None


def _beside_texts(lines, layout, room):
    """The `Rows` in lines that all have texts in the same columns, such as dates; or None."""
    delimiter, width = layout.delimiter, len(layout.titles)
    if delimiter is None or any(line.count(delimiter) != width - 1 for line in lines):
        return None
    first = cells_of(lines[0].rstrip("\n"), delimiter)
    texts = [j for j, cell in enumerate(first) if math.isnan(number_in(cell))]
    others = [j for j in range(width) if j not in texts]
    if len(first) != width or not texts or not others or any(map(is_comment, lines)):
        return None
    if (numbers := _all_numbers(lines, layout, others)) is None:
        return None
    values = np.full((len(lines), width), np.nan)
    values[:, others] = numbers
    odd: dict[tuple[int, str], str] = {}
    for j in texts:
        cells = [line.split(delimiter, j + 1)[j].strip(" \"'\n") for line in lines]
        values[:, j] = _column(cells, j, layout._replace(decimal="."))
        for i in itertools.islice(np.flatnonzero(~np.isfinite(values[:, j])), room):
            odd[int(i), layout.titles[j]] = cells[i]
    return Rows(values, np.arange(len(lines)), odd)


def _column(cells, j, layout):
    """(cells,) the numbers or clock times in a column."""
    if j in layout.clocks:
        return seconds_in(cells, layout.clocks[j])
    return np.array([number_in(cell, layout.decimal) for cell in cells])


def _one_by_one(lines, layout):
    """The numbers, NaN where there is none, and the cells that are none."""
    width = len(layout.titles)
    rows = [trimmed(cells_of(line, layout.delimiter), width) for line in lines]
    # with more cells, these are perhaps in other columns
    fitting = [[] if len(cells) > width else cells for cells in rows]
    columns = [*itertools.islice(itertools.zip_longest(*fitting, fillvalue=""), width)]
    values = np.full((len(lines), width), np.nan)
    odd: dict[tuple[int, str], str] = {}
    for j, cells in enumerate(columns):
        values[:, j] = _column(cells, j, layout)
    for i, j in np.argwhere(~np.isfinite(values)).tolist():
        cells = rows[i]
        wide = len(cells) > width
        odd[i, layout.titles[j]] = f"{len(cells)} cells" if wide else "".join(cells[j : j + 1])
    return values, odd
