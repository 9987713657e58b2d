"""The contents of a file before they are interpreted: columns, and rows with numbers."""

from typing import NamedTuple

import numpy as np

#: characters of a text, and names of a list, in a message
LONGEST, MOST = 60, 20


class Column(NamedTuple):
    """A column as it stands in a file."""

    title: str  # its whole name in the file; "column 3" in a file without header
    name: str  # the title without unit and group; "" where there is none
    unit: str  # the unit beside it in the file, as written; "" where there is none
    values: np.ndarray  # of float, NaN where a cell is no number
    other_unit: str = ""  # one elsewhere in the header that contradicts it


class Table(NamedTuple):
    """Columns of a file, maybe of different lengths."""

    columns: list[Column]
    row_name: str  # "line" of a text, or "row"
    odd: dict[tuple[int, str], str]  # (row from 0, title) -> cell that is no number
    numbers: np.ndarray | None = None  # of the rows, as an editor counts them; None if 1, 2, ...
    unread: tuple[str, ...] = ()  # titles of arrays that hold no real numbers
    files: tuple[tuple[int, str], ...] = ()  # of several: first row and name of each

    @property
    def titles(self):
        """list of the columns' titles, which may repeat."""
        return [column.title for column in self.columns]

    def unread_text(self):
        """The end of a sentence on what the file has beside columns of numbers; "" for nothing."""
        return f" (no real numbers, so not read: {name_list(self.unread)})" if self.unread else ""

    def row_label(self, row):
        """How a person finds a row (counted from 0 on) in the file: "line 17"."""
        number = row + 1 if self.numbers is None else int(self.numbers[row])
        names = [f" of {name}" for first, name in self.files if first <= row]
        return f"{self.row_name} {number}{names[-1] if names else ''}"

    def cell(self, row, column):
        """What stands in a cell that is no number, in quotes, and short; "nothing" if empty."""
        text = self.odd.get((row, column.title), str(column.values[row]))
        return quoted(text) if text else "nothing"


def quoted(text):
    """A text out of a file, as a message shows it: in quotes, on one line, `LONGEST` at most."""
    return repr(text if len(text) <= LONGEST else text[: LONGEST - 3] + "...")


def name_list(names):
    """Names, quoted, as a message lists them: the first `MOST`, and how many more there are."""
    more = [f"{len(names) - MOST} more"] if len(names) > MOST else []
    return ", ".join([*map(quoted, names[:MOST]), *more])
