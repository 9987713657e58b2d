"""Fits of steps as text: a row for each step, what all tell together, which law they prefer."""

from typing import NamedTuple

import numpy as np

from ....friction.laws import friction_law
from ....model.quantities import QUANTITIES, power_of, prefixed_unit, readable, rounded, short
from ..table import rate_dependence_text
from ..unknowns import TRENDS
from .result import FAILED, STICK_SLIP

#: heads of the columns on what the load point does
HEADS = ("step", "kind", "time [s]", "load point")
#: pure numbers below this are given in thousandths
SMALL = 0.1
#: in place of an estimate
NONE = "-"
#: probability that counts as small
IMPROBABLE = 0.01
#: least probability that is told as a number: Gaussian tails mean nothing so far out
LEAST = 1e-6


class Table(NamedTuple):
    """The steps under one law: heads of the columns, rows of cells, and rows on all steps."""

    heads: list
    rows: list
    together: list


def is_of_steps(result):
    """Whether a result of `fit` is one of steps."""
    return "step" in result.dims


def table_of(result, law):
    """`Table` of a result under one of its laws."""
    part = results_by_law_of_steps(result)[law]
    symbols = [
        symbol
        for symbol in part["parameter"].values.tolist()
        if symbol not in (*TRENDS, "mu0") and np.isfinite(part[symbol].values).any()
    ]
    columns = [_Column(part, symbol) for symbol in symbols]
    heads = [*HEADS, *(column.head for column in columns), "note"]
    rows = [
        [*_what(part.isel(step=i)), *(column.cell(i) for column in columns), _note(part, i)]
        for i in range(part.sizes["step"])
    ]
    blank = [""] * (len(HEADS) - 1)
    together = [
        [label, *blank, *(column.of_all(name, error) for column in columns), ""]
        for label, name, error in (
            ("all", "shared", "shared_error"),
            ("scatter", "scatter", None),
            ("up/down", "up_over_down", "up_over_down_error"),
        )
    ]
    together = [row for row in together if any(cell not in ("", NONE, "0") for cell in row[1:])]
    return Table(heads, rows, together)


def results_by_law_of_steps(result):
    """dict law -> that law's part of a result of steps."""
    if "law" not in result.dims:
        return {str(result["law"].item()): result}
    return {str(law): result.sel(law=law) for law in result["law"].values}


class _Column:
    """An estimate along the steps, in a unit that fits."""

    def __init__(self, part, symbol):
        self.part, self.symbol = part, symbol
        quantity, values = QUANTITIES[symbol], np.abs(part[symbol].values)
        typical = float(np.nanmedian(values)) if np.isfinite(values).any() else 1.0
        power = power_of(quantity.unit, typical)
        unit = f" [{prefixed_unit(quantity.unit, power)}]"
        if quantity.unit == "1":
            power, unit = (-3, " [1e-3]") if typical < SMALL else (0, "")
        self.factor = 10.0**-power
        is_rate = symbol == "a_minus_b"
        law = friction_law(str(part["law"].item()))
        self.head = (rate_dependence_text([law]) if is_rate else symbol) + unit

    def cell(self, i):
        """The estimate of a step, with its error."""
        error = self.part["standard_error"].isel(step=i).sel(parameter=self.symbol)
        return self._text(self.part[self.symbol].values[i], float(error))

    def of_all(self, name, error):
        """What all steps tell: a variable along ``parameter``, with its error if there is one."""
        here = self.part.sel(parameter=self.symbol)
        own = np.nan if error is None else float(here[error])
        if name == "up_over_down":
            return _plus_minus(float(here[name]), own)
        return self._text(float(here[name]), own)

    def _text(self, value, error):
        return _plus_minus(self.factor * value, self.factor * error)


def _plus_minus(value, error):
    """A number with its error where that is finite; `NONE` for NaN."""
    if not np.isfinite(value):
        return NONE
    if not 0.0 < error < np.inf:
        return f"{value:.3g}"
    return f"{rounded(value, error)} +- {rounded(error, error)}"


def _what(step):
    """Number, kind, time, and the load point's speeds or hold."""
    before, after = float(step["V_before"]), float(step["V_after"])
    kind = str(step["kind"].item())
    if kind == "hold":
        then = readable("V_lp", after, 3) if np.isfinite(after) else "to the record's end"
        what = f"{readable('t', float(step['t_hold']), 3)}, {then}"
    elif kind == "normal stress":
        what = readable("V_lp", after, 3)
    else:
        power = power_of("m/s", max(before, after))
        one, other = (f"{x / 10.0**power:.3g}" for x in (before, after))
        what = f"{one} -> {other} {prefixed_unit('m/s', power)}"
    return str(int(step["step"])), kind, f"{float(step['step_t']):.1f}", what


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
                f"{_plus_minus(ratio, error)} times that of steps down ({_probability(p)})."
            )


def _probability(p):
    """A probability, but none so small that nothing is known of it."""
    return f"p = {p:.2g}" if p >= LEAST else f"p < {LEAST:g}"
