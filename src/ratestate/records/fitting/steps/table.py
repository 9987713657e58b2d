"""Fits of steps as text: a row for each step, what all tell together, which law they prefer."""

from typing import NamedTuple

import numpy as np

from ....model.quantities import QUANTITIES, short, with_error
from ..unknowns import TRENDS
from .cells import NONE, Column, change_text
from .result import FAILED, STICK_SLIP

#: heads of the columns on what happens
HEADS = ("step", "time [s]", "change")
#: what the table's numbers are
NOTATION = "In brackets: the standard error of the last digits; 9.19(18) is 9.19 +- 0.18."
#: probability that counts as small
IMPROBABLE = 0.01
#: least probability that is told as a number: Gaussian tails mean nothing so far out
LEAST = 1e-6


class Table(NamedTuple):
    """The steps under one law: heads of the columns, rows of cells, and rows on all steps."""

    heads: list
    rows: list
    together: list

    def parts(self, width, gap):
        """`Table`s (list) with its columns one after the other, as many as a width has room for.

        width, gap : characters in a line, and between two columns

        All but the first begin with the steps' numbers.  No column is left out or cut: a table
        with one estimate may be wider.
        """
        lines = [self.heads, *self.rows, *self.together]
        widths = [max(map(len, cells)) for cells in zip(*lines, strict=True)]
        parts = [[*range(len(HEADS))]]
        for column in range(len(HEADS), len(self.heads)):
            wider = [*parts[-1], column]
            if sum(widths[i] + gap for i in wider) - gap <= width or len(parts[-1]) == 1:
                parts[-1] = wider
            else:
                parts.append([0, column])
        return [self._of(columns) for columns in parts]

    def _of(self, columns):
        """The `Table` with some of the columns, by their numbers."""
        rows, together = (
            [[cells[i] for i in columns] for cells in lines] for lines in (self.rows, self.together)
        )
        return Table([self.heads[i] for i in columns], rows, together)


def is_of_steps(result):
    """Whether a result of `fit` is one of steps."""
    return "step" in result.dims


def table_of(result, law):
    """`Table` of a result under one of its laws."""
    parts = results_by_law_of_steps(result)
    part = parts[law]
    symbols = [
        symbol
        for symbol in part["parameter"].values.tolist()
        if symbol not in (*TRENDS, "mu0") and np.isfinite(part[symbol].values).any()
    ]
    columns = [Column(parts, law, symbol) for symbol in symbols]
    notes = [_note(part, i) for i in range(part.sizes["step"])]
    has_notes = any(notes)
    heads = [*HEADS, *(column.head for column in columns), *(["note"] if has_notes else [])]
    rows = [
        [
            *_what(part.isel(step=i)),
            *(column.cell(i) for column in columns),
            *([note] if has_notes else []),
        ]
        for i, note in enumerate(notes)
    ]
    together = [
        [label, "", "", *(column.of_all(name, error) for column in columns)]
        for label, name, error in (
            ("all", "shared", "shared_error"),
            ("scatter", "scatter", None),
            ("up/down", "up_over_down", "up_over_down_error"),
        )
    ]
    blank = [""] if has_notes else []
    filled = [cells for cells in together if any(cell not in ("", NONE, "0") for cell in cells[1:])]
    return Table(heads, rows, [[*cells, *blank] for cells in filled])


def results_by_law_of_steps(result):
    """dict law -> that law's part of a result of steps."""
    if "law" not in result.dims:
        return {str(result["law"].item()): result}
    return {str(law): result.sel(law=law) for law in result["law"].values}


def _what(step):
    """Number and time of a step, and what changes."""
    return str(int(step["step"])), f"{float(step['step_t']):.1f}", change_text(step)


def _note(part, i):
    """Whether a step is stick-slip or failed, or how many warnings it carries."""
    status = part["status"].values[i]
    if status in (FAILED, STICK_SLIP):
        return "failed" if status == FAILED else "stick-slip"
    count = len(str(part["warnings"].values[i]).splitlines())
    return "" if not count else "1 warning" if count == 1 else f"{count} warnings"


def sentences_on_all(result):
    """What all steps tell together, as sentences (list of str)."""
    texts = []
    for law, part in results_by_law_of_steps(result).items():
        if np.isfinite(part["shared_p_value"]):
            texts.append(f"{law} law: {_on_one_set(part)}")
        texts += [f"{law} law: {text}" for text in _on_symmetry(part)]
    return texts


def _on_one_set(part):
    """A sentence on whether one set of parameters serves all steps."""
    p, degrees = float(part["shared_p_value"]), int(part["shared_degrees"])
    verdict = "serves" if p >= IMPROBABLE else "does not serve"
    rise = short(float(part["shared_deviance"]))
    return (
        f"one set of parameters {verdict} all steps: chi-square is larger by {rise} for {degrees} "
        f"parameters fewer ({_probability(p)})."
    )


def _on_symmetry(part):
    """A sentence on the distances by steps up and steps down, where there are some of both."""
    distances = [s for s in part["parameter"].values.tolist() if QUANTITIES[s].unit == "m"]
    for symbol in distances[:1]:
        here = part.sel(parameter=symbol)
        keys = ("up_over_down", "up_over_down_error", "up_over_down_p_value")
        ratio, error, p = (float(here[key]) for key in keys)
        if np.isfinite(p):
            alike = "alike" if p >= IMPROBABLE else "not alike"
            yield (
                f"steps up and steps down are {alike}: {symbol} of steps up is "
                f"{with_error(ratio, error)} times that of steps down ({_probability(p)})."
            )


def _probability(p):
    """A probability, but none so small that nothing is known of it."""
    return f"p = {p:.2g}" if p >= LEAST else f"p < {LEAST:g}"
