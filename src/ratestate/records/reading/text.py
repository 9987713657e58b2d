"""Tables of text: tabs, commas, semicolons or spaces between cells; in blocks of lines.

NumPy's `loadtxt` reads the numbers, rounded as Python does.  pandas' parser would read a clean file
faster, but keeps no lines: remarks, other headers and messages need them.
"""

import codecs
import contextlib
import io
import itertools
import re
from collections import Counter

import numpy as np

from ..messages import reading as sentences
from .cells import (
    DATE,
    LIKE_CLOCK,
    Layout,
    cells_of,
    clock_of,
    is_full,
    number_in,
    rows_in,
    trimmed,
)
from .columns import Column, Table, quoted
from .header import check_headers, end_of_labview, header_of
from .titles import TABLE, match_rank

DELIMITERS = ("\t", ";", ",", None)  # None: spaces, as many as there are
LOOK = 200  # lines from which the layout is found
LARGEST = 10**9  # bytes; a number of ten characters takes eight of memory
LONGEST = 20_000  # characters of a line
MOST_ABOVE = 2_000  # lines above the numbers
BLOCK = 1 << 20  # characters read at once
BYTES = 1 << 24  # read at once to find the encoding
HEAD = 1 << 16  # bytes in which words are looked for
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
    encoding, most = _examined(path)
    with path.open("rb") as binary, io.TextIOWrapper(binary, encoding) as file:
        blocks = _blocks(file, path.name)
        head: list[str] = []  # in which the layout is found
        while len(head) < MOST_ABOVE + LOOK and (lines := next(blocks, None)):
            head += lines
        above = end_of_labview(head)
        full = [i for i, line in enumerate(head) if is_full(line) and i >= above]
        start, delimiter = _first_row(path, head, full, delimiters)
        rows = [i for i in full[full.index(start) :] if i < start + LOOK]
        look = [cells_of(head[i], delimiter) for i in rows]
        written = Counter(map(len, look)).most_common(1)[0][0]
        whole = [trimmed(cells) for cells in look if len(cells) == written]
        width = max(map(len, whole))
        header = header_of(head[:start], delimiter, width, written)
        decimal = _decimal(path, whole) if decimal is None else decimal
        layout = Layout(delimiter, decimal, width, _clocks(whole, header))
        blocks = itertools.chain([head[start:]], blocks)
        values, numbers = _numbers(blocks, layout, start, most, header, path.name)
    if header.times:
        values[0] = header.times[0] + header.times[1] * np.arange(numbers.size)
    columns = []
    for j, (name, unit, other) in enumerate(header.described()):
        column = values[j]
        if clock := layout.clocks.get(j):
            column, unit, other = clock.continuous(column), "s", ""
            # a column of seconds beside it is finer, or as fine
            name = CLOCK_TIME if match_rank(name, "time") is not None else name
        title = header.names[j] or f"column {j + 1}"
        columns.append(Column(title, name, unit, column, other))

    def text_of(number, place):
        with path.open("rb") as binary, io.TextIOWrapper(binary, encoding) as file:
            line = next(itertools.islice(file, number - 1, None))
        cells = trimmed(cells_of(line, delimiter), width)
        return f"{len(cells)} cells" if len(cells) > width else "".join(cells[place : place + 1])

    return Table(columns, numbers, text_of=text_of, name=path.name)


def _examined(path):
    """(encoding, most lines) of a text file; ParameterError if it is binary.

    UTF-16 by its first bytes, and UTF-8 if it is; else, if words of titles appear in it, an
    encoding of Japanese or Chinese; else the encoding of Windows in western Europe.
    """
    with path.open("rb") as file:
        head = file.read(HEAD)
    utf_16 = head.startswith((b"\xff\xfe", b"\xfe\xff"))
    ends = 0
    for block in _bytes(path):
        if b"\0" in block and not utf_16:
            raise sentences.refusal("text.binary", name=path.name)
        ends += block.count(b"\n") + block.count(b"\r")
    eastern = [
        encoding
        for encoding, words in TABLE["encodings"].items()
        if any(word in head.decode(encoding, "ignore") for word in words)
    ]
    for encoding in ["utf-16"] if utf_16 else ["utf-8-sig", *eastern, "cp1252", "latin-1"]:
        with contextlib.suppress(UnicodeDecodeError):
            for _ in codecs.iterdecode(_bytes(path), encoding):
                pass
            return encoding, ends + 1
    raise sentences.refusal("text.encoding", name=path.name)


def _bytes(path):
    with path.open("rb") as file:
        while block := file.read(BYTES):
            yield block


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
        for number, line in enumerate(lines if max(map(len, lines)) > LONGEST else [], before + 1):
            if (length := len(line.rstrip("\n"))) > LONGEST:  # would take for ever
                values = {"line": number, "length": length, "most": LONGEST}
                raise sentences.refusal("text.long", name=name, **values)
        before += len(lines)
        text = "".join(lines)
        yield lines if text.isascii() and "'" not in text else [_as_typed(line) for line in lines]


def _as_typed(line):
    """A line whose numbers have the signs of a keyboard, and nothing between groups of digits."""
    for pattern, typed in _PRINTED:
        line = pattern.sub(typed, line)
    return line


def _numbers(blocks, layout, start, most, header, name):
    """(columns, rows) numbers in blocks of lines, and the line of each row, from 1 on.

    start : lines above the first block
    most : lines there can be
    header, name : the `Header`, and of which file

    ParameterError: another header among the rows.
    """
    values = np.empty((layout.width, most))  # takes memory only where it is filled
    numbers = np.empty(most, np.int32)
    count = 0
    for lines in blocks:
        found, places = rows_in(lines, layout)
        check_headers(lines, places[np.isfinite(found).any(axis=1)], layout, start, header, name)
        here = slice(count, count + places.size)
        values[:, here], numbers[here] = found.T, places + (start + 1)
        start += len(lines)
        count += places.size
    return values[:, :count], numbers[:count]


def _is_data(cells, dense=True):
    """Whether these look like a row of a record: two cells or more, hardly one without a number.

    Dates and clock times do not count.

    dense : whether empty cells count as being without a number
    """
    good = [cell for cell in cells if cell.lower() == "nan" or _is_number(cell)]
    several = any(
        re.search(r"\d\s+[-+.\d]", cell) and not (LIKE_CLOCK.search(cell) or _is_number(cell))
        for cell in cells
    )
    filled = trimmed(cells) if dense else [cell for cell in cells if cell]
    filled = [cell for cell in filled if not (LIKE_CLOCK.search(cell) or DATE.fullmatch(cell))]
    return len(good) >= 2 and 2 * len(good) > len(filled) and not several


def _is_number(cell):
    return any(not np.isnan(number_in(cell, mark)) for mark in ".,")


def _first_row(path, lines, full, delimiters):
    """Index of the first line of numbers, and the delimiter of its cells."""
    for start, after in itertools.pairwise(full[: MOST_ABOVE + 1]):
        for delimiter in delimiters:
            both = [cells_of(lines[i], delimiter) for i in (start, after)]
            sparse = all(_is_data(cells, dense=False) for cells in both)
            # a date above the table is numbers as well
            if (_is_data(both[0]) or sparse) and len(both[0]) == len(both[1]):
                return start, delimiter
    begins = " and ".join(quoted(lines[i].strip()) for i in full[:2])
    raise sentences.refusal(
        "text.no_numbers" if full else "text.empty", name=path.name, begins=begins
    )


def _decimal(path, rows):
    """The decimal mark of numbers in these rows, "." or ","; ParameterError if either may be."""
    cells = [cell for row in rows for cell in row if "," in cell or "." in cell]
    marks = [[mark for mark in ".," if not np.isnan(number_in(cell, mark))] for cell in cells]
    certain = Counter(found[0] for found in marks if len(found) == 1)
    if certain:
        return certain.most_common(1)[0][0]
    grouped = [cell for cell, found in zip(cells, marks, strict=True) if found and "," in cell]
    if grouped and not any("." in cell for cell in cells):
        raise sentences.refusal("text.decimal", name=path.name, cell=quoted(grouped[0]))
    return "."
