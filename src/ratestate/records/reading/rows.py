"""Rows of a record that cannot be used, or look odd: left out, reported by number, or refused."""

import re

import numpy as np

from ...errors import ParameterError
from .table import quoted

FEWEST = 10  # rows
LISTED = 5  # rows of each kind in a message
#: a gap is a step of time so many times longer than usual on either side of it
GAP = 5.0
#: a step of time this short, over the usual one, counts as 0: it gives no speed
SAME = 1e-9
NEIGHBOURS = 10  # rows that define what is usual
CLOCK = re.compile(r"\d:\d\d|\d{4}-\d\d-\d\d|\d/\d+/\d")


class Rows:
    """The rows that are kept, as indices into the table, with warnings on the others.

    Parameters
    ----------
    table : Table
    columns : dict
        Symbol -> `Column`, of one length; ``time`` in seconds.
    t : ndarray
        The times [s], NaN among them.
    """

    def __init__(self, table, columns, t):
        self.table, self.columns, self.t = table, columns, t
        self.kept = np.arange(t.size)
        self.warnings: list[str] = []

    def listed(self, rows, what=None):
        """Some rows as a message lists them: "line 17 ('x' in 'Time(s)'), line 20 and 3 more"."""
        texts = []
        for row in rows[:LISTED]:
            more = f" ({what(row)})" if what else ""
            texts.append(f"{self.table.row_label(row)}{more}")
        more = f" and {len(rows) - LISTED} more" if len(rows) > LISTED else ""
        return ", ".join(texts) + more

    def drop_unreadable(self):
        """Leave out rows without a number in a column that is needed."""
        columns = self.columns.values()
        if self.kept.size:
            for symbol, column in self.columns.items():
                check_numbers(self.table, symbol, column, self.kept)
        good = np.all([np.isfinite(column.values[self.kept]) for column in columns], axis=0)
        self.leave_out(~good, "for want of a number", self._bad_cell)

    def leave_out(self, bad, why, what):
        """Leave out some of the rows that are kept.

        Parameters
        ----------
        bad : ndarray of bool
            Along `kept`.
        why, what : str, callable
            The reason; row -> what to show of it.
        """
        rows = self.kept[bad]
        self.kept = self.kept[~bad]
        if rows.size:
            self.warnings.append(f"{_rows(rows.size)} left out {why}: {self.listed(rows, what)}")

    def _bad_cell(self, row):
        """The cell of a row that is not a number, as a message shows it."""
        column = next(c for c in self.columns.values() if not np.isfinite(c.values[row]))
        text = self.table.odd.get((row, column.title), str(column.values[row]))
        return f"{quoted(text) if text else 'nothing'} in {quoted(column.title)}"

    def order(self):
        """Leave out repeated times; refuse times that run backwards."""
        t = self.t[self.kept]
        backwards = self.kept[1:][np.diff(t) < 0.0]
        if backwards.size:
            i = int(np.argmax(np.diff(t) < 0.0))
            raise ParameterError(
                f"time runs backwards at {self.listed(backwards)}, first from {t[i]:.10g} s to "
                f"{t[i + 1]:.10g} s; sort the rows by time, or, if the file holds several "
                f"records, read each by its window, such as time=(None, '{t[i]:.10g} s'), or "
                f"from a file of its own"
            )
        steps = np.diff(t)
        usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
        repeated = np.append(False, steps <= SAME * usual)
        bad = self.kept[repeated]
        self.kept = self.kept[~repeated]
        if bad.size:
            coarse = "; the times have too few digits" if 10 * bad.size > t.size else ""
            self.warnings.append(
                f"{_rows(bad.size)} left out with the time of the row before: "
                f"{self.listed(bad, lambda row: f'{self.t[row]:.10g} s')}{coarse}"
            )

    def find_gaps(self):
        """Note steps of time that are much longer than those before and after."""
        dt = np.diff(self.t[self.kept])
        if dt.size < 3:
            return
        beside = np.minimum(np.append(dt[1], dt[:-1]), np.append(dt[1:], dt[-2]))
        gaps = []
        for i in np.flatnonzero(dt > GAP * beside):
            sides = [dt[max(0, i - NEIGHBOURS) : i], dt[i + 1 : i + 1 + NEIGHBOURS]]
            # the sampling rate may change: then the step is usual on one side
            if dt[i] > GAP * max(float(np.median(side)) for side in sides if side.size):
                gaps.append(i)
        if gaps:
            length = {int(self.kept[i + 1]): dt[i] for i in gaps}
            listed = self.listed(list(length), lambda row: f"{length[row]:.3g} s")
            count = "a gap" if len(gaps) == 1 else f"{len(gaps)} gaps"
            self.warnings.append(f"{count} in time before {listed}")

    def check_enough(self, why=""):
        """Refuse a record of hardly any rows."""
        if self.kept.size < FEWEST:
            raise ParameterError(
                f"only {_rows(self.kept.size)} left{why}, {FEWEST} at least are needed; "
                f"{'; '.join(self.warnings) or 'give a longer record or a wider window'}"
            )


def _rows(count):
    return "1 row is" if count == 1 else f"{count} rows are"


def check_numbers(table, symbol, column, rows=slice(None)):
    """Refuse a column without any number in these rows."""
    if np.isfinite(column.values[rows]).any() or not column.values.size:
        return
    row = int(np.arange(column.values.size)[rows][0])
    text = table.odd.get((row, column.title), str(column.values[row]))
    remedy = f"name another in columns={{'{symbol}': ...}}"
    if symbol == "time" and CLOCK.search(text):
        remedy = "dates and clock times are not read: convert them to seconds from the start"
    raise ParameterError(
        f"the column {quoted(column.title)} ({symbol}) has no number in any row, but "
        f"{quoted(text) if text else 'nothing'} in {table.row_label(row)}; {remedy}"
    )


def check_alive(symbol, values, column):
    """Refuse a column that holds one value throughout where a record has to vary."""
    if symbol == "sigma" or np.ptp(values) > 0.0:
        return
    if symbol == "V_load":  # a constant one is a record without a step
        return
    if symbol == "tau":
        symbol = "tau, and so friction perhaps,"
    raise ParameterError(
        f"the column {quoted(column.title)} ({symbol}) is {values[0]:.6g} in all {values.size} "
        f"rows: a dead channel; name another in columns, or choose another window"
    )
