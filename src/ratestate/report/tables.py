"""Tables for the terminal; rows about one slider: symbol, value, meaning, relative error."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from rich import box
from rich.table import Column, Table
from rich.text import Text

from ..model.quantities import QUANTITIES, readable, readable_time
from ..model.units import unit_factor

#: significant digits of numbers in tables, and in one that would be too wide with these
DIGITS, FEW_DIGITS = 6, 4
#: characters between two columns of a `plain_table`
GAP = 3
#: values of V_c that stand for all speeds
ANY_SPEED = {0.0: "unstable at any speed", math.inf: "stable at any speed"}
#: symbol -> the unit in which its values are wanted
Units = Mapping[str, str]


def plain_table(*columns: str | Column) -> Table:
    """A table of rich's with these columns and a line under their heads."""
    return Table(*columns, box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)


class FirstThatFits:
    """The first of several layouts for which the terminal is wide enough; the last wraps lines.

    layouts : lists of tables, the fullest layout first
    """

    def __init__(self, *layouts: list[Table]) -> None:
        self.layouts = layouts

    def __rich_console__(self, console: Any, options: Any) -> list[Table]:
        endless = options.update(width=10_000)
        for tables in self.layouts:
            widths = [console.measure(one, options=endless).maximum for one in tables]
            if max(widths) <= options.max_width:
                return tables
        return self.layouts[-1]


class Row(NamedTuple):
    """A row: symbol, value, what it is, the relative error of the value, if known, and it in SI."""

    symbol: str
    value: str
    meaning: str
    error: float | None = None
    x: float = math.nan


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
    return Row(symbol, text, f"{name}; {remark}" if remark else name, error, x)


def shown(symbol: str, x: float, units: Units, digits: int = DIGITS) -> str:
    """A value [SI] of a quantity as text, in the requested unit, or else in one that fits."""
    if symbol not in units:
        return readable(symbol, x, digits)
    value = x / float(unit_factor(QUANTITIES[symbol].unit, units[symbol]))
    return f"{value:.{digits}g} {units[symbol]}"


def place(where: dict[Any, Any]) -> str:
    """Which case: its values along the axes, name -> value, as text with units."""
    return ", ".join(
        f"{dim} = {readable(dim, float(x), DIGITS)}" if dim in QUANTITIES else f"{dim} = {x}"
        for dim, x in where.items()
    )


def table(title: str, rows: list[Row], units: Units) -> list[Any]:
    """[title, table of the rows]; with a column of errors only if a row has one."""
    errors = any(one.error is not None for one in rows)
    head = [Column("relative\nerror", justify="right")] if errors else []
    made = plain_table("", Column("value", justify="right", no_wrap=True), *head, "")
    for one in rows:
        error = [] if not errors else ["" if one.error is None else f"{one.error:.1g}"]
        wanted = one.symbol in units and math.isfinite(one.x)
        value = shown(one.symbol, one.x, units) if wanted else one.value
        made.add_row(*map(Text, (one.symbol, value, *error, one.meaning)))
    return [Text(title, style="bold"), made]
