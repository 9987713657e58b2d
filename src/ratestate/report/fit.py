"""Tables about a fit, or about the fits of steps and holds."""

from typing import Any

import xarray
from rich.table import Column, Table
from rich.text import Text

from ..records.fitting.by_law import has_steps, results_by_law
from ..records.fitting.steps.text import HEADS, table_of
from ..records.fitting.table import estimate_cells
from ..records.fitting.text import sentences_of
from .tables import GAP, FirstThatFits, plain_table

#: where all warnings on steps are
WHERE = "in report.md and steps.csv, which --out FOLDER writes"


def fit(result: xarray.Dataset, _: Any = None) -> list[Any]:
    """The estimates under each law, of one fit or of each step, remarks and warnings."""
    laws = results_by_law(result)
    (first, *more), below, warnings = sentences_of(result, laws, WHERE)
    tables: list[Any] = []
    if has_steps(result):
        for law in laws:
            table = _AsWideAsTheTerminal(table_of(result, law))
            tables += [Text(f"{law} law", style="bold"), table, Text("")]
    else:
        # with what each quantity is or without; laws side by side or one by one
        alone = [{law: part} for law, part in laws.items()]
        layouts = [(group, meaning) for group in ([laws], alone) for meaning in (True, False)]
        shown = ([_estimates(one, meaning) for one in group] for group, meaning in layouts)
        tables = [FirstThatFits(*shown), Text("")]
    bold = (Text(text, style="bold") for text in warnings)
    return [Text(first, style="bold"), *map(Text, more), *tables, *map(Text, below), *bold]


def _estimates(laws: dict[str, xarray.Dataset], meaning: bool) -> Table:
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


class _AsWideAsTheTerminal:
    """The steps under one law (rows of cells), in as few tables as the terminal has room for."""

    def __init__(self, rows: list[list[str]]) -> None:
        self.rows = rows

    def __rich_console__(self, console: Any, options: Any) -> list[Any]:
        first, *others = map(_steps, parts(self.rows, options.max_width))
        return [first, *(one for table in others for one in (Text(""), table))]


def parts(rows: list[list[str]], width: int) -> list[list[list[str]]]:
    """Rows of cells as several tables, each with as many columns as a width has room for.

    All but the first begin with the steps' numbers.  No column is left out or cut: a table with one
    estimate may be wider.
    """
    widths = [max(map(len, cells)) + GAP for cells in zip(*rows, strict=True)]
    tables = [[*range(len(HEADS))]]
    for column in range(len(HEADS), len(widths)):
        wider = [*tables[-1], column]
        if sum(widths[i] for i in wider) - GAP <= width or len(tables[-1]) == 1:
            tables[-1] = wider
        else:
            tables.append([0, column])
    return [[[cells[i] for i in columns] for cells in rows] for columns in tables]


def _steps(rows: list[list[str]]) -> Table:
    """A table as rich prints it; cells too wide for any line are broken, never cut."""
    left = (*HEADS, "note")
    heads = (
        Column(Text(head), justify="left" if head in left else "right", overflow="fold")
        for head in rows[0]
    )
    made = plain_table(*heads)
    for row in rows[1:]:
        made.add_row(*map(Text, row))
    return made
