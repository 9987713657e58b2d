"""Names and units of columns out of the lines above the numbers."""

import csv
import re

from .cells import COMMENTS, is_comment
from .messages import refusal
from .table import quoted
from .titles import is_unit, plain

#: a line of xlook below names and units: how many records each column has
_RECORDS = re.compile(r"\s*(?:\d+\s*recs?\s*)+", re.IGNORECASE)


def header_of(lines, delimiter, width):
    """Names and units of the columns (lists), "" for none, from the last two lines of the header.

    ParameterError: the last is no remark, and has another number of names.
    """
    kept = [line for line in lines if line.strip(" \t\n" + COMMENTS)]
    # in files of xlook the first column, numbers of rows, has no name
    unnamed = any(_RECORDS.fullmatch(line) for line in kept)
    kept = [line for line in kept if not _RECORDS.fullmatch(line)][-2:]
    of_lines = [_names(line, delimiter, width, unnamed) for line in kept]
    above, names = [None, None, *of_lines][-2:]
    nothing = [""] * width
    if names is None:
        if kept and not is_comment(kept[-1]):
            values = {"header": quoted(kept[-1].strip()), "width": width, "line": len(lines) + 1}
            count = len(_cells(kept[-1].strip(" \n"), delimiter))
            raise refusal("text.header", count=count, **values)
        return nothing, nothing
    if above and any(names) and all(not plain(name) or is_unit(name) for name in names):
        return above, names
    return names, nothing


def _names(line, delimiter, width, unnamed):
    """The names in a line above the numbers, or None if they are not as many as columns.

    unnamed : whether the first column may be without
    """
    line = line.strip(" \n").lstrip(COMMENTS).strip(" ")
    ways = [_cells(line, delimiter), re.split(r"\s{2,}|\t", line)]
    ways += [_cells(line, ","), _cells(line, "\t"), line.split()]
    for cells in ways:
        if len(cells) == width + 1 and not cells[-1]:
            cells = cells[:-1]
        if unnamed and len(cells) == width - 1:
            cells = ["", *cells]
        if len(cells) == width > 1:
            return [cell.strip() for cell in cells]
    return None


def _cells(line, delimiter):
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
