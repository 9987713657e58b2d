"""Tables of text: tabs, commas, semicolons or spaces between cells; in blocks of lines.

NumPy's `loadtxt` reads the numbers, each as Python would: pandas rounds some of them otherwise.
"""

import io
import itertools
import re
from collections import Counter

import numpy as np

from ..messages import reading as sentences
from .cells import ODD, Layout, cells_of, is_full, number_in, rows_in, trimmed
from .clock import DATE, clock_of, continuous
from .encodings import examined
from .header import check_headers, end_of_labview, header_of
from .sizes import CLOCK
from .table import Column, Table, quoted
from .titles import match_rank

DELIMITERS = ("\t", ";", ",", None)  # None: spaces, as many as there are
LOOK = 200  # lines from which the layout is found
LARGEST = 10**9  # bytes; a number of ten characters takes eight of memory
LONGEST = 20_000  # characters of a line
MOST_ABOVE = 2_000  # lines above the numbers
BLOCK = 1 << 22  # characters read at once
NEEDED = 3  # columns of a record: time, displacement and friction
FEWEST = 10  # whole rows beside short ones
CLOCK_TIME = "clock time"  # a name of times that ranks below names of seconds
#: minus signs and blanks that numbers are printed with -> what they mean
_PRINTED = [
    (re.compile(r"(?:[\u2212\ufe63\uff0d]|(?<![^\s;,])\u2013)(?=[\d.,])"), "-"),
    (re.compile(r"(?<=\d)['\u2019\u00a0\u202f\u2009\u2007](?=\d{3}(?!\d))"), ""),
]


def read_text(path, delimiters=DELIMITERS, decimal=None):
    """The `Table` in a text file.

    delimiters : one of which is between the cells
    decimal : "." or ","; None: as the numbers look

    ParameterError: too large, binary, a line too long, no rows of numbers, or above them a header
    of another number of names.
    """
    if (size := path.stat().st_size) > LARGEST:
        raise sentences.refusal("text.large", name=path.name, size=size / 1e9, most=LARGEST / 1e9)
    encoding, most = examined(path)
    with path.open("rb") as binary, io.TextIOWrapper(binary, encoding) as file:
        blocks = _blocks(file, path.name)
        head = _head(blocks)
        above = end_of_labview(head)
        full = [i for i, line in enumerate(head) if is_full(line) and i >= above]
        start, delimiter = _layout(path, head, full, delimiters)
        rows = [i for i in full[full.index(start) :] if i < start + LOOK]
        look = [cells_of(head[i].rstrip("\n"), delimiter) for i in rows]
        written = Counter(map(len, look)).most_common(1)[0][0]
        whole = [trimmed(cells) for cells in look if len(cells) == written]
        width = max(map(len, whole))
        header = header_of(head[:start], delimiter, width, written)
        titles = [name or f"column {i}" for i, name in enumerate(header.names, 1)]
        decimal = _decimal(path, whole, delimiter) if decimal is None else decimal
        clocks = _clocks(whole, header)
        layout = Layout(delimiter, decimal, titles, clocks)
        blocks = itertools.chain([head[start:]], blocks)
        values, odd, numbers = _numbers(blocks, layout, start, most, header, path.name)
    if header.times:
        values[0] = header.times[0] + header.times[1] * np.arange(numbers.size)
    columns = []
    for j, (name, unit, other) in enumerate(header.described()):
        column = values[j]
        if j in clocks:
            column, unit, other = continuous(column, clocks[j]), "s", ""
            # a column of seconds beside it is finer, or as fine
            name = CLOCK_TIME if match_rank(name, "time") is not None else name
        columns.append(Column(titles[j], name, unit, column, other))
    return Table(columns, "line", odd, numbers)


def _clocks(rows, header):
    """Column -> `Clock` of the first clock time in these rows of cells."""
    clocks = {}
    for j, (_, unit, _) in enumerate(header.described()):
        found = (clock_of(row[j], unit) for row in rows if len(row) > j)
        if clock := next((one for one in found if one is not None), None):
            clocks[j] = clock
    return clocks


def _blocks(file, name):
    """Lists of lines, one after the other; ParameterError for a line that is too long."""
    before = 0
    while lines := file.readlines(BLOCK):
        lengths = [len(line.rstrip("\n")) for line in lines if len(line) > LONGEST]
        if lengths and max(lengths) > LONGEST:  # would take for ever
            line = next(i for i, line in enumerate(lines, 1) if len(line.rstrip("\n")) > LONGEST)
            values = {"line": before + line, "length": len(lines[line - 1].rstrip("\n"))}
            raise sentences.refusal("text.long", name=name, most=LONGEST, **values)
        before += len(lines)
        yield (
            lines
            if all(map(str.isascii, lines)) and "'" not in "".join(lines)
            else [_as_typed(line) for line in lines]
        )


def _as_typed(line):
    """A line whose numbers have the signs of a keyboard, and nothing between groups of digits."""
    for pattern, typed in _PRINTED:
        line = pattern.sub(typed, line)
    return line


def _head(blocks):
    """The first lines, in which the layout is found: whole blocks."""
    head: list[str] = []
    full = 0
    for lines in blocks:
        head += lines
        full += sum(map(is_full, lines))
        if full > MOST_ABOVE + LOOK:
            break
    return head


def _numbers(blocks, layout, start, most, header, name):
    """(columns, rows) numbers, cells that are none, and the lines of rows, as an editor counts.

    start : lines above the first block
    most : lines there can be
    header, name : the `Header`, and of which file

    ParameterError: another header among the rows.
    """
    values = np.empty((len(layout.titles), most))  # takes memory only where it is filled
    numbers = np.empty(most, np.int32)
    odd: dict[tuple[int, str], str] = {}
    count = 0
    for lines in blocks:
        rows = rows_in(lines, layout, ODD - len(odd))
        check_headers(lines, rows, layout, start, header, name)
        here = slice(count, count + rows.lines.size)
        values[:, here] = rows.values.T
        numbers[here] = rows.lines + (start + 1)
        odd |= {(count + row, title): cell for (row, title), cell in rows.odd.items()}
        start += len(lines)
        count += rows.lines.size
    return values[:, :count], odd, numbers[:count]


def _is_data(cells, dense=True):
    """Whether these look like a row of a record: two cells or more, hardly one without a number.

    Dates and clock times do not count.

    dense : whether empty cells count as being without a number
    """
    good = [cell for cell in cells if cell.lower() == "nan" or _is_number(cell)]
    several = any(
        re.search(r"\d\s+[-+.\d]", cell) and not (CLOCK.search(cell) or _is_number(cell))
        for cell in cells
    )
    filled = trimmed(cells) if dense else [cell for cell in cells if cell]
    filled = [cell for cell in filled if not (CLOCK.search(cell) or DATE.fullmatch(cell))]
    return len(good) >= 2 and 2 * len(good) > len(filled) and not several


def _is_number(cell):
    """Whether a cell is a number with either decimal mark."""
    return any(not np.isnan(number_in(cell, mark)) for mark in ".,")


def _layout(path, lines, full, delimiters):
    """Index of the first line of numbers, and the delimiter of its cells."""
    for start, after in zip(full[:MOST_ABOVE], [*full[1:], None], strict=False):
        for delimiter in delimiters:
            cells, below = (
                cells_of(line, delimiter)
                for line in (lines[start].rstrip("\n"), lines[after].rstrip("\n") if after else "")
            )
            sparse = _is_data(cells, dense=False) and _is_data(below, dense=False)
            # a date above the table is numbers as well
            if (_is_data(cells) or sparse) and (len(below) == len(cells) or not after):
                if not after:
                    _check_short_rows(path, lines, full, delimiters)
                return start, delimiter
    if full:
        _check_short_rows(path, lines, full, delimiters)
    begins = " and ".join(quoted(lines[i].strip()) for i in full[:2])
    raise sentences.refusal(
        "text.no_numbers" if full else "text.empty", name=path.name, begins=begins
    )


def _check_short_rows(path, lines, full, delimiters):
    """Refuse rows of numbers of which so many are short that no two whole ones are together."""
    for delimiter in delimiters:
        rows = {i: cells_of(lines[i].rstrip("\n"), delimiter) for i in full}
        rows = {i: cells for i, cells in rows.items() if _is_data(cells)}
        width = max(map(len, rows.values()), default=0)
        short = [i for i, cells in rows.items() if len(cells) < width]
        if short and width >= NEEDED and len(rows) - len(short) >= FEWEST:
            first = {"line": f"line {short[0] + 1}", "cells": quoted(lines[short[0]].strip())}
            counts = {"short": len(short), "rows": len(rows), "width": width}
            raise sentences.refusal("text.short_rows", name=path.name, **first, **counts)


def _decimal(path, rows, delimiter):
    """The decimal mark of numbers in these rows, "." or ","; ParameterError if either may be."""
    cells = [cell for row in rows for cell in row if "," in cell or "." in cell]
    marks = Counter(mark for cell in cells if (mark := _decimal_of(cell)))
    if marks:
        return marks.most_common(1)[0][0]
    grouped = [cell for cell in cells if "," in cell and _is_number(cell)]
    if grouped and not any("." in cell for cell in cells):
        raise sentences.refusal("text.decimal", name=path.name, cell=quoted(grouped[0]))
    return "."


def _decimal_of(cell):
    """The decimal mark that a cell proves; "" if it has none, or groups of digits perhaps."""
    marks = [mark for mark in ".," if not np.isnan(number_in(cell, mark))]
    sure = len(marks) == 1 and marks[0] in cell
    if sure or not marks:
        return marks[0] if sure else ""
    return {".": ",", ",": "."}[marks[0]] if len(marks) == 1 else ""
