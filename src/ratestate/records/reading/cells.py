"""Parse numbers and clock times in lines of text; fast if all cells are numbers."""

import csv
import itertools
import re
import warnings
from typing import NamedTuple

import numpy as np

COMMENTS = "#%"
CHUNK = 500  # lines; if a cell in a chunk is not a number, its lines are read cell by cell
#: decimal mark -> pattern of numbers with separators between groups of three digits: 1,234.5
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
#: a time or a date in a cell that is not a number
LIKE_CLOCK = re.compile(r"\d:\d\d|\d{4}-\d\d-\d\d|\d/\d+/\d")


class Clock:
    """Reader of a column of clock times: first cell by cell, then the column as a whole.

    minutes : whether the first number of a time is minutes
    """

    def __init__(self, minutes):
        self.minutes = minutes
        self.date_numbers: dict[str, int] = {}  # date as written ("" if missing) -> its number

    def seconds(self, cells):
        """Return seconds of the day plus `DAY` times the date's number; NaN if not a time."""
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
        number = self.date_numbers.setdefault(match["date"] or "", len(self.date_numbers))
        return of_day + float(rest.replace(",", ".").replace(":", ".")) + DAY * number

    def continuous(self, seconds):
        """Return seconds since the first day began, from the `seconds` of a whole column.

        If no cell has a date, a decrease by more than half a day counts as midnight.  If times are
        minutes and seconds, a decrease by more than half an hour counts as the full hour.
        """
        seconds, good = seconds.copy(), np.isfinite(seconds)
        dates = [*self.date_numbers]
        if dates != [""]:
            days = _day_numbers(dates)
            numbers = np.clip((seconds[good] // DAY).astype(int), 0, len(dates) - 1)
            seconds[good] += DAY * (days[numbers] - numbers)
            return seconds
        period = 3600.0 if self.minutes else DAY
        falls = np.diff(seconds[good], prepend=seconds[good][:1]) < -period / 2.0
        seconds[good] += period * np.cumsum(falls)
        return seconds


def detect_clock(cell, unit=""):
    """Return the `Clock` for a cell and its column's unit; None if it is not a clock time."""
    match = _TIME.fullmatch(cell)
    if match is None:
        return None
    is_bare = not (match["third"] or match["part"] or match["date"] or match["half"])
    written = re.sub(r"\W", "", unit.lower())
    in_minutes = written in ("mmss", "mss", "ms")
    if is_bare and not in_minutes and written not in ("hhmm", "hmm", "hm"):
        return None  # it may be hours and minutes, or minutes and seconds
    return Clock(bool(match["part"]) or (is_bare and in_minutes))


def _day_numbers(dates):
    """Return the day number of each date; 0 for the first date and for "", NaN if not a date.

    The day is written before or after the month.  The order that leaves the dates closest together
    counts.
    """

    def implausibility(days):
        known = days[np.isfinite(days)]
        span = np.ptp(known) if known.size else 0.0
        return np.isnan(days).sum(), span, (np.diff(known) < 0.0).any()

    readings = [np.array([_day_number(date, first) for date in dates]) for first in (True, False)]
    days = min(readings, key=implausibility)
    days = days - next(iter(days[np.isfinite(days)]), 0.0)
    return np.where([date == "" for date in dates], 0.0, days)


def _day_number(date, day_first):
    import pandas

    if count := re.fullmatch(r"(\d+)\s*(?:d|days?)?", date):
        return float(count[1])
    # years come first in an order of their own, and dots are written after days
    day_first = "." in date or (day_first and not re.match(r"\d{3,}", date))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # pandas warns if the day and month are in the other order
        parsed = pandas.to_datetime(date, errors="coerce", dayfirst=day_first)
    return np.nan if pandas.isna(parsed) else float(parsed.toordinal())


class Layout(NamedTuple):
    """Layout of a line of numbers."""

    delimiter: str | None  # None: any number of spaces
    decimal: str  # "." or ","
    width: int  # number of cells
    clocks: dict[int, Clock]  # index of each column of clock times -> its Clock


def is_comment(line):
    return line.lstrip().startswith(tuple(COMMENTS))


def has_content(line):
    """Return whether a line is neither blank nor a comment."""
    return bool(line.strip()) and not is_comment(line)


def split_cells(line, delimiter):
    """Return the cells of a line of numbers, including empty cells at its end."""
    line = line.rstrip("\n")
    line = line.strip(" ") if delimiter == "\t" else line.strip()
    if '"' in line and delimiter is not None:  # quotes may contain the delimiter
        cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    else:
        cells = line.split(delimiter)
    return [cell.strip(" \"'") for cell in cells]


def drop_empty_end(cells, least=0):
    """Return the cells without the empty ones at their end, but at least `least` cells."""
    end = len(cells)
    while end > least and not cells[end - 1]:
        end -= 1
    return cells[:end]


def parse_number(cell, decimal="."):
    """Return the number in a cell; NaN if the cell is not a number."""
    if ":" in cell or "_" in cell:  # quick exit, because every row may have a clock time
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


def parse_rows(lines, layout):
    """Return the numbers (rows, columns) in lines of text, and the line index of each row (rows,).

    Blank lines and comments are not rows.  Cells without a number are NaN.  A row with more cells
    than columns has only NaN.
    """
    if (values := _parse_numbers(lines, layout)) is not None:
        return values, np.arange(len(lines))
    if len(lines) > CHUNK:
        starts = range(0, len(lines), CHUNK)
        parts = [parse_rows(lines[i : i + CHUNK], layout) for i in starts]
        places = [start + place for start, (_, place) in zip(starts, parts, strict=True)]
        return np.concatenate([values for values, _ in parts]), np.concatenate(places)
    width = layout.width
    filled = [i for i, line in enumerate(lines) if has_content(line)]
    rows = [drop_empty_end(split_cells(lines[i], layout.delimiter), width) for i in filled]
    rows = [cells if len(cells) <= width else [] for cells in rows]
    values = np.empty((len(rows), width))
    for j, cells in enumerate(itertools.zip_longest(*rows, [""] * width, fillvalue="")):
        values[:, j] = _parse_column(cells[:-1], j, layout)
    return values, np.array(filled, int)


def _parse_numbers(lines, layout):
    """Return the numbers (lines, columns); None if any cell is not a plain Python number."""
    if not any(line.strip() for line in lines):
        return None
    if layout.decimal == ",":
        if any("." in line for line in lines):  # points may separate groups of digits
            return None
        lines = [line.replace(",", ".") for line in lines]
    try:
        values = np.loadtxt(lines, delimiter=layout.delimiter, comments=None, ndmin=2)
    except ValueError:
        return None
    return values if values.shape == (len(lines), layout.width) else None


def _parse_column(cells, j, layout):
    if j in layout.clocks:
        return layout.clocks[j].seconds(cells)
    if layout.decimal == "." and "_" not in "".join(cells):
        try:
            return np.array(cells, float)
        except ValueError:
            pass
    return np.array([parse_number(cell, layout.decimal) for cell in cells])
