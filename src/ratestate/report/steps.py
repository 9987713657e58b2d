"""Reports on fits of steps and holds: a table for each law, sentences, and rows of CSV."""

import re

import numpy as np
import xarray

from ..dynamics.recipe import attribute_text
from ..model.quantities import QUANTITIES, concise, readable, readable_change, short, with_error
from ..records.fitting.by_law import (
    law_names,
    law_of,
    rate_dependence_text,
    results_by_law,
    warnings_of,
)
from ..records.fitting.steps import FAILED, HOLD, NORMAL_STRESS, STEP, STICK_SLIP
from ..records.fitting.unknowns import DERIVED, TRENDS, to_value
from .report import Heading, TextTable, Title, left, numbers_by_text, scale_of

#: heads of the first columns
HEADS = [left("step"), left("time [s]", joined=True), left("change", joined=True)]
#: pattern of a cell -> what it means
NOTATION = {
    r".*\d\(": "In brackets: the standard error of the last digits. 9.19(18) is 9.19 +- 0.18.",
    "< ": "The sign < stands before the upper end of a 95 % interval that is open below.",
    "> ": "The sign > stands before the lower end of a 95 % interval that is open above.",
    "all": "The row all is the fit of one set of parameters to all steps and holds together.",
    "scatter": "The row scatter is the standard deviation between steps beyond their errors.",
    "up/down": "The row up/down is the mean over steps up divided by the mean over steps down.",
}
#: significance level
IMPROBABLE = 0.01
#: least probability that is given as a number: farther tails are not Gaussian
LEAST = 1e-6
#: text in place of an estimate
NONE = "-"
#: kind of step -> its singular and plural
KINDS = {
    STEP: ("velocity step", "velocity steps"),
    HOLD: ("hold", "holds"),
    NORMAL_STRESS: ("step of normal stress", "steps of normal stress"),
}
#: CSV columns before and after the estimates
BEFORE = "kind step_t step_delta_lp V_before V_after t_hold sigma sigma_after".split()
AFTER = "rms aic aic_difference samples status warnings message".split()
#: heads of the joint rows, and their cells in columns without a joint value
JOINT_ROWS, BLANK = ("all", "scatter", "up/down"), ("", "", "")


def blocks(result):
    """Return title, a table for each law, and sentences."""
    tables = {law: table_of(result, law) for law in results_by_law(result)}
    found = [heading_of_steps(result)]
    for law, table in tables.items():
        found += [Title(f"{law} law"), table, ""]
    cells = [cell for table in tables.values() for row in table.rows for cell in row]
    used = [text for mark, text in NOTATION.items() if any(re.match(mark, x) for x in cells)]
    return [*found, *([" ".join(used)] if used else []), *remarks_on_steps(result)]


def table_of(result, law):
    """Return the table of the steps under a law, with joint rows below."""
    parts = results_by_law(result)
    part = parts[law]
    steps = [part.isel(step=i) for i in range(part.sizes["step"])]
    times = [f"{float(step['step_t']):.1f}" for step in steps]
    heads = [*HEADS]
    columns = [
        [*(str(int(step["step"])) for step in steps), *JOINT_ROWS],
        [*times, *BLANK],
        [*map(change_text, steps), *BLANK],
    ]
    for symbol in part["parameter"].values.tolist():
        if symbol in (*TRENDS, "mu0") or not np.isfinite(part[symbol].values).any():
            continue
        head, factor = _head(parts, symbol)
        estimates = part.sel(parameter=symbol)
        joint = [
            _concise(estimates["shared"], estimates["shared_error"], factor),
            _concise(estimates["scatter"], np.nan, factor),
            _concise(estimates["up_over_down"], estimates["up_over_down_error"], 1.0),
        ]
        heads.append(Heading(head))
        columns.append([*(_cell(step, symbol, factor) for step in steps), *joint])
    if any(notes := [*map(_note, steps)]):
        heads.append(left("note"))
        columns.append([*notes, *BLANK])
    rows, n = [list(cells) for cells in zip(*columns, strict=True)], len(steps)
    known = rows[:n] + [row for row in rows[n:] if set(row[len(HEADS) :]) - {NONE, "0", ""}]
    return TextTable(heads, known, splits=True)


def _note(step):
    words = {FAILED: "failed", STICK_SLIP: "stick-slip"}
    count = len(warnings_of(step))
    warnings = f"{count} warning{'s' if count > 1 else ''}" if count else ""
    return words.get(int(step["status"]), warnings)


def _head(parts, symbol):
    sizes = [np.abs(part[symbol].values) for part in parts.values()]
    known = [size[np.isfinite(size)] for size in sizes]
    typical = max(float(np.median(size)) for size in known if size.size)
    factor, unit = scale_of(symbol, typical, in_thousandths=True)
    is_rate = symbol == "a_minus_b"
    name = rate_dependence_text([law_of(fit) for fit in parts.values()]) if is_rate else symbol
    return f"{name} [{unit}]" if unit else name, factor


def _cell(step, symbol, factor):
    """Return the estimate of a step with its error, or its bound if one end is open."""
    estimate = step.sel(parameter=symbol)
    infinite = np.array([-np.inf, np.inf])
    ends = estimate["interval"].values[-1]
    is_open = ends == (infinite if symbol in DERIVED else to_value(symbol, infinite))
    if is_open.sum() == 1:  # such as "< 0.16"
        return f"{'>' if is_open[1] else '<'} {short(factor * ends[~is_open][0])}"
    return _concise(estimate[symbol], estimate["standard_error"], factor)


def _concise(value, error, factor):
    """Return a number times a factor, with a finite error; `NONE` for NaN."""
    value, error = factor * float(value), factor * float(error)
    if not np.isfinite(value):
        return NONE
    return concise(value, error) if 0.0 < error < np.inf else f"{value:.3g}"


def change_text(step):
    """Return the change: "3 -> 10 um/s", "hold 30 s, 3 um/s" or "sigma 8 -> 8.8 MPa"."""
    before, after = float(step["V_before"]), float(step["V_after"])
    kind = str(step["kind"].item())
    if kind == HOLD:
        next_speed = readable("V_lp", after, 3) if np.isfinite(after) else "to the record's end"
        return f"hold {readable('t', float(step['t_hold']), 3)}, {next_speed}"
    if kind == NORMAL_STRESS:
        ends = (float(step[name]) for name in ("sigma", "sigma_after"))
        return f"sigma {readable_change('sigma', *ends)}"
    return readable_change("V_lp", before, after)


def heading_of_steps(result):
    source = attribute_text(result, "source", "")
    title = f"Fits of {source}: " if source else "Fits of "
    laws = law_names(tuple(results_by_law(result)))
    counted = [(int((result["kind"] == kind).sum()), names) for kind, names in KINDS.items()]
    counts = ", ".join(f"{n} {names[n > 1]}" for n, names in counted if n)
    return Title(f"{title}{counts}, {laws}")


def remarks_on_steps(result):
    """Return lines below the tables of steps: comparison, joint fit, failures."""
    parts = results_by_law(result)
    texts = [attribute_text(result, "comparison", "")]
    for law, part in parts.items():
        texts += [f"{law} law: {text}" for text in (*_on_one_set(part), *_on_symmetry(part))]
    for law, part in parts.items():
        outcomes = zip(part["status"].values, part["message"].values, strict=True)
        for i, (status, message) in enumerate(outcomes, 1):
            if status == FAILED:
                texts.append(f"step {i}, {law} law, failed: {message}")
            elif status == STICK_SLIP:  # under every law
                texts.append(f"step {i}: {message}")
    return [*dict.fromkeys(filter(None, texts))]


def warnings_on_steps(result):
    """Return the warnings under every law, each with the numbers of its steps."""
    return [
        f"{steps}, {law} law, warning: {text}"
        for law, part in results_by_law(result).items()
        for steps, text in numbers_by_text(
            "step", enumerate(map(str.splitlines, part["warnings"].values.tolist()), 1)
        )
    ]


def _on_one_set(part):
    """Yield a sentence on whether one set of parameters fits all steps."""
    p, degrees = float(part["shared_p_value"]), int(part["shared_degrees"])
    if not np.isfinite(p):
        return
    verdict = "fits" if p >= IMPROBABLE else "does not fit"
    rise = short(float(part["shared_deviance"]))
    yield (
        f"one set of parameters {verdict} all steps: chi-square is larger by {rise} with {degrees} "
        f"fewer parameters ({_probability(p)})."
    )


def _on_symmetry(part):
    """Yield a sentence on the distances by steps up and steps down."""
    distances = [s for s in part["parameter"].values.tolist() if QUANTITIES[s].unit == "m"]
    for symbol in distances[:1]:
        estimates = part.sel(parameter=symbol)
        keys = ("up_over_down", "up_over_down_error", "up_over_down_p_value")
        ratio, error, p = (float(estimates[key]) for key in keys)
        if np.isfinite(p):
            verdict = "alike" if p >= IMPROBABLE else "not alike"
            yield (
                f"steps up and steps down are {verdict}: {symbol} of steps up is "
                f"{with_error(ratio, error)} times that of steps down ({_probability(p)})."
            )


def _probability(p):
    return f"p = {p:.2g}" if p >= LEAST else f"p < {LEAST:g}"


def rows_of(result):
    """Return a Dataset with a row for each step, one law after the other.

    Estimates and standard errors are called ``a`` and ``a_error``.
    """
    names, errors = result["parameter"].values.tolist(), {}
    for name in names:
        error = result["standard_error"].sel(parameter=name, drop=True)
        errors[f"{name}_error"] = error.assign_attrs(result[name].attrs)
    columns = [*BEFORE, *(x for name in names for x in (name, f"{name}_error"))]
    table = result.assign(errors)[columns + [name for name in AFTER if name in result]]
    if "law" not in table.dims:
        return table
    parts = [table.sel(law=law).reset_coords("law") for law in table["law"].values]
    parts = [part[["law", *table.data_vars]] for part in parts]
    return xarray.concat(parts, "step", data_vars="all")
