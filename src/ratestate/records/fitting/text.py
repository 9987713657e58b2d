"""A fit as text, for a notebook or a log."""

import re
import textwrap

from ...dynamics import attributes
from ...model.quantities import readable
from .by_law import checked_by_law, has_steps, law_of, value_of, warnings_of
from .steps.text import (
    HEADS,
    NOTATION,
    heading_of_steps,
    remarks_on_steps,
    table_of,
    warnings_on_steps,
)
from .table import estimate_cells, law_names, quality_text
from .unknowns import motion_symbols

#: width of the text in characters
WIDTH = 96
#: units that stay on the line of their number
UNIT = r"%|\+-|[numkMG]?(?:m|s|Pa)\b"


def summary(result):
    """Return a fit as plain text, to print.

    Parameters
    ----------
    result : xarray.Dataset
        From `fit`, under one law or several.

    Returns
    -------
    str
        The text says what was fitted, and what was given.  A table has a row for each quantity: its
        unit, and under each law the value +- standard error and the 95 % interval.  Noise, misfit,
        comparison of the laws, identifiability, notes on the record and warnings follow.  An error
        is left out if an interval is open.  If an interval is not from the covariance, the error
        is half of the 68 % interval.

    Raises
    ------
    ParameterError
        Not a result of `fit`, or one that lacks its attributes.
    """
    laws = checked_by_law(result, "summary")
    above, *others = sentences_of(result, laws, "in the variable warnings of the result")
    if has_steps(result):
        tables = []
        for law in laws:
            tables += [f"{law} law", *_aligned(table_of(result, law), range(len(HEADS))), ""]
    else:
        is_one = len(laws) == 1  # leaves room for the meanings
        head = ["", *(text for law in laws for text in (f"{law} law", "95 %")), *[""] * is_one]
        left = {0, len(head) - 1} if is_one else {0}
        tables = [*_aligned([head, *estimate_cells(laws, is_one)], left), ""]
    below = [text for texts in others for text in texts]
    return "\n".join([*map(_wrapped, above), "", *tables, *map(_wrapped, below)])


def sentences_of(result, laws, where):
    """Return lines above the tables of a fit, lines below, and warnings (lists).

    where : place of the warnings of laws that do not fit best, in fits of steps
    """
    notes = attributes.from_json(result, "notes", list) if "notes" in result.attrs else []
    notes = [f"note: {note}" for note in notes]
    if has_steps(result):
        remarks = [NOTATION, *remarks_on_steps(result), *notes]
        return [heading_of_steps(result)], remarks, warnings_on_steps(result, where)
    source = attributes.text(result, "source", "")
    about = f"Fit of {source}: " if source else "Fit of "
    above = [f"{about}{result.sizes['time']:,} samples, {law_names(laws)}"]
    above += [attributes.text(result, "found", "")]  # what the load point did
    below = [fixed_parameters(laws)]
    below += [f"{law} law: {quality_text(part)}" for law, part in laws.items()]
    below += [attributes.text(result, "comparison", "")]
    below += [f"{law} law: {text}" for law, text in identifiability_by_law(laws).items()]
    warnings = [f"warning: {text}" for text in labelled_warnings(laws)]
    return [*filter(None, above)], [*filter(None, below), *notes], warnings


def fixed_parameters(laws):
    """Return a sentence with the given parameters, under any of the laws."""
    values: dict[str, float] = {}
    for part in laws.values():
        symbols = motion_symbols(law_of(part))
        if "normal_stress" in part.attrs:
            symbols = (*symbols, "alpha")  # which matters only if normal stress varies
        given = [s for s in symbols if s not in part.data_vars]
        values |= {s: value_of(part, s) for s in (*given, "sigma", "V0")}
    return f"Given: {', '.join(f'{s} = {readable(s, value)}' for s, value in values.items())}."


def identifiability_by_law(laws):
    """Return law -> the note on what the record determines, if there is one."""
    notes = {law: str(part["identifiability"].item()) for law, part in laws.items()}
    return {law: note for law, note in notes.items() if note}


def labelled_warnings(laws):
    """Return all warnings, each with its law (list of str)."""
    return [f"{law} law: {text}" for law, part in laws.items() for text in warnings_of(part)]


def _aligned(rows, left):
    """Return rows of cells as lines; `left` has the numbers of columns aligned left."""
    columns = []
    for i, cells in enumerate(zip(*rows, strict=True)):
        width, align = max(map(len, cells)), str.ljust if i in left else str.rjust
        columns.append([align(text, width) for text in cells])
    return ["   ".join(cells).rstrip() for cells in zip(*columns, strict=True)]


def _wrapped(text):
    """Return a long text as lines; no line begins with the unit of a number."""
    joined = re.sub(rf"(?<=[\d.]) (?={UNIT})", "\N{NO-BREAK SPACE}", text)
    return textwrap.fill(joined, WIDTH, subsequent_indent="  ").replace("\N{NO-BREAK SPACE}", " ")
