"""Select the rows of a record, report rows that are left out, and average very long records.

A mean over k rows is an anti-alias filter with exactly known effects.  It reduces the variance of
white noise k times, leaves a straight line straight, and keeps a step within one block, without
ringing.  It weakens an oscillation of period P, over blocks of duration B, by the factor
sin(pi B/P)/(pi B/P), which is 0 at the rate of the new samples.
"""

import itertools

import numpy as np

from ...model.units import to_si
from ..load_point.splits import gaps_in
from ..messages import reading as sentences
from .cells import LIKE_CLOCK
from .columns import Column, quoted

#: default of the most rows that are kept: `fit` uses a fifth of them or fewer
MAX_ROWS = 1_000_000
MIN_LIMIT = 1_000  # least value of that limit
MIN_ROWS = 10  # fewest rows of a record
ROWS_LISTED = 5  # rows of each kind in a message
#: longest time step that counts as 0, as a fraction of the usual time step
REPEATED_TIME = 1e-9


class Rows:
    """The rows of one or several files that are kept, and their values.

    files : list of (first row, `Table`, symbol -> `Column`), the first row counted over all files
    record : symbol -> values, in the unit of the file until they are converted to SI

    `columns` (of the first file) and `units` (symbol -> unit) are for messages.  `kept` has the
    indices of the kept rows, counted over all files from 0.  `gaps`, set by `find_gaps`, has the
    positions along `kept` before which there is a gap in time.
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
        """Return the label of a row for messages: "line 17", or "line 17 of b.txt"."""
        first, table, _ = self._file(row)
        label = table.row_label(row - first)
        return f"{label} of {table.name}" if len(self.files) > 1 else label

    def cell(self, row, symbol):
        """Return a cell that is not a number, for a message."""
        first, table, columns = self._file(row)
        return table.cell(row - first, columns[symbol])

    def _file(self, row):
        return next(file for file in reversed(self.files) if file[0] <= row)

    def check_numbers(self):
        """Raise ParameterError if a column has no finite number in the kept rows."""
        for symbol, values in self.record.items():
            if np.isfinite(values).any():
                continue
            row = int(self.kept[0])
            cell, title = self.cell(row, symbol), quoted(self.columns[symbol].title)
            dated = symbol == "time" and LIKE_CLOCK.search(cell)
            values = {"title": title, "symbol": symbol, "row": self.row_label(row), "cell": cell}
            raise sentences.refusal("column.dates" if dated else "column.no_numbers", **values)

    def keep(self, selection):
        """Keep only the rows that a mask or slice along `kept` selects."""
        self.kept = self.kept[selection]
        for symbol, values in self.record.items():  # one by one to save memory
            self.record[symbol] = values[selection]

    def leave_out(self, bad, why, shown=None):
        """Leave out the rows of a mask along `kept`; add a warning if there are any.

        why : the reason, for the warning
        shown : function of a position along `kept` that returns the value to show, or None
        """
        if bad.any():
            rows = self.list_rows(np.flatnonzero(bad), shown)
            self.warnings.append(f"{_count_rows(bad.sum())} left out {why}: {rows}")
            self.keep(~bad)

    def list_rows(self, places, shown=None):
        """List rows for a message: "line 17 ('x' in 'Time(s)'), line 20 and 3 more"."""
        texts = [
            self.row_label(self.kept[i]) + (f" ({shown(i)})" if shown else "")
            for i in places[:ROWS_LISTED]
        ]
        more = f" and {len(places) - ROWS_LISTED} more" if len(places) > ROWS_LISTED else ""
        return ", ".join(texts) + more

    def apply_windows(self, windows):
        """Keep only the rows from the first to the last one inside the windows.

        windows : symbol -> (name, from, to) from `parse_window`; may be empty

        ParameterError if too few rows are inside, or if a window needs a displacement that the
        record lacks.
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
        """Leave out rows that lack a finite number in some column.

        If most rows lack one, the emptiest column is left out if it is a stress and friction is
        recorded; otherwise ParameterError.  Rows without any number do not count.  ParameterError
        also if a column has no number at all.
        """
        self.check_numbers()
        while True:
            good = {symbol: np.isfinite(values) for symbol, values in self.record.items()}
            is_whole, has_any = np.all([*good.values()], axis=0), np.any([*good.values()], axis=0)
            if 2 * is_whole.sum() >= has_any.sum():
                break
            symbol = min(good, key=lambda name: good[name].sum())
            values = {
                "title": quoted(self.columns[symbol].title),
                "symbol": symbol,
                "count": int(good[symbol].sum()),
                "whole": int(is_whole.sum()),
                "rows": int(has_any.sum()),
                "row": self.row_label(self.kept[np.argmax(has_any & ~good[symbol])]),
            }
            if "friction" not in self.record or symbol not in ("tau", "sigma"):
                raise sentences.refusal("column.sparse", **values)
            self.warnings.append(sentences("notes.sparse", **values))
            del self.record[symbol]

        def bad_cell(i):
            symbol = next(symbol for symbol in good if not good[symbol][i])
            return f"{self.cell(self.kept[i], symbol)} in {quoted(self.columns[symbol].title)}"

        self.leave_out(~is_whole, "because a number is missing", bad_cell)

    def check_order(self):
        """Leave out rows that repeat a time; ParameterError if times run backwards."""
        t = self.record["time"]
        steps = np.diff(t)
        if (steps < 0.0).any():
            backwards = np.flatnonzero(steps < 0.0) + 1
            first, next_ = t[backwards[0] - 1 : backwards[0] + 1]
            raise sentences.refusal(
                "rows.backwards", rows=self.list_rows(backwards), first=first, next=next_
            )
        typical = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
        repeated = np.append(False, steps <= REPEATED_TIME * typical)
        self.leave_out(repeated, "because the time is repeated", lambda i: f"{t[i]:.10g} s")
        if 10 * repeated.sum() > t.size:
            self.warnings[-1] += " (the times have too few digits)"

    def find_gaps(self):
        """Set `gaps`, and add a warning if there are any."""
        t = self.record["time"]
        gaps = gaps_in(t)
        self.gaps = np.array(gaps, int)
        if gaps:
            rows = self.list_rows(gaps, lambda i: f"{t[i] - t[i - 1]:.3g} s")
            count = "a gap" if len(gaps) == 1 else f"{len(gaps)} gaps"
            self.warnings.append(f"{count} in time before {rows}")

    def check_enough(self, where=""):
        """Raise ParameterError if fewer than `MIN_ROWS` rows are kept.

        where : text after "are left" in the message, such as " in the window"
        """
        if self.kept.size < MIN_ROWS:
            warnings = "; ".join(self.warnings) or "Give a longer record or a wider window."
            count = _count_rows(self.kept.size)
            raise sentences.refusal(
                "rows.few", count=count, where=where, fewest=MIN_ROWS, warnings=warnings
            )


def _count_rows(rows):
    return "1 row is" if rows == 1 else f"{rows} rows are"


def parse_window(symbol, ends, name):
    """Return (name, from, to) of a window in SI; None becomes infinity.

    ParameterError if it is not a pair, if an end has a wrong unit, or unless from < to.
    """
    try:
        pair = [] if isinstance(ends, str) else ends
        # plain numbers look better in a message than NumPy's
        first, last = (x.item() if isinstance(x, np.generic) else x for x in pair)
    except (TypeError, ValueError):
        example = "('11640 s', '11720 s')" if symbol == "time" else "('8600 um', '8900 um')"
        raise sentences.refusal("window.pair", name=name, window=ends, example=example) from None
    low = -np.inf if first is None else to_si(symbol, first, label=f"{name} (from)", bound="")
    high = np.inf if last is None else to_si(symbol, last, label=f"{name} (to)", bound="")
    if not low < high:
        raise sentences.refusal("window.order", name=name, window=(first, last))
    return name, low, high


def downsample(rows, most):
    """Average the `Rows` in blocks, with a warning, if there are more than `most` (int or None)."""
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
    """Return the first row of each block of n rows, and the usual number of rows in a block.

    gaps : rows before which there is a gap; no block contains a gap

    The last block before a gap may have more rows or fewer.
    """
    factor = -(-n // most)
    edges = [0, *gaps, n]
    parts = [
        first + factor * np.arange(max(1, (end - first) // factor))
        for first, end in itertools.pairwise(edges)
    ]
    return np.concatenate(parts), factor


def block_means(values, starts):
    """Return the mean of values (n,) over each block: (starts,)."""
    return np.add.reduceat(values, starts) / np.diff(np.append(starts, values.size))
