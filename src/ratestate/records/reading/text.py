"""Tables of text: tabs, commas, semicolons or spaces between cells; which lines are the header."""

import contextlib
import csv
import itertools
import math
import re
from collections import Counter

import numpy as np

from .messages import refusal
from .table import Column, Table, quoted
from .titles import is_unit, plain, split

COMMENTS = "#%"
DELIMITERS = ("\t", ";", ",", None)  # None: spaces, as many as there are
LOOK = 200  # lines from which the layout is found
LARGEST = 10**9  # bytes, of which each takes some ten of memory
LONGEST = 20_000  # characters of a line
MOST_ABOVE = 2_000  # lines above the numbers
_FORTRAN = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+))[dD]([-+]?\d+)")  # 1.0D+02
_DECIMAL = re.compile(r"(?<=\d),(?=\d)")


def read_text(path):
    """The `Table` in a text file.

    ParameterError: too large, binary, a line too long, no rows of numbers, or above them a header
    of another number of names.
    """
    lines = _text(path).replace("\r\n", "\n").replace("\r", "\n").split("\n")
    number, longest = max(enumerate(map(len, lines), 1), key=lambda one: one[1])
    if longest > LONGEST:  # would take for ever
        raise refusal("text.long", name=path.name, line=number, length=longest, most=LONGEST)
    full = [i for i, line in enumerate(lines) if line.strip() and not _is_comment(line)]
    start, delimiter = _layout(path, lines, full)
    rows = full[full.index(start) :]
    look = [_cells(lines[i], delimiter) for i in rows if i < start + LOOK]
    width = Counter(map(len, look)).most_common(1)[0][0]
    names, units = _header(lines[:start], delimiter, width)
    titles = [name or f"column {i}" for i, name in enumerate(names, 1)]
    texts = [lines[i] for i in rows]
    if delimiter != "," and _decimal_comma(look):
        texts = [line.replace(",", ".") for line in texts]
    values, odd = _values(texts, delimiter, titles)
    columns = []
    for title, unit, column in zip(titles, units, values.T, strict=True):
        name, own = split(title)
        columns.append(Column(title, name, unit or own, column))
    return Table(columns, "line", odd, np.array(rows) + 1)


def _text(path):
    """The file as text, whatever the machine that wrote it."""
    if (size := path.stat().st_size) > LARGEST:
        raise refusal("text.large", name=path.name, size=size / 1e9, most=LARGEST / 1e9)
    data = path.read_bytes()
    utf_16 = data.startswith((b"\xff\xfe", b"\xfe\xff"))
    if b"\0" in data and not utf_16:
        raise refusal("text.binary", name=path.name)
    for encoding in ["utf-16"] if utf_16 else ["utf-8-sig", "cp1252", "latin-1"]:
        with contextlib.suppress(UnicodeDecodeError):
            return data.decode(encoding)
    raise refusal("text.encoding", name=path.name)


def _is_comment(line):
    return line.lstrip().startswith(tuple(COMMENTS))


def _cells(line, delimiter):
    """The cells of a line of numbers."""
    line = line.strip(" ") if delimiter == "\t" else line.strip()
    cells = [cell.strip(" \"'") for cell in line.split(delimiter)]
    return cells[:-1] if len(cells) > 2 and not cells[-1] and delimiter is not None else cells


def _number(cell):
    """A number out of a cell, NaN if it is none."""
    try:
        return float(cell) if "_" not in cell else np.nan
    except ValueError:
        match = _FORTRAN.fullmatch(cell)
        return float("e".join(match.groups())) if match else np.nan


def _is_data(cells):
    """Whether these look like a row of a record: two cells or more, hardly one without a number."""
    good = sum(cell.lower() == "nan" or not np.isnan(_number(cell)) for cell in cells)
    several = any(re.search(r"\d\s+[-+.\d]", cell) for cell in cells)
    return good >= 2 and 2 * good > len(cells) and not several


def _layout(path, lines, full):
    """Index of the first line of numbers, and the delimiter of its cells."""
    for start, after in zip(full[:MOST_ABOVE], [*full[1:], None], strict=False):
        for delimiter in DELIMITERS:
            cells, below = (
                _cells(line if delimiter == "," else _DECIMAL.sub(".", line), delimiter)
                for line in (lines[start], lines[after] if after else "")
            )
            # a date above the table is numbers as well
            if _is_data(cells) and (len(below) == len(cells) or not after):
                return start, delimiter
    begins = " and ".join(quoted(lines[i].strip()) for i in full[:2])
    raise refusal("text.no_numbers" if full else "text.empty", name=path.name, begins=begins)


def _decimal_comma(rows):
    """Whether numbers are written 0,5."""
    cells = [cell for row in rows for cell in row]
    commas = sum(bool(re.fullmatch(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?", cell)) for cell in cells)
    return commas > sum("." in cell for cell in cells)


def _header(lines, delimiter, width):
    """Names and units of the columns, "" for none, from the last two lines above the numbers."""
    kept = [line for line in lines if line.strip(" \t" + COMMENTS)][-2:]
    above, names = [None, None, *(_names(line, delimiter, width) for line in kept)][-2:]
    nothing = [""] * width
    if names is None:
        if kept and not _is_comment(kept[-1]):
            values = {"header": quoted(kept[-1].strip()), "width": width, "line": len(lines) + 1}
            count = len(_header_cells(kept[-1].strip(" "), delimiter))
            raise refusal("text.header", count=count, **values)
        return nothing, nothing
    if above and any(names) and all(not plain(name) or is_unit(name) for name in names):
        return above, names
    return names, nothing


def _names(line, delimiter, width):
    """The names in a line above the numbers, or None if they are not as many as columns."""
    line = line.strip(" ").lstrip(COMMENTS).strip(" ")
    ways = [_header_cells(line, delimiter), re.split(r"\s{2,}|\t", line)]
    ways += [_header_cells(line, ","), _header_cells(line, "\t"), line.split()]
    for cells in ways:
        if len(cells) == width + 1 and not cells[-1]:
            cells = cells[:-1]
        if len(cells) == width > 1:
            return [cell.strip() for cell in cells]
    return None


def _header_cells(line, delimiter):
    """The cells of a line of the header."""
    if delimiter is not None:
        return next(csv.reader([line], delimiter=delimiter), [])
    names: list[str] = []
    for word in line.split():  # "Time (s)" is one
        if names and (word[0] in "([{" or names[-1].count("(") > names[-1].count(")")):
            names[-1] += f" {word}"
        else:
            names.append(word)
    return names


def _values(lines, delimiter, titles):
    """The numbers, NaN where there is none, and the cells that are none."""
    try:
        return np.loadtxt(lines, delimiter=delimiter, comments=None, ndmin=2), {}
    except ValueError:
        pass
    values = np.full((len(lines), len(titles)), np.nan)
    odd: dict[tuple[int, str], str] = {}
    for i, line in enumerate(lines):
        cells = _cells(line, delimiter)
        if len(cells) > len(titles):  # perhaps in other columns
            odd |= {(i, title): f"{len(cells)} cells" for title in titles}
            continue
        for j, (title, cell) in enumerate(itertools.zip_longest(titles, cells, fillvalue="")):
            values[i, j] = number = _number(cell)
            if not math.isfinite(number):
                odd[i, title] = cell
    return values, odd
