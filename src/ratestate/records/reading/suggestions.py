"""Columns that a message suggests where their names do not decide."""

import re

from ...errors import ParameterError
from ...model.units import to_si
from .table import quoted
from .titles import letters, plain

#: pattern that excludes names of displacements that are not the load point's
NOT_OTHERS = r"(?!.*(?:norm|slip|sample|fault|thick|dilat|compac|layer|ecdt|onboard|internal|lvdt))"


def suggested_column(table, symbol, taken):
    """The one free column with a unit of this quantity, as a call names it; else ""."""
    same = [
        i
        for i, column in enumerate(table.columns)
        if i not in taken
        and _fits(symbol, column.unit)
        and (symbol != "delta_lp" or re.fullmatch(rf"{NOT_OTHERS}.*", letters(column.name)))
    ]
    return column_reference(table, same[0]) if len(same) == 1 else ""


def _fits(symbol, unit):
    """Whether a unit is one of this quantity; friction may have none."""
    try:
        to_si(symbol, f"1 {plain(unit)}", bound="")
    except ParameterError:
        return False
    return bool(unit) or symbol == "friction"


def column_reference(table, index):
    """A column as a call names it: by its title, or by number if the title is not unique."""
    title = table.titles[index]
    return quoted(title) if table.titles.count(title) == 1 else str(index + 1)
