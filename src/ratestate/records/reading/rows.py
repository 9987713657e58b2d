"""Rows of a record: those left out and reported by number, and means over blocks of the others.

A mean over k rows is the anti-alias filter whose effects are exactly known: white noise of
variance s^2 has s^2/k after it, a straight line is a straight line, a step stays within one block
(no ringing before or after it), and an oscillation of period P, over blocks that last B, is
weakened by the factor sin(pi B/P)/(pi B/P), which is 0 at the rate of the new samples.
"""

import itertools

import numpy as np

from ...model.units import is_integer, to_si
from ..load_point.splits import gaps_in
from ..messages import reading as sentences
from .cells import LIKE_CLOCK
from .columns import Column, quoted

#: most rows that are kept, by default: `fit` takes a fifth of that, and one of many steps less
MAX_ROWS = 1_000_000
MIN_LIMIT = 1_000  # that may be asked for
MIN_ROWS = 10  # rows
ROWS_LISTED = 5  # rows of each kind in a message
#: a step of time this short, over the usual one, counts as 0: it gives no speed
REPEATED_TIME = 1e-9


class Rows:
    """The rows of one or several files that are `kept`, and their `record`.

    files : list of (first row, `Table`, symbol -> `Column`), the first row counted over all files
    record : symbol -> values, in the unit of the file until they are converted to SI

    `columns` (those of the first file) and `units` (symbol -> unit) are for messages.  `kept` has
    indices over all files, from 0; `gaps` the places along `kept` before which there is a gap in
    time, once `find_gaps` has looked.
    """

    def __init__(self, files, record):
        self.files, self.record = files, record
        self.columns: dict[str, Column] = files[0][2]
        self.units: dict[str, str] = {}
        self.kept = np.arange(record["time"].size)
        self.warnings: list[str] = []
        self.gaps = np.zeros(0, int)

    @property
    def name(self):
        """Name of the first file."""
        return self.files[0][1].name

    def row_label(self, row):
        """How a person finds a row: "line 17", or "line 17 of b.txt" if there are several files."""
        first, table, _ = self._file(row)
        label = table.row_label(row - first)
        return f"{label} of {table.name}" if len(self.files) > 1 else label

    def cell(self, row, symbol):
        """A cell that is not a number, as a message shows it."""
        first, table, columns = self._file(row)
        return table.cell(row - first, columns[symbol])

    def _file(self, row):
        return next(file for file in reversed(self.files) if file[0] <= row)

    def check_numbers(self):
        """ParameterError for a column without any finite number in the rows that are kept."""
        for symbol, values in self.record.items():
            if np.isfinite(values).any():
                continue
            row = int(self.kept[0])
            cell, title = self.cell(row, symbol), quoted(self.columns[symbol].title)
            dated = symbol == "time" and LIKE_CLOCK.search(cell)
            raise sentences.refusal(
                "column.dates" if dated else "column.no_numbers",
                title=title,
                symbol=symbol,
                row=self.row_label(row),
                cell=cell,
            )

    def keep(self, which):
        """Keep only these of the rows: a mask or slice along `kept`."""
        self.kept = self.kept[which]
        for symbol, values in self.record.items():  # one after the other: they may be large
            self.record[symbol] = values[which]

    def leave_out(self, bad, why, shown=None):
        """Leave out the rows of a mask along `kept`, with a warning; nothing if it is all False.

        why, shown : the reason; function of a place along `kept`, what the warning shows of it
        """
        if bad.any():
            rows = self.list_rows(np.flatnonzero(bad), shown)
            self.warnings.append(f"{_count_rows(bad.sum())} left out {why}: {rows}")
            self.keep(~bad)

    def list_rows(self, places, shown=None):
        """Some rows as a message lists them: "line 17 ('x' in 'Time(s)'), line 20 and 3 more"."""
        texts = [
            self.row_label(self.kept[i]) + (f" ({shown(i)})" if shown else "")
            for i in places[:ROWS_LISTED]
        ]
        more = f" and {len(places) - ROWS_LISTED} more" if len(places) > ROWS_LISTED else ""
        return ", ".join(texts) + more

    def apply_windows(self, windows):
        """Keep only the rows in the windows, from the first one inside to the last.

        windows : symbol -> (name, from, to) as by `parse_window`; may be empty

        ParameterError: no row is inside, too few are, or there is no displacement for a window.
        """
        for symbol, (name, low, high) in windows.items():
            if symbol not in self.record:
                raise sentences.refusal("window.no_displacement")
            values = self.record[symbol]
            inside = np.flatnonzero((values >= low) & (values <= high))
            if not inside.size:
                ends = {"low": np.nanmin(values), "high": np.nanmax(values)}
                raise sentences.refusal("window.no_row", name=name, symbol=symbol, **ends)
            self.keep(slice(inside[0], inside[-1] + 1))
        self.check_enough(" in the window" if windows else "")

    def drop_unreadable(self):
        """Leave out rows without a finite number in any column.

        ParameterError if a column has none, or if most rows lack a number in a column that is
        needed; stresses are left out beside friction.  Rows without any number do not count.
        """
        self.check_numbers()
        while True:
            good = {symbol: np.isfinite(values) for symbol, values in self.record.items()}
            whole, some = np.all([*good.values()], axis=0), np.any([*good.values()], axis=0)
            if 2 * whole.sum() >= some.sum():
                break
            symbol = min(good, key=lambda name: good[name].sum())
            values = {
                "title": quoted(self.columns[symbol].title),
                "symbol": symbol,
                "count": int(good[symbol].sum()),
                "whole": int(whole.sum()),
                "rows": int(some.sum()),
                "row": self.row_label(self.kept[np.argmax(some & ~good[symbol])]),
            }
            if "friction" not in self.record or symbol not in ("tau", "sigma"):
                raise sentences.refusal("column.sparse", **values)
            self.warnings.append(sentences("notes.sparse", **values))
            del self.record[symbol]

        def bad_cell(i):
            symbol = next(symbol for symbol in good if not good[symbol][i])
            return f"{self.cell(self.kept[i], symbol)} in {quoted(self.columns[symbol].title)}"

        self.leave_out(~whole, "for want of a number", bad_cell)

    def check_order(self):
        """Leave out rows that repeat a time; ParameterError for times that run backwards."""
        t = self.record["time"]
        steps = np.diff(t)
        if (steps < 0.0).any():
            back = np.flatnonzero(steps < 0.0) + 1
            first, next_ = t[back[0] - 1 : back[0] + 1]
            raise sentences.refusal(
                "rows.backwards", rows=self.list_rows(back), first=first, next=next_
            )
        usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
        repeated = np.append(False, steps <= REPEATED_TIME * usual)
        self.leave_out(repeated, "with the time of the row before", lambda i: f"{t[i]:.10g} s")
        if 10 * repeated.sum() > t.size:
            self.warnings[-1] += "; the times have too few digits"

    def find_gaps(self):
        """Warn of steps of time that are much longer than those before and after."""
        t = self.record["time"]
        gaps = gaps_in(t)
        self.gaps = np.array(gaps, int)
        if gaps:
            rows = self.list_rows(gaps, lambda i: f"{t[i] - t[i - 1]:.3g} s")
            count = "a gap" if len(gaps) == 1 else f"{len(gaps)} gaps"
            self.warnings.append(f"{count} in time before {rows}")

    def check_enough(self, where=""):
        """ParameterError if fewer than `MIN_ROWS` rows are kept.

        where : what follows "are left" in the messages, such as " in the window"
        """
        if self.kept.size < MIN_ROWS:
            warnings = "; ".join(self.warnings) or "give a longer record or a wider window"
            count = _count_rows(self.kept.size)
            raise sentences.refusal(
                "rows.few", count=count, where=where, fewest=MIN_ROWS, warnings=warnings
            )


def _count_rows(rows):
    return "1 row is" if rows == 1 else f"{rows} rows are"


def parse_window(symbol, ends, name):
    """(name, from, to) of a window [SI], infinite where None is given.

    ParameterError for what is no pair, for ends of another unit, and unless from < to.
    """
    try:
        pair = [] if isinstance(ends, str) else ends
        # as plain numbers: a message shows them
        first, last = (x.item() if isinstance(x, np.generic) else x for x in pair)
    except (TypeError, ValueError):
        example = "('11640 s', '11720 s')" if symbol == "time" else "('8600 um', '8900 um')"
        raise sentences.refusal("window.pair", name=name, window=ends, example=example) from None
    low = -np.inf if first is None else to_si(symbol, first, label=f"{name} (from)", bound="")
    high = np.inf if last is None else to_si(symbol, last, label=f"{name} (to)", bound="")
    if not low < high:
        raise sentences.refusal("window.order", name=name, window=(first, last))
    return name, low, high


def check_max_rows(rows):
    """The most rows to keep, as given, None for all; ParameterError for what is no such number."""
    if rows is not None and not (is_integer(rows) and rows >= MIN_LIMIT):
        raise sentences.refusal("rows.most", rows=rows, fewest=MIN_LIMIT, most=MAX_ROWS)
    return rows


def downsample(rows, most):
    """Let each of the `Rows` be the mean over a block, with a warning, if they are more than most.

    most : int, or None for any number
    """
    n = rows.kept.size
    if most is None or n <= most:
        return
    before = float(np.median(np.diff(rows.record["time"])))
    starts, factor = block_starts(n, rows.gaps, most)
    rows.kept = rows.kept[starts + factor // 2]
    for symbol, values in rows.record.items():
        rows.record[symbol] = block_means(values, starts)
    after = float(np.median(np.diff(rows.record["time"])))
    rows.gaps = np.searchsorted(starts, rows.gaps)
    values = {"n": n, "kept": starts.size, "factor": factor, "before": before, "after": after}
    rows.warnings.append(sentences("notes.means", **values))


def block_starts(n, gaps, most):
    """First row of each block of n rows, and how many rows are in each; no block has a gap inside.

    gaps : (gaps,) rows before which there is one

    The last block before a gap has the rows that are left over as well, or it has fewer.
    """
    factor = -(-n // most)
    edges = [0, *gaps, n]
    parts = [
        first + factor * np.arange(max(1, (end - first) // factor))
        for first, end in itertools.pairwise(edges)
    ]
    return np.concatenate(parts), factor


def block_means(values, starts):
    """Mean of values (n,) over each block (starts,)."""
    return np.add.reduceat(values, starts) / np.diff(np.append(starts, values.size))
