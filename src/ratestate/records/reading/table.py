"""The contents of a file before they are interpreted: columns, and rows with numbers."""

import difflib
from typing import NamedTuple

import numpy as np


class Column(NamedTuple):
    """A column as it stands in a file.

    title : its whole name in the file; "column 3" in a file without header
    name : the title without unit and group; "" where there is none
    unit : the unit beside it in the file, as written; "" where there is none
    values : ndarray of float, NaN where a cell is no number
    """

    title: str
    name: str
    unit: str
    values: np.ndarray


class Table(NamedTuple):
    """Columns of a file, maybe of different lengths.

    row_name : "line" of a text, or "row"
    numbers : of the rows, as an editor or MATLAB counts them; None if 1, 2, 3, ...
    odd : (row from 0 on, title) -> text of a cell that is no number
    unread : titles of arrays that hold no real numbers
    """

    columns: list[Column]
    row_name: str
    numbers: np.ndarray | None = None
    odd: dict[tuple[int, str], str] = {}  # noqa: RUF012 (of a tuple: never changed)
    unread: tuple[str, ...] = ()

    @property
    def titles(self):
        return [column.title for column in self.columns]

    def unread_text(self):
        """The end of a sentence on what the file has beside columns of numbers."""
        return f" (no real numbers, so not read: {name_list(self.unread)})" if self.unread else ""

    def row_label(self, row):
        """How a person finds a row (counted from 0 on) in the file: "line 17"."""
        return f"{self.row_name} {row + 1 if self.numbers is None else int(self.numbers[row])}"


def quoted(text, longest=60):
    """A text out of a file, as a message shows it: on one line, and short."""
    return repr(text if len(text) <= longest else text[: longest - 3] + "...")


def name_list(names, most=20):
    """Names in a row, as a message lists them."""
    names = [quoted(name) for name in names]
    more = [f"{len(names) - most} more"] if len(names) > most else []
    return ", ".join(names[:most] + more)


def suggest_name(given, names):
    """The end of a message: which of these names was perhaps meant."""
    lower = {name.lower(): name for name in names}
    near = difflib.get_close_matches(given.lower()[:60], lower, n=1, cutoff=0.7)
    return f"; did you mean {quoted(lower[near[0]])}?" if near else ""
