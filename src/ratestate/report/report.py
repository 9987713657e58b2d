"""The class `Report`: rows and sentences, and how it becomes text, HTML and Markdown."""

import io
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import xarray
from rich import box
from rich import table as rich_table
from rich.console import Console, Group
from rich.text import Text

from ..dynamics.results import contact_area
from ..model.parameters import of_contact, shown_name
from ..model.quantities import QUANTITIES, power_of, prefixed_unit, readable, readable_time
from ..model.units import has_unit, unit_factor

#: width of a report as plain text [characters]
WIDTH = 110
#: characters between two columns
GAP = 3
#: significant digits of numbers in tables, and in tables of many numbers
DIGITS, FEW_DIGITS = 6, 4
#: pure numbers below this may be given in thousandths
SMALL = 0.1
#: values of V_c that stand for all speeds
ANY_SPEED = {0.0: "unstable at any speed", math.inf: "stable at any speed"}


class Units(NamedTuple):
    """In which units values are shown."""

    wanted: Mapping[str, str] = {}  # symbol -> the unit that is asked for
    area: Any = None  # of the contact [m^2], if known: other values are of the whole contact

    def area_of(self, symbol: str) -> Any:
        """Return the area if a value is shown for the whole contact, else None."""
        per_area = symbol in self.wanted and has_unit(symbol, self.wanted[symbol])
        return None if per_area else self.area


def shown_units(result: xarray.Dataset, wanted: Mapping[str, str] | None = None) -> Units:
    """Return the units for values of a result; wanted : symbol -> the unit that is asked for."""
    recorded = {"scenario", "slider"} & result.attrs.keys()
    return Units(wanted or {}, contact_area(result) if recorded else None)


class Title(str):
    """A line above a part of a report: bold in text, a heading in Markdown."""


class Heading(NamedTuple):
    """The heading of a column, and how the column behaves.

    If a table is too wide, columns that `may_go` are left out, and a column that is `joined` stays
    beside the column before it.
    """

    head: str
    right: bool = True  # alignment
    may_go: bool = False
    joined: bool = False


def left(head: str = "", **behaviour: bool) -> Heading:
    """Return the heading of a column that is aligned left."""
    return Heading(head, right=False, **behaviour)


class TextTable(NamedTuple):
    """Rows of texts under columns.

    If `splits`, a table that is too wide is written as several tables, each beginning with the
    first column.  Otherwise its last column wraps lines.
    """

    columns: Sequence[Heading]
    rows: list[list[str]]
    splits: bool = False

    def __rich_console__(self, console: Any, options: Any) -> Iterator[Any]:
        for i, columns in enumerate(self.parts(options.max_width)):
            if i:
                yield Text()
            heads = [self.columns[c] for c in columns]
            table = rich_table.Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
            for head in heads:
                look: Any = {"justify": "right" if head.right else "left", "overflow": "fold"}
                is_fixed = head.right and not self.splits
                table.add_column(Text(head.head), no_wrap=is_fixed, **look)
            for row in self.rows:
                table.add_row(*(Text(row[c]) for c in columns))
            yield table

    def parts(self, width: int) -> list[list[int]]:
        """Return the columns (list of int) of each of the tables for a width [characters]."""
        texts = [*zip(*([head.head for head in self.columns], *self.rows), strict=True)]
        widths = [max(len(line) for text in cells for line in text.split("\n")) for cells in texts]
        columns = [*range(len(widths))]

        def is_too_wide(shown: list[int]) -> bool:
            return sum(widths[c] + GAP for c in shown) - GAP > width

        while is_too_wide(columns) and (optional := [c for c in columns if self.columns[c].may_go]):
            first = self.columns[optional[0]]
            columns = [c for c in columns if self.columns[c] != first]
        if not self.splits:
            return [columns]
        groups = [columns[:1]]
        for c in columns[1:]:
            if self.columns[c].joined:
                groups[-1].append(c)
            else:
                groups.append([c])
        tables = groups[:1]
        for group in groups[1:]:
            if len(tables[-1]) > 1 and is_too_wide(tables[-1] + group):
                tables.append(columns[:1])
            tables[-1] = tables[-1] + group
        return tables

    def markdown(self) -> str:
        heads = [head.head.replace("\n", " ") for head in self.columns]
        rule = ["---:" if head.right else "---" for head in self.columns]
        rows = (" | ".join(cells).replace("\n", " ") for cells in (heads, rule, *self.rows))
        return "\n".join(f"| {row} |" for row in rows)


#: what a report consists of
Blocks = list[str | TextTable]


class Report:
    """Tables and sentences on a result.

    ``print`` writes it as plain text, a notebook shows it, and rich prints it in the width and with
    the colours of a terminal.

    Parameters
    ----------
    blocks : iterable of str and TextTable
        Sentences, tables and titles.
    warnings : iterable of str
        Warnings.  Markdown begins with them.  Plain text ends with them, because a terminal shows
        the end of long output.
    """

    def __init__(self, blocks: Iterable[str | TextTable], warnings: Iterable[str] = ()) -> None:
        self.blocks = list(blocks)
        self.warnings = list(warnings)

    def __iter__(self) -> Iterator[Any]:
        for block in [*self.blocks, *map(Title, self.warnings)]:
            bold = "bold" if isinstance(block, Title) else ""
            yield block if isinstance(block, TextTable) else Text(block, style=bold)

    def __rich__(self) -> Group:
        return Group(*self)

    def __str__(self) -> str:
        return "\n".join(line.rstrip() for line in self._printed().export_text().splitlines())

    def _repr_html_(self) -> str:
        return self._printed().export_html(code_format="<pre>{code}</pre>", inline_styles=True)

    def _printed(self) -> Console:
        console = Console(
            file=io.StringIO(), record=True, width=WIDTH, highlight=False, emoji=False
        )
        console.print(self)
        return console

    def markdown(self) -> str:
        """Return the report in Markdown: warnings, then tables and sentences in their order."""
        parts = []
        if self.warnings:
            lines = ["**Read this before you use the numbers.**", ""]
            lines += [f"- {text}" for text in self.warnings]
            parts.append("\n".join(f"> {line}".rstrip() for line in lines))
        for block in filter(None, self.blocks):
            if isinstance(block, TextTable):
                parts.append(block.markdown())
            else:
                parts.append("## " * isinstance(block, Title) + str(block))
        return "\n\n".join(parts).replace("+-", "\N{PLUS-MINUS SIGN}")


class Row(NamedTuple):
    """A quantity in SI, a remark, its relative error if known, and a text if not its value's."""

    symbol: str
    value: Any
    remark: str = ""
    error: float | None = None
    text: str = ""


def of_quantities(rows: list[Row], units: Units) -> TextTable:
    """Return a table of symbol, value, relative error if any row has one, and meaning."""
    errors = any(row.error is not None for row in rows)
    head = [Heading("relative\nerror")] if errors else []
    columns = [left(), Heading("value"), *head, left()]
    cells = []
    for symbol, value, remark, error, text in rows:
        shown = [text or value_text(symbol, float(value), units)]
        if errors:
            shown.append("" if error is None else f"{error:.1g}")
        name = shown_name(symbol, units.area_of(symbol))
        cells.append([symbol, *shown, f"{name}; {remark}" if remark else name])
    return TextTable(columns, cells)


def value_text(symbol: str, x: float, units: Units, digits: int = DIGITS) -> str:
    """Return a value [SI] as text, in the requested unit, or else in one that fits.

    NaN reads "-".  Infinity reads "none" if it is not a value of the quantity: it then says that
    a limit is absent.
    """
    quantity = QUANTITIES[symbol]
    if math.isnan(x):
        return "-"
    if math.isinf(x) and not quantity.may_be_inf:
        return "none"  # a limit such as V_c without mass
    unit = units.wanted.get(symbol)
    if quantity.unit == "s" and unit is None:
        return readable_time(x, digits)
    symbol, x = of_contact(symbol, x, units.area_of(symbol))
    if unit is None or math.isinf(x):
        return readable(symbol, x, digits)
    return f"{x / float(unit_factor(QUANTITIES[symbol].unit, unit)):.{digits}g} {unit}"


def scale_of(symbol: str, size: float, in_thousandths: bool = False) -> tuple[float, str]:
    """Return the factor from SI to the unit that fits a value of this size, and the unit's text.

    in_thousandths : give pure numbers below `SMALL` in thousandths
    """
    unit = QUANTITIES[symbol].unit
    if unit == "1":
        return (1e3, "1e-3") if in_thousandths and size < SMALL else (1.0, "")
    power = power_of(unit, size)
    return 10.0**-power, prefixed_unit(unit, power)


def numbers_by_text(
    name: str, texts: Iterable[tuple[Any, Iterable[str]]], most: int | None = None
) -> Iterator[tuple[str, str]]:
    """Yield numbers, such as "steps 3, 9", and the text that they share.

    texts : a number, and its texts
    most : numbers that are listed; None lists all
    """
    numbers: dict[str, list[str]] = {}
    for number, own in texts:
        for text in own:
            numbers.setdefault(text, []).append(str(number))
    for text, ids in numbers.items():
        more = f" and {len(ids) - most} more" if most and len(ids) > most else ""
        yield f"{name}{'s' if len(ids) > 1 else ''} {', '.join(ids[:most])}{more}", text


def place(coordinates: Mapping[Any, Any], units: Units) -> str:
    """Return a case's values along the axes, name -> value, as text with units."""
    return ", ".join(
        f"{dim} = {value_text(dim, float(x), units)}" if dim in QUANTITIES else f"{dim} = {x}"
        for dim, x in coordinates.items()
    )
