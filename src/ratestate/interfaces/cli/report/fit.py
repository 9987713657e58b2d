"""Tables about a fit."""

from typing import Any

import xarray
from rich.table import Column, Table
from rich.text import Text

from ....records.fitting.by_law import results_by_law
from ....records.fitting.table import estimate_cells
from ....records.fitting.text import heading, labelled_warnings, remarks
from .rows import plain_table


def fit(result: xarray.Dataset) -> list[Any]:
    """The estimates under each law with 95 % intervals, the noise, remarks and warnings."""
    laws = results_by_law(result)
    first, *more = heading(result, laws)
    shown = [Text(first, style="bold"), *map(Text, more), _Widest(laws), Text("")]
    shown += map(Text, remarks(result, laws))
    return [*shown, *(Text(f"warning: {text}", style="bold") for text in labelled_warnings(laws))]


class _Widest:
    """The estimates in the fullest layout that the terminal is wide enough for."""

    def __init__(self, laws: dict[str, xarray.Dataset]) -> None:
        self.laws = laws

    def __rich_console__(self, console: Any, options: Any) -> Any:
        alone = [{law: part} for law, part in self.laws.items()]
        endless = options.update(width=10_000)
        for parts, meaning in (([self.laws], True), ([self.laws], False), (alone, True)):
            tables = [_table(laws, meaning) for laws in parts]
            widths = [console.measure(one, options=endless).maximum for one in tables]
            if max(widths) <= options.max_width:
                return tables
        return [_table(laws, False) for laws in alone]


def _table(laws: dict[str, xarray.Dataset], meaning: bool) -> Table:
    """The estimates under these laws, with or without what each quantity is."""
    numbers = [head for law in laws for head in (f"{law} law", "95 % interval")]
    made = plain_table(
        Column(no_wrap=True),
        *(Column(head, justify="right", no_wrap=True) for head in numbers),
        *([Column(no_wrap=True)] if meaning else []),
    )
    for cells in estimate_cells(laws, meaning):
        made.add_row(*map(Text, cells))
    return made
