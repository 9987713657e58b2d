"""Clock times, with dates or without, as seconds."""

import re
from typing import NamedTuple

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


class Clock(NamedTuple):
    """How a column of clock times is written."""

    minutes: bool  # the first number is minutes
    first: int  # the day of the first row, which counts as 0
    unsure: bool  # the day or the month may come first: the day is 100 times one plus the other


def clock_of(cell, unit=""):
    """The `Clock` of a column, by its first cell and its unit; None if it has no clock times."""
    match = _TIME.fullmatch(cell)
    if match is None:
        return None
    alone = not (match["third"] or match["part"] or match["date"] or match["half"])
    written = re.sub(r"\W", "", unit.lower())
    if alone and written not in ("hhmm", "hmm", "hm", "mmss", "mss", "ms"):
        return None  # hours and minutes, or minutes and seconds
    minutes = bool(match["part"]) or (alone and written in ("mmss", "mss", "ms"))
    date = DATE.fullmatch(match["date"] or "")
    unsure = date is not None and len(date[1]) < 4 and date[2] != "."
    day = _day(match["date"], unsure)
    return Clock(minutes, 0 if np.isnan(day) else int(day), unsure)


def seconds_in(cells, clock):
    """(cells,) seconds from the beginning of the first day, NaN for what is not a clock time."""
    import pandas

    found = pandas.Series(cells, dtype=str).str.extract(f"^{_TIME.pattern}$", flags=_TIME.flags)
    numbers = found[["first", "second"]].astype(float)
    rest = found["third"].fillna("0" + found["part"]).str.replace(r"[,:]", ".", regex=True)
    hours = numbers["first"]
    if found["half"].notna().any():
        hours = hours.mod(12.0) + 12.0 * found["half"].str.lower().eq("p")
    of_day = 60.0 * hours + numbers["second"]
    of_day = of_day if clock.minutes else 60.0 * of_day
    of_day = of_day + rest.astype(float).fillna(0.0)
    days = {date: _day(date, clock.unsure) for date in found["date"].dropna().unique()}
    day = found["date"].map(days).astype(float) - clock.first
    return (of_day + DAY * day.where(found["date"].notna(), 0.0)).to_numpy()


def continuous(seconds, clock):
    """Seconds of a whole column: days in order, and no fall at midnight or at the full hour."""
    seconds, good = seconds.copy(), np.isfinite(seconds)
    if clock.unsure:
        return _in_order(seconds, clock)
    period = 3600.0 if clock.minutes else DAY
    falls = np.diff(seconds[good], prepend=seconds[good][:1]) < -period / 2.0
    seconds[good] += period * np.cumsum(falls)
    return seconds


def _in_order(seconds, clock):
    """Seconds where the day or the month comes first in dates: what keeps the rows closest."""
    days = np.floor(seconds / DAY)
    codes = np.unique(days[np.isfinite(days)]).astype(int)
    readings = []
    for day_first in (True, False):
        dates = [_ordinal(code + clock.first, day_first) for code in codes]
        if None not in dates:
            readings.append(np.array(dates) - min(dates))
    if readings:
        best = min(readings, key=lambda dates: (np.ptp(dates), (np.diff(dates) < 0).any()))
        good = np.isfinite(days)
        places = np.searchsorted(codes, days[good].astype(int))
        seconds[good] += DAY * (best[places] - days[good])
    return seconds


def _ordinal(code, day_first):
    """The day of a code of `_day`, None if there is none."""
    import datetime

    year, parts = divmod(code, 10_000)
    day, month = divmod(parts, 100) if day_first else divmod(parts, 100)[::-1]
    try:
        return datetime.date(year, month, day).toordinal()
    except ValueError:
        return None


def _day(date, unsure):
    """The number of a day, or its code if the order of day and month is unsure; NaN for none."""
    import pandas

    if not date:
        return np.nan
    if count := re.fullmatch(r"(\d+)\s*(?:d|days?)?", date):
        return float(count[1])
    if unsure:
        match = DATE.fullmatch(date)
        if match is None:
            return np.nan
        year = int(match[4]) + 2000 * (len(match[4]) < 3)
        return float(10_000 * year + 100 * int(match[1]) + int(match[3]))
    found = pandas.to_datetime(date, errors="coerce", dayfirst="." in date)
    return np.nan if pandas.isna(found) else float(found.toordinal())
