"""Fits of steps as text: a table with a row for each step, sentences, and rows of a CSV."""

from typing import NamedTuple

import numpy as np
import xarray

from ....dynamics import attributes
from ....friction.laws import friction_law
from ....model.quantities import (
    QUANTITIES,
    concise,
    power_of,
    prefixed_unit,
    readable,
    readable_change,
    short,
    with_error,
)
from ..by_law import results_by_law_of_steps
from ..table import law_names, rate_dependence_text
from ..unknowns import SUMS, TRENDS, to_value
from .result import FAILED, STICK_SLIP

#: heads of the columns on what happens
HEADS = ("step", "time [s]", "change")
#: what the table's numbers are
NOTATION = "In brackets: the standard error of the last digits; 9.19(18) is 9.19 +- 0.18."
#: probability that counts as small
IMPROBABLE = 0.01
#: least probability that is told as a number: Gaussian tails mean nothing so far out
LEAST = 1e-6
#: pure numbers below this are given in thousandths
SMALL = 0.1
#: in place of an estimate
NONE = "-"
#: kinds of steps -> as a heading counts one, and several
KINDS = {
    "step": ("velocity step", "velocity steps"),
    "hold": ("hold", "holds"),
    "normal stress": ("step of normal stress", "steps of normal stress"),
}
#: variables of each step, in order, before the estimates and after them
BEFORE = "kind step_t step_delta_lp V_before V_after t_hold sigma sigma_after".split()
AFTER = "rms aic aic_difference samples status warnings message".split()
#: rows on all steps: label, variable along ``parameter``, and its error
TOGETHER = (
    ("all", "shared", "shared_error"),
    ("scatter", "scatter", None),
    ("up/down", "up_over_down", "up_over_down_error"),
)


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
        n = len(self.rows) + 1
        cut = [[[cells[i] for i in columns] for cells in lines] for columns in parts]
        return [Table(one[0], one[1:n], one[n:]) for one in cut]


def table_of(result, law):
    """`Table` of a result under one of its laws."""
    parts = results_by_law_of_steps(result)
    part = parts[law]
    names = part["parameter"].values.tolist()
    columns = [
        _Column(parts, law, name)
        for name in names
        if name not in (*TRENDS, "mu0") and np.isfinite(part[name].values).any()
    ]
    steps = [part.isel(step=i) for i in range(part.sizes["step"])]
    lines = [[*HEADS, *(column.head for column in columns)]]
    lines += [[*_happening(step), *(column.cell(step) for column in columns)] for step in steps]
    for label, name, error in TOGETHER:
        cells = [column.of_all(name, error) for column in columns]
        lines += [[label, "", "", *cells]] if set(cells) - {NONE, "0"} else []
    notes = [_note(step) for step in steps]
    if any(notes):
        below = len(lines) - len(notes) - 1
        lines = [[*a, b] for a, b in zip(lines, ["note", *notes, *below * [""]], strict=True)]
    n = len(steps) + 1
    return Table(lines[0], lines[1:n], lines[n:])


def _happening(step):
    return str(int(step["step"])), f"{float(step['step_t']):.1f}", change_text(step)


def _note(step):
    """Whether a step is stick-slip or failed, or how many warnings it carries."""
    status = int(step["status"])
    if status in (FAILED, STICK_SLIP):
        return "failed" if status == FAILED else "stick-slip"
    return _counted(len(str(step["warnings"].item()).splitlines()))


def _counted(count):
    return "" if not count else "1 warning" if count == 1 else f"{count} warnings"


class _Column:
    """An estimate along the steps under a law, in a unit that fits it under all laws."""

    def __init__(self, parts, law, symbol):
        self.part, self.symbol = parts[law], symbol
        unit = QUANTITIES[symbol].unit
        sizes = [np.abs(part[symbol].values) for part in parts.values()]
        found = [size[np.isfinite(size)] for size in sizes if np.isfinite(size).any()]
        typical = max(float(np.median(size)) for size in found)
        power = power_of(unit, typical)
        text = f" [{prefixed_unit(unit, power)}]"
        if unit == "1":
            power, text = (-3, " [1e-3]") if typical < SMALL else (0, "")
        self.factor = 10.0**-power
        is_rate = symbol == "a_minus_b"
        self.head = (rate_dependence_text([friction_law(law)]) if is_rate else symbol) + text

    def cell(self, step):
        """The estimate of a step with its error, or its bound where that is all that is known."""
        here = step.sel(parameter=self.symbol)
        infinite = np.array([-np.inf, np.inf])
        at = infinite if self.symbol in SUMS else to_value(self.symbol, infinite)
        ends = here["interval"].values[-1]
        is_open = ends == at
        if is_open.sum() == 1:  # such as "< 0.16"
            return f"{'>' if is_open[1] else '<'} {short(self.factor * ends[~is_open][0])}"
        return _concise(here[self.symbol], here["standard_error"], self.factor)

    def of_all(self, name, error):
        """What all steps tell: a variable along ``parameter``, with its error if there is one."""
        here = self.part.sel(parameter=self.symbol)
        factor = 1.0 if name == "up_over_down" else self.factor
        return _concise(here[name], np.nan if error is None else here[error], factor)


def _concise(value, error, factor):
    """A number, multiplied by a factor, with its error where that is finite; `NONE` for NaN."""
    value, error = factor * float(value), factor * float(error)
    if not np.isfinite(value):
        return NONE
    return concise(value, error) if 0.0 < error < np.inf else f"{value:.3g}"


def change_text(step):
    """What changes: "3 -> 10 um/s", "hold 30 s, 3 um/s" or "sigma 8 -> 8.8 MPa"."""
    before, after = float(step["V_before"]), float(step["V_after"])
    kind = str(step["kind"].item())
    if kind == "hold":
        then = readable("V_lp", after, 3) if np.isfinite(after) else "to the record's end"
        return f"hold {readable('t', float(step['t_hold']), 3)}, {then}"
    if kind == "normal stress":
        ends = (float(step[name]) for name in ("sigma", "sigma_after"))
        return f"sigma {readable_change('sigma', *ends)}"
    return readable_change("V_lp", before, after)


def heading_of_steps(result):
    """What was fitted, as one line."""
    source = attributes.text(result, "source", "")
    about = f"Fits of {source}: " if source else "Fits of "
    laws = law_names(tuple(results_by_law_of_steps(result)))
    counted = [(int((result["kind"] == kind).sum()), names) for kind, names in KINDS.items()]
    counts = ", ".join(f"{n} {names[n > 1]}" for n, names in counted if n)
    return f"{about}{counts}, {laws}"


def remarks_on_steps(result):
    """The lines below the tables of steps: comparison of the laws, failures (list of str)."""
    parts = results_by_law_of_steps(result)
    texts = [attributes.text(result, "comparison", "")]
    for law, part in parts.items():
        texts += [f"{law} law: {text}" for text in (*_on_one_set(part), *_on_symmetry(part))]
    first = next(iter(parts.values()))  # a step is stick-slip under every law
    texts += [f"step {i}: {message}" for i, message in _messages(first, STICK_SLIP)]
    for law, part in parts.items():
        failed = _messages(part, FAILED)
        texts += [f"step {i}, {law} law, failed: {message}" for i, message in failed]
    return [text for text in texts if text]


def _messages(part, status):
    """Number and message of each step with this status (list of pairs), of one law's part."""
    which = np.flatnonzero(part["status"].values == status).tolist()
    return [(i + 1, part["message"].values[i]) for i in which]


def warnings_on_steps(result, where):
    """The warnings of the law that fits best; of others how many there are, and where (list)."""
    texts, best = [], _best_law(result)
    for law, part in results_by_law_of_steps(result).items():
        if law == best:
            texts += [
                f"{steps}, {law} law, warning: {text}" for steps, text in warnings_by_text(part)
            ]
        elif counted := _counted(sum(len(x.splitlines()) for x in part["warnings"].values)):
            texts.append(f"{law} law: {counted}, {where}")
    return texts


def warnings_by_text(part):
    """Pairs of which steps, such as "steps 3, 9", and a warning on these, of one law's part."""
    steps: dict[str, list[str]] = {}
    for i, several in enumerate(part["warnings"].values.tolist(), 1):
        for text in several.splitlines():
            steps.setdefault(text, []).append(str(i))
    return [
        (f"step{'s' if len(of) > 1 else ''} {', '.join(of)}", text) for text, of in steps.items()
    ]


def _best_law(result):
    """Of a result of steps the law with the least AIC over all steps in which all are fitted."""
    laws = [*results_by_law_of_steps(result)]
    if len(laws) == 1 or not bool(result["aic_difference"].notnull().any()):
        return laws[0]
    return laws[int(result["aic_difference"].sum("step").argmin("law"))]


def _on_one_set(part):
    """A sentence on whether one set of parameters serves all steps, where there is a joint fit."""
    p, degrees = float(part["shared_p_value"]), int(part["shared_degrees"])
    if not np.isfinite(p):
        return
    verdict = "serves" if p >= IMPROBABLE else "does not serve"
    rise = short(float(part["shared_deviance"]))
    yield (
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


def rows_of(result):
    """The Dataset of a row for each step, under one law after the other, along ``step``.

    Estimates of a result of steps with their standard errors, as ``a`` and ``a_error``.
    """
    parts, tables = results_by_law_of_steps(result), []
    for law, part in parts.items():
        several = len(parts) > 1
        columns = {"law": ("step", np.full(part.sizes["step"], law))} if several else {}
        columns |= {name: part[name].variable for name in BEFORE}
        for name in result["parameter"].values.tolist():
            error = part["standard_error"].sel(parameter=name).assign_attrs(part[name].attrs)
            columns |= {name: part[name].variable, f"{name}_error": error.variable}
        columns |= {name: part[name].variable for name in AFTER if name in part}
        tables.append(xarray.Dataset(columns, {"step": part["step"].variable}))
    return xarray.concat(tables, "step", combine_attrs="drop_conflicts")
