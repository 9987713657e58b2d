"""Tables about fits of steps and holds."""

from typing import Any

import xarray
from rich.table import Column, Table
from rich.text import Text

from ....records.fitting.steps.table import HEADS, results_by_law_of_steps, table_of
from ....records.fitting.steps.table import Table as StepsTable
from ....records.fitting.text import heading_of_steps, notes_of, remarks_on_steps
from .rows import FirstThatFits, plain_table


def steps(result: xarray.Dataset) -> list[Any]:
    """A row for each step under each law, what all tell together, and remarks."""
    shown: list[Any] = [Text(heading_of_steps(result), style="bold")]
    for law in results_by_law_of_steps(result):
        layouts = [[_table(table_of(result, law), no_wrap)] for no_wrap in (True, False)]
        shown += [Text(f"{law} law", style="bold"), FirstThatFits(*layouts), Text("")]
    return [*shown, *map(Text, remarks_on_steps(result) + notes_of(result))]


def _table(table: StepsTable, no_wrap: bool) -> Table:
    """The steps under one law, in lines that are not broken or are."""
    last = len(table.heads) - 1
    made = plain_table(
        *(
            Column(
                Text(head), justify="right" if len(HEADS) <= i < last else "left", no_wrap=no_wrap
            )
            for i, head in enumerate(table.heads)
        )
    )
    for row in (*table.rows, *table.together):
        made.add_row(*map(Text, row))
    return made
