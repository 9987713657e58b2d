"""What a file holds before anything is known of its meaning: columns, and rows with numbers."""

import difflib
from typing import NamedTuple

import numpy as np


class Column(NamedTuple):
    """A column as it stands in a file.

    title : what the file calls it, with all there is; "column 3" in a file without header
    name : that without unit and place; "" where there is none
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

    def not_read(self):
        """The end of a sentence: what the file has that is no column of numbers."""
        return f" (no real numbers, so not read: {listed(self.unread)})" if self.unread else ""

    def number(self, row):
        """How the reader finds a row (counted here from 0 on): "line 17"."""
        return f"{self.row_name} {row + 1 if self.numbers is None else int(self.numbers[row])}"


def shown(text, longest=60):
    """A text out of a file, as a message shows it: on one line, and short."""
    return repr(text if len(text) <= longest else text[: longest - 3] + "...")


def listed(names, most=20):
    """Names in a row, as a message lists them."""
    names = [shown(name) for name in names]
    more = [f"{len(names) - most} more"] if len(names) > most else []
    return ", ".join(names[:most] + more)


def nearest(asked, names):
    """The end of a message: which of these names was perhaps meant."""
    lower = {name.lower(): name for name in names}
    near = difflib.get_close_matches(asked.lower()[:60], lower, n=1, cutoff=0.7)
    return f"; did you mean {shown(lower[near[0]])}?" if near else ""
