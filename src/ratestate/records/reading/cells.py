"""Numbers out of lines of text, fast where all cells are numbers."""

import itertools
import math
import re
from typing import NamedTuple

import numpy as np

COMMENTS = "#%"
PART = 500  # lines
#: most cells without a number whose text is kept, for messages
ODD = 100_000
_FORTRAN = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+))[dD]([-+]?\d+)")  # 1.0D+02


class Layout(NamedTuple):
    """How a line of numbers is written."""

    delimiter: str | None  # None: spaces, as many as there are
    decimal_comma: bool
    titles: list[str]  # of the columns


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
    """The cells of a line of numbers."""
    line = line.strip(" ") if delimiter == "\t" else line.strip()
    cells = [cell.strip(" \"'") for cell in line.split(delimiter)]
    return cells[:-1] if len(cells) > 2 and not cells[-1] and delimiter is not None else cells


def number_in(cell):
    """A number out of a cell, NaN if it is none."""
    if ":" in cell:  # a clock time; there may be one in each row
        return np.nan
    try:
        return float(cell) if "_" not in cell else np.nan
    except ValueError:
        match = _FORTRAN.fullmatch(cell)
        return float("e".join(match.groups())) if match else np.nan


def rows_in(lines, layout, room=ODD):
    """The `Rows` in lines, with their ends or without; blank ones and remarks are none.

    room : how many odd cells are kept, or some more
    """
    if layout.decimal_comma:
        lines = [line.replace(",", ".") for line in lines]
    if (values := _all_numbers(lines, layout)) is not None:
        return Rows(values, np.arange(len(lines)), {})
    if (rows := _beside_texts(lines, layout, room)) is not None:
        return rows
    places = [i for i, line in enumerate(lines) if is_full(line)]
    values = np.full((len(places), len(layout.titles)), np.nan)
    odd: dict[tuple[int, str], str] = {}
    for first in range(0, len(places), PART):
        part = [lines[i].rstrip("\n") for i in places[first : first + PART]]
        numbers = _all_numbers(part, layout)
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
        for i, line in enumerate(lines):
            cell = line.split(delimiter, j + 1)[j].strip(" \"'\n")
            values[i, j] = number = number_in(cell)
            if len(odd) < room and not math.isfinite(number):
                odd[i, layout.titles[j]] = cell
    return Rows(values, np.arange(len(lines)), odd)


def _one_by_one(lines, layout):
    """The numbers, NaN where there is none, and the cells that are none."""
    values = np.full((len(lines), len(layout.titles)), np.nan)
    odd: dict[tuple[int, str], str] = {}
    for i, line in enumerate(lines):
        cells = cells_of(line, layout.delimiter)
        if len(cells) > len(layout.titles):  # perhaps in other columns
            odd |= {(i, title): f"{len(cells)} cells" for title in layout.titles}
            continue
        pairs = itertools.zip_longest(layout.titles, cells, fillvalue="")
        for j, (title, cell) in enumerate(pairs):
            values[i, j] = number = number_in(cell)
            if not math.isfinite(number):
                odd[i, title] = cell
    return values, odd
