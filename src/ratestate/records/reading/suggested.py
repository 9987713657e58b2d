"""Columns that a message suggests where names do not tell which is meant."""

import re

from ...errors import ParameterError
from ...model.units import to_si
from .table import shown
from .titles import letters, plain

#: letters of a name after which it is no displacement of the load point
OTHERS = r"(?!.*(?:norm|slip|sample|fault|thick|dilat|compac|layer|ecdt|onboard|internal|lvdt))"


def likely(table, symbol, taken):
    """A column to suggest: the one that has a unit as the symbol needs; "" if none does."""
    same = [
        i
        for i, column in enumerate(table.columns)
        if i not in taken
        and _fits(symbol, column.unit)
        and (symbol != "delta_lp" or re.fullmatch(rf"{OTHERS}.*", letters(column.name)))
    ]
    return named(table, same[0]) if len(same) == 1 else ""


def _fits(symbol, unit):
    """Whether a unit is one of this quantity; none is one of friction."""
    try:
        to_si(symbol, f"1 {plain(unit)}", bound="")
    except ParameterError:
        return False
    return bool(unit) or symbol == "friction"


def named(table, index):
    """A column as a call names it: by its title, or its number if others have the title."""
    title = table.titles[index]
    return shown(title) if table.titles.count(title) == 1 else str(index + 1)
