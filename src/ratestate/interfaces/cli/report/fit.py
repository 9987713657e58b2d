"""Tables about a fit."""

from typing import Any

import xarray
from rich.table import Column, Table
from rich.text import Text

from ....records.fitting.by_law import results_by_law
from ....records.fitting.table import estimate_cells
from ....records.fitting.text import heading, labelled_warnings, remarks
from .rows import FirstThatFits, plain_table


def fit(result: xarray.Dataset) -> list[Any]:
    """The estimates under each law with 95 % intervals, the noise, remarks and warnings."""
    laws = results_by_law(result)
    first, *more = heading(result, laws)
    shown = [Text(first, style="bold"), *map(Text, more), _estimates(laws), Text("")]
    shown += map(Text, remarks(result, laws))
    return [*shown, *(Text(f"warning: {text}", style="bold") for text in labelled_warnings(laws))]


def _estimates(laws: dict[str, xarray.Dataset]) -> FirstThatFits:
    """The estimates, with what each quantity is or without; laws side by side or one by one."""
    alone = [{law: part} for law, part in laws.items()]
    layouts = [([laws], True), ([laws], False), (alone, True), (alone, False)]
    return FirstThatFits(*([_table(one, meaning) for one in parts] for parts, meaning in layouts))


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
