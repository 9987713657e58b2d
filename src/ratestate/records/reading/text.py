"""Read tables of text in blocks of lines; tabs, commas, semicolons or spaces separate cells.

NumPy's `loadtxt` parses the numbers and rounds them as Python does.  pandas' parser would read a
clean file faster, but it does not keep the lines, which comments, further headers and messages
need.
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
    detect_clock,
    drop_empty_end,
    has_content,
    parse_number,
    parse_rows,
    split_cells,
)
from .columns import Column, Table, quoted
from .header import check_headers, labview_header_end, parse_header
from .titles import TABLE, match_rank

DELIMITERS = ("\t", ";", ",", None)  # None: any number of spaces
LAYOUT_LINES = 200  # lines from which the layout is detected
MAX_BYTES = 10**9  # a number of ten characters takes eight bytes of memory
MAX_LINE = 20_000  # characters in a line
MAX_HEADER_LINES = 2_000  # lines above the numbers
BLOCK = 1 << 20  # characters read at once
ENCODING_BLOCK = 1 << 24  # bytes read at once to detect the encoding
ENCODING_HEAD = 1 << 16  # bytes in which Japanese and Chinese words are searched
CLOCK_NAME = "clock time"  # a name of times that ranks below names of seconds
#: typographic minus signs, and separators between groups of digits -> their replacement
_TYPOGRAPHIC = [
    (re.compile(r"(?:[\u2212\ufe63\uff0d]|(?<![^\s;,])\u2013)(?=[\d.,])"), "-"),
    (re.compile(r"(?<=\d)['\u2019\u00a0\u202f\u2009\u2007](?=\d{3}(?!\d))"), ""),
]


def read_text(path, delimiters=DELIMITERS, decimal=None):
    """Return the `Table` in a text file.

    delimiters : delimiters to try
    decimal : "." or ","; None: detected from the numbers

    ParameterError if the file is too large or binary, if a line is too long, if there are no rows
    of numbers, or if the header above them has another number of names.
    """
    if (size := path.stat().st_size) > MAX_BYTES:
        raise sentences.refusal("text.large", name=path.name, size=size / 1e9, most=MAX_BYTES / 1e9)
    encoding, most = _detect_encoding(path)
    with path.open("rb") as binary, io.TextIOWrapper(binary, encoding) as file:
        blocks = _line_blocks(file, path.name)
        head: list[str] = []  # the layout is detected from these lines
        while len(head) < MAX_HEADER_LINES + LAYOUT_LINES and (lines := next(blocks, None)):
            head += lines
        above = labview_header_end(head)
        filled = [i for i, line in enumerate(head) if has_content(line) and i >= above]
        start, delimiter = _find_first_row(path, head, filled, delimiters)
        rows = [i for i in filled[filled.index(start) :] if i < start + LAYOUT_LINES]
        samples = [split_cells(head[i], delimiter) for i in rows]
        written = Counter(map(len, samples)).most_common(1)[0][0]
        complete = [drop_empty_end(cells) for cells in samples if len(cells) == written]
        width = max(map(len, complete))
        header = parse_header(head[:start], delimiter, width, written)
        decimal = _decimal_mark(path, complete) if decimal is None else decimal
        layout = Layout(delimiter, decimal, width, _detect_clocks(complete, header))
        blocks = itertools.chain([head[start:]], blocks)
        values, numbers = _parse_blocks(blocks, layout, start, most, header, path.name)
    if header.times:
        values[0] = header.times[0] + header.times[1] * np.arange(numbers.size)
    columns = []
    for j, (name, unit, other) in enumerate(header.split_units()):
        column = values[j]
        if clock := layout.clocks.get(j):
            column, unit, other = clock.continuous(column), "s", ""
            # a column of seconds beside it is preferred: its resolution is at least as fine
            name = CLOCK_NAME if match_rank(name, "time") is not None else name
        title = header.names[j] or f"column {j + 1}"
        columns.append(Column(title, name, unit, column, other))

    def cell_text(number, place):
        with path.open("rb") as binary, io.TextIOWrapper(binary, encoding) as file:
            line = next(itertools.islice(file, number - 1, None))
        cells = drop_empty_end(split_cells(line, delimiter), width)
        return f"{len(cells)} cells" if len(cells) > width else "".join(cells[place : place + 1])

    return Table(columns, numbers, cell_text=cell_text, name=path.name)


def _detect_encoding(path):
    """Return (encoding, upper bound of lines) of a text file; ParameterError if it is binary.

    The first bytes mark UTF-16.  Otherwise the first encoding that decodes the whole file counts:
    UTF-8, an encoding of Japanese or Chinese if words of titles appear in it, or the encoding of
    Windows in western Europe.
    """
    with path.open("rb") as file:
        head = file.read(ENCODING_HEAD)
    utf_16 = head.startswith((b"\xff\xfe", b"\xfe\xff"))
    ends = 0
    for block in _byte_blocks(path):
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
            for _ in codecs.iterdecode(_byte_blocks(path), encoding):
                pass
            return encoding, ends + 1
    raise sentences.refusal("text.encoding", name=path.name)


def _byte_blocks(path):
    with path.open("rb") as file:
        while block := file.read(ENCODING_BLOCK):
            yield block


def _detect_clocks(rows, header):
    """Return column -> `Clock` of the first clock time in these rows of cells."""
    clocks = {}
    for j, (_, unit, _) in enumerate(header.split_units()):
        detected = (detect_clock(row[j], unit) for row in rows if len(row) > j)
        if clock := next((known for known in detected if known is not None), None):
            clocks[j] = clock
    return clocks


def _line_blocks(file, name):
    before = 0
    while lines := file.readlines(BLOCK):
        for number, line in enumerate(lines if max(map(len, lines)) > MAX_LINE else [], before + 1):
            if (length := len(line.rstrip("\n"))) > MAX_LINE:  # parsing it would take too long
                values = {"line": number, "length": length, "most": MAX_LINE}
                raise sentences.refusal("text.long", name=name, **values)
        before += len(lines)
        text = "".join(lines)
        if not text.isascii() or "'" in text:
            for pattern, replacement in _TYPOGRAPHIC:
                text = pattern.sub(replacement, text)
            lines = io.StringIO(text).readlines()
        yield lines


def _parse_blocks(blocks, layout, start, most, header, name):
    """Return the numbers (columns, rows) in blocks of lines, and each row's line number from 1.

    start : number of lines above the first block
    most : upper bound of the number of lines
    header, name : the `Header`, and the name of the file

    ParameterError if there is another header among the rows.
    """
    values = np.empty((layout.width, most))  # unused elements take no memory
    numbers = np.empty(most, np.int32)
    count = 0
    for lines in blocks:
        parsed, indices = parse_rows(lines, layout)
        check_headers(lines, indices[np.isfinite(parsed).any(axis=1)], layout, start, header, name)
        columns = slice(count, count + indices.size)
        values[:, columns], numbers[columns] = parsed.T, indices + (start + 1)
        start += len(lines)
        count += indices.size
    return values[:, :count], numbers[:count]


def _is_data_row(cells, dense=True):
    """Return whether the cells look like a row of a record: at least two, most with numbers.

    Dates and clock times are ignored.

    dense : whether empty cells count as cells without a number
    """
    good = [cell for cell in cells if cell.lower() == "nan" or _is_number(cell)]
    several = any(
        re.search(r"\d\s+[-+.\d]", cell) and not (LIKE_CLOCK.search(cell) or _is_number(cell))
        for cell in cells
    )
    filled = drop_empty_end(cells) if dense else [cell for cell in cells if cell]
    filled = [cell for cell in filled if not (LIKE_CLOCK.search(cell) or DATE.fullmatch(cell))]
    return len(good) >= 2 and 2 * len(good) > len(filled) and not several


def _is_number(cell):
    return any(not np.isnan(parse_number(cell, mark)) for mark in ".,")


def _find_first_row(path, lines, filled, delimiters):
    """Return the index of the first line of numbers, and the delimiter of its cells."""
    for start, after in itertools.pairwise(filled[: MAX_HEADER_LINES + 1]):
        for delimiter in delimiters:
            pair = [split_cells(lines[i], delimiter) for i in (start, after)]
            sparse = all(_is_data_row(cells, dense=False) for cells in pair)
            # the next line must have as many cells: a date above the table is numbers as well
            if (_is_data_row(pair[0]) or sparse) and len(pair[0]) == len(pair[1]):
                return start, delimiter
    rows = [i for i in filled if any(_is_data_row(split_cells(lines[i], x)) for x in delimiters)]
    if len(rows) == 1:
        raise sentences.refusal("text.one_row", name=path.name)
    begins = " and ".join(quoted(lines[i].strip()) for i in filled[:2])
    sentence = "text.no_numbers" if filled else "text.empty"
    raise sentences.refusal(sentence, name=path.name, begins=begins)


def _decimal_mark(path, rows):
    """Return the decimal mark of numbers in these rows; ParameterError if it is ambiguous."""
    cells = [cell for row in rows for cell in row if "," in cell or "." in cell]
    marks = [[mark for mark in ".," if not np.isnan(parse_number(cell, mark))] for cell in cells]
    counts = Counter(possible[0] for possible in marks if len(possible) == 1)
    if counts:
        return counts.most_common(1)[0][0]
    pairs = zip(cells, marks, strict=True)
    grouped = [cell for cell, possible in pairs if possible and "," in cell]
    if grouped and not any("." in cell for cell in cells):
        raise sentences.refusal("text.decimal", name=path.name, cell=quoted(grouped[0]))
    return "."
