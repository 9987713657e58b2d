"""Rows of a text file with cells separated by commas, semicolons or tabs."""

import csv
import io
import math
from pathlib import Path
from typing import Any

from ...errors import ParameterError
from .problems import shown

ENDINGS = (".csv", ".tsv", ".txt")
LARGEST = 100 * 10**6  # bytes
LONGEST = 10**6  # rows


def rows_of(file: Any, folder: Path) -> list[tuple[int, list[str]]]:
    """The rows of a file that are not empty, each with the number of its line."""
    wanted = f"expected a table of text with the ending {', '.join(ENDINGS)}, such as 'record.csv'"
    if not isinstance(file, str) or not file.isprintable() or len(file) > 1000:
        raise ParameterError(f"{shown(file)} is no file's name, {wanted}")
    path = folder / file
    if path.suffix.lower() not in ENDINGS:
        raise ParameterError(f"{shown(file)} ends otherwise, {wanted}")
    try:
        if not path.is_file():
            raise ParameterError(f"{shown(str(path))} does not exist, {wanted}")
        if (size := path.stat().st_size) > LARGEST:
            raise ParameterError(
                f"{shown(file)} has {size} bytes, expected {LARGEST} at most, "
                f"such as every tenth row has"
            )
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise ParameterError(f"{shown(file)} cannot be read: {error.strerror}, {wanted}") from None
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise ParameterError(
            f"{shown(file)}, line {line} is not UTF-8, expected text so saved such as 0.5,100"
        ) from None
    first = text[:10000].lstrip().split("\n", 1)[0]
    delimiter = next((mark for mark in "\t;" if mark in first), ",")
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    rows = []
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                rows.append((reader.line_num, [cell.strip() for cell in row]))
            if len(rows) > LONGEST + 1:
                raise ParameterError(
                    f"{shown(file)} has too many rows, expected {LONGEST} at most, "
                    f"such as every tenth"
                )
    except csv.Error as error:
        raise ParameterError(
            f"{shown(file)}, line {reader.line_num}: {error}, expected cells such as 0.5,100"
        ) from None
    if not rows:
        raise ParameterError(
            f"{shown(file)} is empty, expected rows of times and speeds such as 0.5,100"
        )
    return rows


def number_in(cell: str) -> float:
    """A finite number, or NaN."""
    try:
        x = float(cell)
    except ValueError:
        return math.nan
    return x if math.isfinite(x) else math.nan
