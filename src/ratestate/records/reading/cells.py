"""Numbers and clock times out of lines of text, fast if all cells are numbers."""

import csv
import itertools
import re
import warnings
from typing import NamedTuple

import numpy as np

COMMENTS = "#%"
PART = 500  # lines of which one without a number lets all be read cell by cell
#: decimal mark -> numbers with blanks or other marks between groups of three digits: 1,234.5
_GROUPED = {
    mark: re.compile(
        rf"[-+]?[1-9]\d{{0,2}}(?P<gap>[ '{other}])\d{{3}}(?:(?P=gap)\d{{3}})*(?:[{mark}]\d*)?"
    )
    for mark, other in (".,", ",.")
}
_FORTRAN = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+))[dD]([-+]?\d+)")  # 1.0D+02
DAY = 86400.0  # s
#: 12:00:01.5, 2019-05-14T12:00:01Z, 14.05.2019 12:00:01,5, 12:00 PM; 00:01.5 is minutes and seconds
_TIME = re.compile(
    r"(?:(?P<date>\S.*?)(?:\s+|t))??(?P<first>\d{1,4}):(?P<second>\d\d)"
    r"(?::(?P<third>\d\d(?:[.,:]\d*)?)|(?P<part>[.,]\d+))?"
    r"\s*(?P<half>[ap])?(?(half)\.?\s?m\.?)\s*(?:z|utc|[+-]\d\d:?\d\d)?",
    re.IGNORECASE,
)
#: 2019-05-14, 14.05.2019, 5/14/2019
DATE = re.compile(r"(\d{1,4})([-./])(\d{1,2})\2(\d{1,4})")
#: a time or a date in a cell that is no number
LIKE_CLOCK = re.compile(r"\d:\d\d|\d{4}-\d\d-\d\d|\d/\d+/\d")


class Clock:
    """A column of clock times, which is read cell by cell, and then as a whole.

    minutes : whether the first number of a time is minutes
    """

    def __init__(self, minutes):
        self.minutes = minutes
        self.numbers: dict[str, int] = {}  # date as written, "" for none -> its number

    def seconds(self, cells):
        """(cells,) seconds of the day, and `DAY` times the number of the date; NaN for others."""
        return np.array([self._seconds(cell) for cell in cells])

    def _seconds(self, cell):
        match = _TIME.fullmatch(cell)
        if match is None:
            return np.nan
        hours, half = float(match["first"]), (match["half"] or "").lower()
        if half:
            hours = hours % 12.0 + 12.0 * (half == "p")
        of_day = (60.0 * hours + float(match["second"])) * (1.0 if self.minutes else 60.0)
        rest = match["third"] or "0" + (match["part"] or "")
        number = self.numbers.setdefault(match["date"] or "", len(self.numbers))
        return of_day + float(rest.replace(",", ".").replace(":", ".")) + DAY * number

    def continuous(self, seconds):
        """(n,) seconds from the beginning of the first day, out of those of a whole column.

        If no cell has a date, a fall by half a day or more is midnight, or the full hour.
        """
        seconds, good = seconds.copy(), np.isfinite(seconds)
        dates = [*self.numbers]
        if dates != [""]:
            days = _days(dates)
            numbers = np.clip((seconds[good] // DAY).astype(int), 0, len(dates) - 1)
            seconds[good] += DAY * (days[numbers] - numbers)
            return seconds
        period = 3600.0 if self.minutes else DAY
        falls = np.diff(seconds[good], prepend=seconds[good][:1]) < -period / 2.0
        seconds[good] += period * np.cumsum(falls)
        return seconds


def clock_of(cell, unit=""):
    """The `Clock` of a column, by a cell and its unit; None if the cell is not a clock time."""
    match = _TIME.fullmatch(cell)
    if match is None:
        return None
    alone = not (match["third"] or match["part"] or match["date"] or match["half"])
    written = re.sub(r"\W", "", unit.lower())
    in_minutes = written in ("mmss", "mss", "ms")
    if alone and not in_minutes and written not in ("hhmm", "hmm", "hm"):
        return None  # hours and minutes, or minutes and seconds
    return Clock(bool(match["part"]) or (alone and in_minutes))


def _days(dates):
    """(dates,) numbers of days, the first 0: with the day before the month, or after it.

    Whichever leaves the dates closest together; 0 for "", NaN for what is not a date.
    """

    def oddness(days):
        known = days[np.isfinite(days)]
        span = np.ptp(known) if known.size else 0.0
        return np.isnan(days).sum(), span, (np.diff(known) < 0.0).any()

    readings = [np.array([_day(date, first) for date in dates]) for first in (True, False)]
    days = min(readings, key=oddness)
    days = days - next(iter(days[np.isfinite(days)]), 0.0)
    return np.where([date == "" for date in dates], 0.0, days)


def _day(date, day_first):
    import pandas

    if count := re.fullmatch(r"(\d+)\s*(?:d|days?)?", date):
        return float(count[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it is written in the other order
        found = pandas.to_datetime(date, errors="coerce", dayfirst=day_first or "." in date)
    return np.nan if pandas.isna(found) else float(found.toordinal())


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
    if len(lines) > PART:
        starts = range(0, len(lines), PART)
        parts = [rows_in(lines[i : i + PART], layout) for i in starts]
        places = [start + own for start, (_, own) in zip(starts, parts, strict=True)]
        return np.concatenate([values for values, _ in parts]), np.concatenate(places)
    width = layout.width
    full = [i for i, line in enumerate(lines) if is_full(line)]
    rows = [trimmed(cells_of(lines[i], layout.delimiter), width) for i in full]
    rows = [cells if len(cells) <= width else [] for cells in rows]
    values = np.empty((len(rows), width))
    for j, cells in enumerate(itertools.zip_longest(*rows, [""] * width, fillvalue="")):
        values[:, j] = _column(cells[:-1], j, layout)
    return values, np.array(full, int)


def _all_numbers(lines, layout):
    """(lines, columns) numbers; None unless each line is a row of them, as Python reads numbers."""
    if not any(line.strip() for line in lines):
        return None
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
