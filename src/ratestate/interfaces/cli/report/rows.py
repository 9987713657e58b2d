"""Rows of a table about one slider: symbol, value, meaning, relative error."""

import math
from typing import Any, NamedTuple

from ....model.quantities import QUANTITIES, long_time, readable

DIGITS = 6


class Row(NamedTuple):
    """A row: symbol, value, what it is, and the relative error of the value, if known."""

    symbol: str
    value: str
    meaning: str
    error: float | None = None


def row(symbol: str, value: Any, remark: str = "", error: float | None = None) -> Row:
    """The row of a quantity in SI, with its long name and a remark."""
    x = float(value)
    time = QUANTITIES[symbol].unit == "s"
    text = when(x) if time else readable(symbol, x, DIGITS)
    if math.isnan(x):
        text = "-"
    elif math.isinf(x) and not QUANTITIES[symbol].may_be_inf:
        text = "none"  # a limit such as V_c without mass
    name = QUANTITIES[symbol].long_name
    return Row(symbol, text, f"{name}; {remark}" if remark else name, error)


def when(seconds: float) -> str:
    """A time as text, a long one in years, days or hours."""
    if long := long_time(seconds):
        return f"{seconds / long[1]:.{DIGITS}g} {long[0]}"
    return readable("t", seconds, DIGITS)


def table(title: str, rows: list[Row]) -> list[Any]:
    """The rows as a table of rich's under a title; a column of errors only if a row has one."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    errors = any(one.error is not None for one in rows)
    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    made.add_column("")
    made.add_column("value", justify="right", no_wrap=True)
    if errors:
        made.add_column("relative error", justify="right")
    made.add_column("")
    for one in rows:
        error = [] if not errors else ["" if one.error is None else f"{one.error:.1g}"]
        made.add_row(*map(Text, (one.symbol, one.value, *error, one.meaning)))
    return [Text(title, style="bold"), made]
