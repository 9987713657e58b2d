"""Tables of text: tabs, commas, semicolons or spaces between the cells, with or without header."""

import csv
import re
from collections import Counter

import numpy as np

from ...errors import ParameterError
from .table import Column, Table, quoted
from .titles import is_unit, plain, split

COMMENTS = ("#", "%")
DELIMITERS = ("\t", ";", ",", None)  # None: spaces, as many as there are
LOOK = 200  # lines from which the layout is found
LARGEST = 10**9  # bytes, of which each takes some ten of memory
LONGEST = 20_000  # characters of a line
HEADER = 2_000  # lines above the numbers
_FORTRAN = re.compile(r"^([-+]?[\d.]+)[dD](?=[-+]?\d+$)")  # 1.0D+02
_DECIMAL = re.compile(r"(?<=\d),(?=\d)")


def read_text(path):
    """The `Table` in a text file.

    Raises
    ------
    ParameterError
        No text; no line of two numbers or more; a header with another number of names than the
        rows have cells.
    """
    lines = re.split(r"\r\n|\n|\r", _text(path))
    _check_lengths(path, lines)
    start, delimiter = _layout(path, lines)
    decimal = delimiter != "," and _decimal_comma(lines[start : start + LOOK], delimiter)
    width = _width(lines[start : start + LOOK], delimiter)
    heads = _header(lines[:start], delimiter, width, start)
    numbers, rows = [], []
    for number, line in enumerate(lines[start:], start + 1):
        if line.strip() and not _is_comment(line):
            numbers.append(number)
            rows.append(_cells(line.replace(",", ".") if decimal else line, delimiter))
    values, odd = _values(rows, [title for title, _, _ in heads], width)
    columns = [
        Column(title, name, unit, column)
        for (title, name, unit), column in zip(heads, values.T, strict=True)
    ]
    return Table(columns, "line", np.array(numbers), odd)


def _check_lengths(path, lines):
    """Refuse what is no table of a record, and would take for ever."""
    number, longest = max(enumerate(map(len, lines), 1), key=lambda one: one[1])
    if longest > LONGEST:
        raise ParameterError(
            f"{path.name} is no record: line {number} has {longest:,} characters, more than "
            f"{LONGEST:,}; save it with one row of a few numbers for each time"
        )


def _text(path):
    """The file as text, whatever the machine that wrote it."""
    if (size := path.stat().st_size) > LARGEST:
        raise ParameterError(
            f"{path.name} has {size / 1e9:.2f} GB, more than the {LARGEST / 1e9:g} GB that are "
            f"read as text; save it as HDF5, or in parts, or every tenth row"
        )
    data = path.read_bytes()
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        encodings = ["utf-16"]
    elif b"\0" in data:
        raise ParameterError(
            f"{path.name} is neither text nor HDF5 nor MAT; save it as one of these, such as .csv"
        )
    else:
        encodings = ["utf-8-sig", "cp1252", "latin-1"]
    for encoding in encodings:
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            pass
    raise ParameterError(f"{path.name} cannot be read as text; save it as UTF-8")


def _is_comment(line):
    return line.lstrip().startswith(COMMENTS)


def _cells(line, delimiter):
    """The cells of a line of numbers."""
    line = line.strip(" \r") if delimiter == "\t" else line.strip()
    cells = [cell.strip(" \"'") for cell in line.split(delimiter)]
    return cells[:-1] if len(cells) > 2 and not cells[-1] and delimiter is not None else cells


def _number(cell):
    """A number out of a cell, NaN if it is none."""
    try:
        return float(_FORTRAN.sub(r"\1e", cell)) if "_" not in cell else np.nan
    except ValueError:
        return np.nan


def _is_data(cells):
    """Whether these look like a row of a record: two cells or more, hardly one without a number."""
    good = sum(cell.lower() == "nan" or not np.isnan(_number(cell)) for cell in cells)
    several = any(re.search(r"\d\s+[-+.\d]", cell) for cell in cells)
    return good >= 2 and 2 * good > len(cells) and not several


def _layout(path, lines):
    """Index of the first line of numbers, and the delimiter of its cells."""
    full = [i for i, line in enumerate(lines) if line.strip() and not _is_comment(line)]
    for start, after in zip(full[:HEADER], [*full[1:], None], strict=False):
        for delimiter in DELIMITERS:
            cells, below = (
                _cells(line if delimiter == "," else _DECIMAL.sub(".", line), delimiter)
                for line in (lines[start], lines[after] if after else "")
            )
            # a date above the table is numbers as well
            if _is_data(cells) and (len(below) == len(cells) or not after):
                return start, delimiter
    begins = " and ".join(quoted(lines[i].strip()) for i in full[:2])
    what = f"has no line of numbers (it begins {begins})" if full else "is empty"
    raise ParameterError(
        f"{path.name} {what}; expected rows such as 11607.70, 8503.6, 0.607 with tabs, commas, "
        f"semicolons or spaces between, a column each for time, displacement and friction"
    )


def _decimal_comma(lines, delimiter):
    """Whether numbers are written 0,5."""
    cells = [cell for line in lines for cell in _cells(line, delimiter)]
    commas = sum(bool(re.fullmatch(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?", cell)) for cell in cells)
    return commas > sum("." in cell for cell in cells)


def _width(lines, delimiter):
    """Number of columns: that of most rows."""
    counts = Counter(
        len(_cells(line, delimiter)) for line in lines if line.strip() and not _is_comment(line)
    )
    return counts.most_common(1)[0][0]


def _header(lines, delimiter, width, start):
    """(title, name, unit) of each column, from the lines above the numbers."""
    kept = [line for line in lines if line.strip(" \t\r" + "".join(COMMENTS))]
    heads = [_names(line, delimiter, width) for line in kept]
    if heads and heads[-1] is None and not _is_comment(kept[-1]):
        count = len(_header_cells(kept[-1], delimiter))
        raise ParameterError(
            f"the header {quoted(kept[-1].strip())} has {count} names for {width} columns (line "
            f"{start + 1} has {width} numbers); mend it, or leave it out and give columns by "
            f"number and units, such as columns={{'time': 1, 'delta_lp': 2, 'friction': 3}}, "
            f"units={{'time': 's', 'delta_lp': 'um'}}"
        )
    if not heads or heads[-1] is None:
        return [(f"column {i + 1}", "", "") for i in range(width)]
    names, below = heads[-1], None
    if len(heads) > 1 and heads[-2] is not None and _all_units(names):
        names, below = heads[-2], names
    names = [name or f"column {i + 1}" for i, name in enumerate(names)]
    columns = [(name, *split(name)) for name in names]
    if below is not None:
        columns = [(*own[:2], unit or own[2]) for unit, own in zip(below, columns, strict=True)]
    return columns


def _all_units(cells):
    """Whether a line has units in place of names."""
    return any(cells) and all(not plain(cell) or is_unit(cell) for cell in cells)


def _header_cells(line, delimiter):
    """The cells of a line of the header."""
    line = line.strip().lstrip("".join(COMMENTS)) if delimiter is None else line.strip(" \r")
    if delimiter is None:
        names: list[str] = []
        for word in line.split():  # "Time (s)" is one
            bracket = names and (word[0] in "([{" or names[-1].count("(") > names[-1].count(")"))
            if bracket:
                names[-1] += f" {word}"
            else:
                names.append(word)
        return names
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter), [])]


def _names(line, delimiter, width):
    """The names in a line above the numbers, or None if they are not as many as columns."""
    bare = line.strip(" \r").lstrip("".join(COMMENTS)).strip(" \r")
    ways = [_header_cells(bare, delimiter), re.split(r"\s{2,}|\t", bare), _header_cells(bare, ",")]
    ways += [_header_cells(bare, "\t"), bare.split()]
    for cells in ways:
        if len(cells) == width + 1 and not cells[-1]:
            cells = cells[:-1]
        if len(cells) == width and width > 1:
            return [cell.strip() for cell in cells]
    return None


def _values(rows, titles, width):
    """The numbers, NaN where there is none, and the cells that are none."""
    try:
        return np.array(rows, float).reshape(-1, width), {}
    except ValueError:
        pass
    values, odd = np.full((len(rows), width), np.nan), {}
    for i, row in enumerate(rows):
        for j, title in enumerate(titles):
            cell = row[j] if j < len(row) else ""
            # a row with a cell too many has them perhaps in other columns
            values[i, j] = _number(cell) if len(row) <= width else np.nan
            if not np.isfinite(values[i, j]):
                odd[i, title] = cell if len(row) <= width else f"{len(row)} cells"
    return values, odd
