"""Tables for the terminal; rows about one slider: symbol, value, meaning, relative error."""

import math
from typing import Any, NamedTuple

from rich import box
from rich.table import Column, Table
from rich.text import Text

from ....model.quantities import QUANTITIES, readable, readable_time

DIGITS = 6


def plain_table(*columns: str | Column) -> Table:
    """A table of rich's with these columns and a line under their heads."""
    return Table(*columns, box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)


class Row(NamedTuple):
    """A row: symbol, value, what it is, and the relative error of the value, if known."""

    symbol: str
    value: str
    meaning: str
    error: float | None = None


def row(symbol: str, value: Any, remark: str = "", error: float | None = None) -> Row:
    """The row of a quantity in SI, with its long name and a remark.

    NaN reads "-"; inf, if it is no value of the quantity but says that a limit is absent, "none".
    """
    x, quantity = float(value), QUANTITIES[symbol]
    text = readable_time(x, DIGITS) if quantity.unit == "s" else readable(symbol, x, DIGITS)
    if math.isnan(x):
        text = "-"
    elif math.isinf(x) and not quantity.may_be_inf:
        text = "none"  # a limit such as V_c without mass
    name = quantity.long_name
    return Row(symbol, text, f"{name}; {remark}" if remark else name, error)


def table(title: str, rows: list[Row]) -> list[Any]:
    """[title, table of the rows]; with a column of errors only if a row has one."""
    errors = any(one.error is not None for one in rows)
    head = [Column("relative error", justify="right")] if errors else []
    made = plain_table("", Column("value", justify="right", no_wrap=True), *head, "")
    for one in rows:
        error = [] if not errors else ["" if one.error is None else f"{one.error:.1g}"]
        made.add_row(*map(Text, (one.symbol, one.value, *error, one.meaning)))
    return [Text(title, style="bold"), made]
