"""A fit as text, for a notebook or a log."""

import re
import textwrap

from ...dynamics import attributes
from ...model.quantities import readable
from .by_law import (
    checked_by_law,
    is_of_steps,
    law_of,
    results_by_law_of_steps,
    value_of,
    warnings_of,
)
from .steps.text import (
    HEADS,
    NOTATION,
    heading_of_steps,
    remarks_on_steps,
    table_of,
    warnings_on_steps,
)
from .table import estimate_cells, law_names, quality_text
from .unknowns import of_slider

#: columns of the text
WIDTH = 96
#: units that stay on the line of the number before them
UNIT = r"%|\+-|[numkMG]?(?:m|s|Pa)\b"


def summary(result):
    """A fit as plain text, to print.

    Parameters
    ----------
    result : xarray.Dataset
        From `fit`, under one law or several.

    Returns
    -------
    str
        What was fitted; a table with a row for each quantity: its unit, and under each law its
        value +- standard error and its 95 % interval; what was given; noise and misfit; how the
        laws compare; what the record determines; notes on the record; warnings.  An error is
        left out if an interval is open; if that is not from the covariance, the error is half the
        68 % interval.

    Raises
    ------
    ParameterError
        No result of `fit`, or one that has lost its attributes.
    """
    if is_of_steps(result):
        return _summary_of_steps(result)
    laws = checked_by_law(result, "summary")
    above, below = heading(result, laws), remarks(result, laws)
    below += [f"warning: {text}" for text in labelled_warnings(laws)]
    return "\n".join([*map(_wrapped, above), "", *_table(laws), "", *map(_wrapped, below)])


def _summary_of_steps(result):
    lines = [_wrapped(heading_of_steps(result))]
    for law in results_by_law_of_steps(result):
        table = table_of(result, law)
        lines += [
            "",
            f"{law} law",
            *_aligned([table.heads, *table.rows, *table.together], len(HEADS)),
        ]
    below = [NOTATION, *remarks_on_steps(result)]
    below += warnings_on_steps(result, "in the variable warnings of the result")
    return "\n".join([*lines, "", *map(_wrapped, below + notes_of(result))])


def notes_of(result):
    """The notes on a result's record, a line each (list of str)."""
    if "notes" not in result.attrs:
        return []
    return [f"note: {note}" for note in attributes.from_json(result, "notes", list)]


def heading(result, laws):
    """What was fitted, and, if recorded, what the load point did (list of one or two str)."""
    source = attributes.text(result, "source", "")
    about = f"Fit of {source}: " if source else "Fit of "
    history = attributes.text(result, "found", "")
    first = f"{about}{result.sizes['time']:,} samples, {law_names(laws)}"
    return [first, history] if history else [first]


def remarks(result, laws):
    """The lines below the estimates, without the warnings (list of str)."""
    texts = [fixed_parameters(laws)]
    texts += [f"{law} law: {quality_text(part)}" for law, part in laws.items()]
    texts.append(attributes.text(result, "comparison", ""))
    texts += [f"{law} law: {text}" for law, text in identifiability_by_law(laws).items()]
    return [text for text in (*texts, *notes_of(result)) if text]


def fixed_parameters(laws):
    """A sentence with the parameters that were given, under any of the laws, and their values."""
    values: dict[str, float] = {}
    for part in laws.values():
        symbols = of_slider(law_of(part))
        if "normal_stress" in part.attrs:
            symbols = (*symbols, "alpha")  # which has a part where normal stress varies
        given = [s for s in symbols if s not in part.data_vars]
        values |= {s: value_of(part, s) for s in (*given, "sigma", "V0")}
    return f"Given: {', '.join(f'{s} = {readable(s, value)}' for s, value in values.items())}."


def identifiability_by_law(laws):
    """law -> the note on what the record determines, where there is one."""
    notes = {law: str(part["identifiability"].item()) for law, part in laws.items()}
    return {law: note for law, note in notes.items() if note}


def labelled_warnings(laws):
    """All warnings, each with its law (list of str)."""
    return [f"{law} law: {text}" for law, part in laws.items() for text in warnings_of(part)]


def _table(laws):
    """The lines of the table (list of str); under one law with what each quantity means."""
    head = ["", *(text for law in laws for text in (f"{law} law", "95 %"))]
    return _aligned([head, *estimate_cells(laws, len(laws) == 1)], 1)


def _aligned(rows, left):
    """Rows of cells as lines: columns aligned right but the first `left`, and what is beyond the
    first row's, which has their heads.
    """
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [
            text.ljust(width) if i < left else text.rjust(width)
            for i, (text, width) in enumerate(zip(row, widths, strict=False))
        ]
        lines.append("   ".join([*cells, *row[len(cells) :]]).rstrip())
    return lines


def _wrapped(text):
    """A long text as lines, none of which begins with the unit of a number."""
    joined = re.sub(rf"(?<=[\d.]) (?={UNIT})", "\N{NO-BREAK SPACE}", text)
    return textwrap.fill(joined, WIDTH, subsequent_indent="  ").replace("\N{NO-BREAK SPACE}", " ")
