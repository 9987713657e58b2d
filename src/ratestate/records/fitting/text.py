"""A fit as text, for a notebook or a log."""

import re
import textwrap

from ...dynamics import attributes
from ...model.quantities import readable
from .each import value_of, warnings_of
from .fitted import checked_laws
from .lines import lines, named, quality

#: columns of the text
WIDTH = 96
#: what is not parted from the number before it
UNIT = r"%|\+-|[numkMG]?(?:m|s|Pa)\b"


def summary(result):
    """What a fit found, as plain text: print it.

    Parameters
    ----------
    result : xarray.Dataset
        From `fit`, under one law or several.

    Returns
    -------
    str
        What was fitted; a table with a row for each quantity: its unit, under each law its value
        +- standard error (half the 68 % interval, where that is not from the covariance; none,
        where it is open) and its 95 % interval; what was given; noise and misfit; how the laws
        compare; what the record determines; notes on the record; warnings.

    Raises
    ------
    ParameterError
        No result of `fit`, or one that has lost its attributes.
    """
    laws = checked_laws(result, "summary")
    above, below = heading(result, laws), remarks(result, laws)
    below += [f"warning: {text}" for text in warned(laws)]
    return "\n".join(
        [*map(_wrapped, above), "", *_table(laws), "", *map(_wrapped, below)],
    )


def heading(result, laws):
    """What was fitted, and what the load point did (list of str)."""
    source = attributes.text(result, "source", "")
    about = f"Fit of {source}: " if source else "Fit of "
    found = attributes.text(result, "found", "")
    fitted = f"{about}{result.sizes['time']:,} samples, {named(laws)}"
    return [fitted, found] if found else [fitted]


def remarks(result, laws):
    """What is to be said of a fit beneath its estimates, but for warnings (list of str)."""
    told = [given(laws), *(f"{law} law: {quality(part)}" for law, part in laws.items())]
    told.append(attributes.text(result, "comparison", ""))
    told += [f"{law} law: {words}" for law, words in identifiability(laws).items()]
    if "notes" in result.attrs:
        told += [f"note: {note}" for note in attributes.from_json(result, "notes", list)]
    return [one for one in told if one]


def given(laws):
    """What was not fitted, in words."""
    part = next(iter(laws.values()))
    symbols = [s for s in ("a", "b", "Dc", "K", "M", "sigma", "V0") if s not in part.data_vars]
    return f"Given: {', '.join(f'{s} = {readable(s, value_of(part, s))}' for s in symbols)}."


def identifiability(laws):
    """law -> what the record determines, in words; of laws of which there is something to say."""
    said = {law: str(part["identifiability"].item()) for law, part in laws.items()}
    return {law: words for law, words in said.items() if words}


def warned(laws):
    """All warnings, each with its law (list of str)."""
    return [f"{law} law: {text}" for law, part in laws.items() for text in warnings_of(part)]


def _table(laws):
    """The rows of the table (list of str), under a heading; with what each is if there is room."""
    head = ["", *(text for law in laws for text in (f"{law} law", "95 %"))]
    rows = [head]
    for line in lines(laws):
        cells = [text for one in line.each for text in (one.value, (one.intervals or ("",))[-1])]
        rows.append([line.label, *cells, *([line.meaning] if len(laws) == 1 else [])])
    wide = [max(len(row[i]) for row in rows) for i in range(len(head))]
    found = []
    for label, *cells in rows:
        padded = [text.rjust(width) for text, width in zip(cells, wide[1:], strict=False)]
        meaning = cells[len(padded) :]
        found.append("   ".join([label.ljust(wide[0]), *padded, *meaning]).rstrip())
    return found


def _wrapped(text):
    """A long text as lines, none of which begins with the unit of a number."""
    kept = re.sub(rf"(?<=[\d.]) (?={UNIT})", "\N{NO-BREAK SPACE}", text)
    return textwrap.fill(kept, WIDTH, subsequent_indent="  ").replace("\N{NO-BREAK SPACE}", " ")
