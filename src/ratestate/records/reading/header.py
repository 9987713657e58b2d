"""Read the names and units of columns from the lines above the numbers."""

import contextlib
import csv
import math
import re
from typing import NamedTuple

import numpy as np

from ...errors import ParameterError
from ..messages import reading as sentences
from .cells import COMMENTS, is_comment, parse_number
from .columns import quoted
from .titles import (
    WORDS,
    is_recognized,
    is_unit,
    letters,
    name_and_units,
    plain_unit,
    spaced,
)

#: in files of xlook, the line below names and units: the number of records of each column
_RECORDS = re.compile(r"\s*(?:\d+\s*recs?\s*)+", re.IGNORECASE)
#: first line of LabVIEW files, and the line that ends each of the two parts of their headers
LABVIEW, LABVIEW_END = "LabVIEW Measurement", "***End_of_Header***"


class Header(NamedTuple):
    """The header above the numbers."""

    names: list[str]  # of the columns, "" if missing
    units: list[str]  # of the columns, "" if missing
    times: tuple[float, float] | None = None  # first time and time step [s], if not a column
    lines: tuple[str, ...] = ()  # the lines as written

    def split_units(self):
        """Return the name, unit and contradicting unit of each column (list of tuples)."""
        return [name_and_units(*pair) for pair in zip(self.names, self.units, strict=True)]

    def normalized(self):
        """Return `split_units` without differences of spelling."""
        return [
            (letters(name), plain_unit(unit), plain_unit(other))
            for name, unit, other in self.split_units()
        ]


def parse_header(lines, delimiter, width, written=None):
    """Return the `Header` of `width` columns, from the last two lines above the numbers.

    written : number of cells in a row, including cells at its end that are always empty

    ParameterError if the last line is not a comment and has another number of names.
    """
    if lines and lines[0].startswith(LABVIEW):
        return _parse_labview(lines, width)
    kept = [line for line in lines if line.strip(" \t\n" + COMMENTS)]
    records = next((line for line in kept if _RECORDS.fullmatch(line)), None)
    kept = [line for line in kept if not _RECORDS.fullmatch(line)][-2:]
    if records is None:
        name_rows = [_split_names(line, delimiter, width, written) for line in kept]
    else:
        name_rows = _xlook_names(kept, records, width)
    above, names = [None, None, *name_rows][-2:]
    blank = [""] * width
    if names is None:
        if kept and not is_comment(kept[-1]):
            values = {"header": quoted(kept[-1].strip()), "width": width, "line": len(lines) + 1}
            count = len(_split_line(kept[-1].strip(" \n"), delimiter))
            raise sentences.refusal("text.header", count=count, **values)
        return Header(blank, blank)
    texts = tuple(line.strip() for line in kept)
    if above and any(names) and all(not plain_unit(name) or is_unit(name) for name in names):
        return Header(above, names, lines=texts)
    return Header(names, blank, lines=texts)


def check_headers(lines, rows, layout, above, header, name):
    """Raise ParameterError if a block of lines has a header that differs from the first one.

    rows, layout : indices of lines with numbers, and their `Layout`
    above : number of lines above the block
    header, name : the first header, and the name of the file
    """
    texts = np.ones(len(lines), bool)
    texts[rows] = False
    for i in np.flatnonzero(texts).tolist() if rows.size else []:
        line = lines[i].strip()
        if not line or line in header.lines or not _is_header(line, layout, header.names):
            continue
        other = None
        with contextlib.suppress(ParameterError):
            other = parse_header([line], layout.delimiter, layout.width).normalized()
        if other != header.normalized():
            values = {"line": above + i + 1, "text": quoted(line)}
            raise sentences.refusal("text.second_header", name=name, **values)


def _is_header(line, layout, first):
    """Return whether a line has at least two names or units, known or from the first header."""
    splits = [_split_names(line, layout.delimiter, layout.width) or []]
    for names in splits if is_comment(line) else [*splits, _split_line(line, layout.delimiter)]:
        numbers = any(not math.isnan(parse_number(name)) for name in names)
        if not numbers and sum(name in first or is_recognized(name) for name in names if name) > 1:
            return True
    return False


def labview_header_end(lines):
    """Return the number of header lines above LabVIEW's line of names; 0 for other files."""
    if not lines or not lines[0].startswith(LABVIEW):
        return 0
    ends = [i for i, line in enumerate(lines) if line.startswith(LABVIEW_END)][:2]
    return ends[-1] + 1 if ends else 0


def _parse_labview(lines, width):
    """Return the `Header` of a LabVIEW file (.lvm): lines of a key and a value per channel."""
    delimiter = "\t" if "\t" in "".join(lines) else ","
    rows = [[cell.strip() for cell in line.split(delimiter)] for line in lines if line.strip()]
    keys = {row[0]: [cell for cell in row[1:] if cell] for row in rows}
    names = [*rows[-1], *[""] * width][:width]
    units = ["s", *keys.get("Y_Unit_Label", []), *[""] * width][:width]
    if keys.get("X_Columns") != ["No"]:
        return Header(names, units)
    first, step = (parse_number(keys[key][0].replace(",", ".")) for key in ("X0", "Delta_X"))
    return Header(names, units, (first, step))


def _xlook_names(lines, records, width):
    """Return the names in each line of xlook's header.

    The names have one width, end at the right margin, and may touch.  The first column, with row
    numbers, has no name.
    """
    ends = [match.end() for match in re.finditer(r"\d+\s*recs?", records, re.IGNORECASE)]
    if len(ends) not in (width - 1, width):
        return [None for _ in lines]
    column_width = int(max(np.diff(ends), default=ends[0]))
    last = max(len(line.rstrip()) for line in lines)
    starts = [max(0, last - column_width * i) for i in range(len(ends), 0, -1)]
    unnamed = [""] * (width - len(ends))
    return [unnamed + [line[i : i + column_width].strip() for i in starts] for line in lines]


def _split_names(line, delimiter, width, written=None):
    """Return the names in a line above the numbers; None unless there is one for each column."""
    line = line.strip(" \n").lstrip(COMMENTS).strip(" ")
    splits = [_split_line(line, delimiter), re.split(r"\s{2,}|\t", line)]
    splits += [_split_line(line, ","), _split_line(line, "\t"), line.split()]
    for cells in splits:
        if len(cells) == written:
            cells = cells[:width]
        # there may be a column of remarks that is empty in most rows
        if len(cells) == width + 1 and (not cells[-1] or WORDS["remark"].search(spaced(cells[-1]))):
            cells = cells[:-1]
        if len(cells) == width > 1:
            return [cell.strip() for cell in cells]
    return None


def _split_line(line, delimiter):
    if delimiter is not None:
        return next(csv.reader([line], delimiter=delimiter), [])
    names: list[str] = []
    for word in line.split():  # "Time (s)" is one name
        if names and (word[0] in "([{" or names[-1].count("(") > names[-1].count(")")):
            names[-1] += f" {word}"
        else:
            names.append(word)
    return names
