"""Numbers out of lines of text, fast if all cells are numbers."""

import csv
import itertools
import re
from typing import NamedTuple

import numpy as np

from .clock import Clock

COMMENTS = "#%"
#: decimal mark -> numbers with blanks or other marks between groups of three digits: 1,234.5
_GROUPED = {
    mark: re.compile(
        rf"[-+]?[1-9]\d{{0,2}}(?P<gap>[ '{other}])\d{{3}}(?:(?P=gap)\d{{3}})*(?:[{mark}]\d*)?"
    )
    for mark, other in (".,", ",.")
}
_FORTRAN = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+))[dD]([-+]?\d+)")  # 1.0D+02


class Layout(NamedTuple):
    """How a line of numbers is written."""

    delimiter: str | None  # None: spaces, as many as there are
    decimal: str  # "." or ","
    width: int  # cells
    clocks: dict[int, Clock]  # of the columns of clock times


def is_comment(line):
    """Whether a line is a remark."""
    return line.lstrip().startswith(tuple(COMMENTS))


def is_full(line):
    """Whether a line is neither blank nor a remark."""
    return bool(line.strip()) and not is_comment(line)


def cells_of(line, delimiter):
    """The cells of a line of numbers, those at its end that are empty as well."""
    line = line.rstrip("\n")
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


def rows_in(lines, layout):
    """Numbers in lines (rows, columns), NaN for cells without, and which line is each row (rows,).

    Blank lines and remarks are not rows.  A row with more cells than columns has no numbers.
    """
    if (values := _all_numbers(lines, layout)) is not None:
        return values, np.arange(len(lines))
    width = layout.width
    places = [i for i, line in enumerate(lines) if is_full(line)]
    rows = [trimmed(cells_of(lines[i], layout.delimiter), width) for i in places]
    rows = [cells if len(cells) <= width else [] for cells in rows]
    values = np.empty((len(rows), width))
    for j, cells in enumerate(itertools.zip_longest(*rows, [""] * width, fillvalue="")):
        values[:, j] = _column(cells[:-1], j, layout)
    return values, np.array(places, int)


def _all_numbers(lines, layout):
    """(lines, columns) numbers; None unless each line is a row of them, as Python reads numbers."""
    if layout.decimal == ",":
        if any("." in line for line in lines):  # between groups of digits perhaps
            return None
        lines = [line.replace(",", ".") for line in lines]
    try:
        values = np.loadtxt(lines, delimiter=layout.delimiter, comments=None, ndmin=2)
    except ValueError:
        return None
    return values if values.shape == (len(lines), layout.width) else None


def _column(cells, j, layout):
    """(cells,) the numbers or clock times in a column."""
    if j in layout.clocks:
        return layout.clocks[j].seconds(cells)
    if layout.decimal == "." and "_" not in "".join(cells):
        try:
            return np.array(cells, float)
        except ValueError:
            pass
    return np.array([number_in(cell, layout.decimal) for cell in cells])
