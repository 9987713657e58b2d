"""Tables about a fit, or about the fits of steps and holds."""

from typing import Any

import xarray
from rich.table import Column, Table
from rich.text import Text

from ..dynamics.recipe import attribute_text, from_json
from ..model.quantities import readable
from ..records.fitting.by_law import (
    checked_by_law,
    has_steps,
    law_names,
    law_of,
    value_of,
    warnings_of,
)
from ..records.fitting.unknowns import motion_symbols
from .estimates import Laws, estimate_cells, quality_text
from .steps import (
    HEADS,
    NOTATION,
    heading_of_steps,
    remarks_on_steps,
    table_of,
    warnings_on_steps,
)
from .tables import GAP, FirstThatFits, plain_table


def fit(result: xarray.Dataset) -> list[Any]:
    """The estimates under each law, of one fit or of each step, remarks and warnings."""
    laws = checked_by_law(result, "summary")
    (first, *more), below, warnings = _sentences(result, laws)
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


def _sentences(result: xarray.Dataset, laws: Laws) -> tuple[list[str], list[str], list[str]]:
    """Return lines above the tables of a fit, lines below, and warnings."""
    notes = from_json(result, "notes", list) if "notes" in result.attrs else []
    notes = [f"note: {note}" for note in notes]
    if has_steps(result):
        remarks = [NOTATION, *remarks_on_steps(result), *notes]
        return [heading_of_steps(result)], remarks, warnings_on_steps(result)
    source = attribute_text(result, "source", "")
    about = f"Fit of {source}: " if source else "Fit of "
    above = [f"{about}{result.sizes['time']:,} samples, {law_names(laws)}"]
    above += [attribute_text(result, "found", "")]  # what the load point did
    below = [fixed_parameters(laws)]
    below += [f"{law} law: {quality_text(part)}" for law, part in laws.items()]
    below += [attribute_text(result, "comparison", "")]
    below += [f"{law} law: {text}" for law, text in identifiability_by_law(laws).items()]
    warnings = [f"warning: {text}" for text in labelled_warnings(laws)]
    return [*filter(None, above)], [*filter(None, below), *notes], warnings


def fixed_parameters(laws: Laws) -> str:
    """Return a sentence with the given parameters, under any of the laws."""
    values: dict[str, float] = {}
    for part in laws.values():
        symbols = motion_symbols(law_of(part))
        if "normal_stress" in part.attrs:
            symbols = (*symbols, "alpha")  # which matters only if normal stress varies
        given = [s for s in symbols if s not in part.data_vars]
        values |= {s: value_of(part, s) for s in (*given, "sigma", "V0")}
    return f"Given: {', '.join(f'{s} = {readable(s, value)}' for s, value in values.items())}."


def identifiability_by_law(laws: Laws) -> dict[str, str]:
    """Return law -> the note on what the record determines, if there is one."""
    notes = {law: str(part["identifiability"].item()) for law, part in laws.items()}
    return {law: note for law, note in notes.items() if note}


def labelled_warnings(laws: Laws) -> list[str]:
    """Return all warnings, each with its law (list of str)."""
    return [f"{law} law: {text}" for law, part in laws.items() for text in warnings_of(part)]


def _estimates(laws: Laws, meaning: bool) -> Table:
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
