"""The contents of a file before they are interpreted: columns, and rows with numbers."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: characters of a text, and names of a list, in a message
LONGEST, MOST = 60, 20


class Column(NamedTuple):
    """A column as it stands in a file."""

    title: str  # its whole name in the file; "column 3" in a file without header
    name: str  # the title without unit and group; "" if there is none
    unit: str  # the unit beside it in the file, as written; "" if there is none
    values: np.ndarray  # of float, NaN if a cell is not a number
    other_unit: str = ""  # one elsewhere in the header that contradicts it
    place: int | None = None  # among the cells of a line of text, from 0


class Table(NamedTuple):
    """Columns of a file, maybe of different lengths."""

    columns: list[Column]
    row_name: str  # "line" of a text, or "row"
    numbers: np.ndarray | None = None  # of the rows, as an editor counts them; None if 1, 2, ...
    unread: tuple[str, ...] = ()  # titles of arrays that hold no real numbers
    text_of: Callable[[int, int], str] | None = None  # of a cell, by the numbers of row and place
    name: str = ""  # of the file
    files: tuple[tuple[int, "Table"], ...] = ()  # of several: first row and table, with the columns

    @property
    def titles(self):
        """list of the columns' titles, which may repeat."""
        return [column.title for column in self.columns]

    def unread_text(self):
        """The end of a sentence on what the file has beside columns of numbers; "" for nothing."""
        return f" (no real numbers, so not read: {name_list(self.unread)})" if self.unread else ""

    def row_label(self, row):
        """How a person finds a row (counted from 0 on) in the file: "line 17"."""
        if self.files:
            first, table = self._file(row)
            return f"{table.row_label(row - first)} of {table.name}"
        return f"{self.row_name} {self._number(row)}"

    def cell(self, row, column):
        """A cell that is not a number as a message shows it, in quotes; "nothing" if empty."""
        if self.files:
            first, table = self._file(row)
            same = next(i for i, one in enumerate(self.columns) if one is column)
            return table.cell(row - first, table.columns[same])
        text = str(column.values[row])
        if self.text_of is not None and column.place is not None:
            text = self.text_of(self._number(row), column.place)
        return quoted(text) if text else "nothing"

    def _file(self, row):
        return next(file for file in reversed(self.files) if file[0] <= row)

    def _number(self, row):
        return row + 1 if self.numbers is None else int(self.numbers[row])


def quoted(text):
    """A text out of a file, as a message shows it: in quotes, on one line, `LONGEST` at most."""
    return repr(text if len(text) <= LONGEST else text[: LONGEST - 3] + "...")


def name_list(names):
    """Names, quoted, as a message lists them: the first `MOST`, and how many more there are."""
    more = [f"{len(names) - MOST} more"] if len(names) > MOST else []
    return ", ".join([*map(quoted, names[:MOST]), *more])
