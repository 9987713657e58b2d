"""Tables about fits of steps and holds."""

from typing import Any

import xarray
from rich.table import Column, Table
from rich.text import Text

from ....records.fitting.by_law import results_by_law_of_steps
from ....records.fitting.steps.text import (
    HEADS,
    NOTATION,
    heading_of_steps,
    remarks_on_steps,
    table_of,
    warnings_on_steps,
)
from ....records.fitting.steps.text import Table as StepsTable
from ....records.fitting.text import notes_of
from .rows import GAP, plain_table

#: where all warnings are
WHERE = "in report.md and steps.csv, which --out FOLDER writes"


def steps(result: xarray.Dataset) -> list[Any]:
    """A row for each step under each law, what all tell together, and remarks."""
    shown: list[Any] = [Text(heading_of_steps(result), style="bold")]
    for law in results_by_law_of_steps(result):
        shown += [Text(f"{law} law", style="bold"), _AsWideAsTheTerminal(table_of(result, law))]
        shown += [Text("")]
    below = [NOTATION, *remarks_on_steps(result), *warnings_on_steps(result, WHERE)]
    return [*shown, *map(Text, below + notes_of(result))]


class _AsWideAsTheTerminal:
    """The steps under one law, in as few tables as the terminal has room for."""

    def __init__(self, table: StepsTable) -> None:
        self.table = table

    def __rich_console__(self, console: Any, options: Any) -> list[Any]:
        first, *others = map(_table, self.table.parts(options.max_width, GAP))
        return [first, *(one for table in others for one in (Text(""), table))]


def _table(table: StepsTable) -> Table:
    """A table as rich prints it; cells too wide for any line are broken, never cut."""
    made = plain_table(
        *(
            Column(
                Text(head), justify="left" if head in (*HEADS, "note") else "right", overflow="fold"
            )
            for head in table.heads
        )
    )
    for row in (*table.rows, *table.together):
        made.add_row(*map(Text, row))
    return made
