"""Rows of a text file with cells separated by commas, semicolons or tabs."""

import csv
import io
import math
from pathlib import Path
from typing import Any

from .problems import message, refusal

ENDINGS = (".csv", ".tsv", ".txt")
LARGEST = 100 * 10**6  # bytes
LONGEST = 10**6  # rows


def rows_of(file: Any, folder: Path) -> list[tuple[int, list[str]]]:
    """The rows of a file that are not empty, each with the number of its line."""
    wanted = message("record.wanted", endings=", ".join(ENDINGS))
    if not isinstance(file, str) or not file.isprintable() or len(file) > 1000:
        raise refusal("record.no_name", file, wanted=wanted)
    path = folder / file
    if path.suffix.lower() not in ENDINGS:
        raise refusal("record.ending", file, wanted=wanted)
    try:
        if not path.is_file():
            raise refusal("record.missing", str(path), wanted=wanted)
        if (size := path.stat().st_size) > LARGEST:
            raise refusal("record.too_large", file, size=size, most=LARGEST)
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise refusal("record.unreadable", file, what=error.strerror, wanted=wanted) from None
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise refusal("record.not_utf8", file, line=line) from None
    first = text[:10000].lstrip().split("\n", 1)[0]
    delimiter = next((mark for mark in "\t;" if mark in first), ",")
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    rows = []
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                rows.append((reader.line_num, [cell.strip() for cell in row]))
            if len(rows) > LONGEST + 1:
                raise refusal("record.too_many_rows", file, most=LONGEST)
    except csv.Error as error:
        raise refusal("record.bad_row", file, line=reader.line_num, what=error) from None
    if not rows:
        raise refusal("record.empty", file)
    return rows


def number_in(cell: str) -> float:
    """A finite number, or NaN."""
    try:
        x = float(cell)
    except ValueError:
        return math.nan
    return x if math.isfinite(x) else math.nan
