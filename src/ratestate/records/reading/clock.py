"""Clock times, with dates or without, as seconds."""

import contextlib
import datetime
import re

import numpy as np

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
    if not date:
        return np.nan
    if count := re.fullmatch(r"(\d+)\s*(?:d|days?)?", date):
        return float(count[1])
    match = DATE.fullmatch(date)
    if match and len(match[1]) < 4 and match[2] != ".":
        parts, year = (int(match[1]), int(match[3])), int(match[4])
        day, month = parts if day_first else parts[::-1]
        with contextlib.suppress(ValueError):
            return float(datetime.date(year + 2000 * (len(match[4]) < 3), month, day).toordinal())
        return np.nan
    import pandas

    found = pandas.to_datetime(date, errors="coerce", dayfirst="." in date)
    return np.nan if pandas.isna(found) else float(found.toordinal())
