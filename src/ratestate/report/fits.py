"""Reports on fits: estimates under each law, how well they fit, and what a record determines."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
import xarray

from ..dynamics.recipe import attribute_text, from_json
from ..model.quantities import QUANTITIES, readable, rounded, short, with_error
from ..records.fitting.by_law import (
    checked_by_law,
    clearly_worse,
    error_of,
    has_steps,
    law_names,
    law_of,
    rate_dependence_text,
    stiffness_over_critical,
    value_of,
    warnings_of,
)
from ..records.fitting.unknowns import motion_symbols
from . import steps
from .report import Blocks, Heading, Report, TextTable, Title, left, scale_of

#: law -> its part of a result, as from `results_by_law`
Laws = dict[str, xarray.Dataset]
#: value with error, 68 and 95 % intervals, as text
Cells = tuple[str, str, str]
#: cells under a law that lacks the quantity
NONE = ("-", "", "")
#: white noise, as a fraction of the correlated noise, below which it is not mentioned
NEGLIGIBLE = 0.05
#: relative error that sets the digits of K/K_c_qs if its own error is not finite
ERROR_FOR_DIGITS = 0.1
#: standard errors by which a ratio must differ from 1 to be clearly on one side
TWO_ERRORS = 2.0
#: text in place of K/K_c_qs if K_c_qs is not positive
STABLE_AT_ANY_K = "stable at any K"


class EstimateRow(NamedTuple):
    """A quantity in a unit (with its prefix, "" if it is a pure number), under each law."""

    symbol: str
    unit: str
    meaning: str
    texts: list[Cells]


def report_on_fit(result: xarray.Dataset) -> Report:
    """Return the report on one fit, or on the fits of steps and holds."""
    laws = checked_by_law(result, "summary")
    notes = from_json(result, "notes", list) if "notes" in result.attrs else []
    notes = [f"note: {note}" for note in notes]
    if has_steps(result):
        return Report([*steps.blocks(result), *notes], steps.warnings_on_steps(result))
    source = attribute_text(result, "source", "")
    worse = clearly_worse(result)
    title = f"Fit of {source + ': ' if source else ''}{result.sizes['time']:,} samples, "
    found = attribute_text(result, "found", "")  # what the load point did
    below = [
        _fixed_parameters(laws),
        *_kinds_of_intervals(laws),
        attribute_text(result, "comparison", ""),
        *(f"{law} law: {part['identifiability'].item()}" for law, part in laws.items()),
        *(
            f"{law} law, which fits clearly worse: {text}"
            for law in worse
            for text in warnings_of(laws[law])
        ),
    ]
    texts = [text for text in below if text and not text.endswith("law: ")]
    quality = _features(laws) if "chi2" in result else _statistics(laws)
    heading = [Title(title + law_names(laws)), *filter(None, [found])]
    return Report(
        [*heading, _table(laws), "", *quality, *texts, *notes],
        [
            f"warning: {law} law: {text}"
            for law, part in laws.items()
            for text in warnings_of(part)
            if law not in worse
        ],
    )


def estimates(
    laws: Laws, scale: Callable[[str, float], tuple[float, str]] = scale_of
) -> list[EstimateRow]:
    """Return all estimates, and K/sigma and K/K_c_qs, if known; scale : as `scale_of`."""
    rows = []
    for symbol in estimated_symbols(laws):
        sizes = [abs(value_of(part, symbol)) for part in laws.values() if symbol in part]
        factor, unit = scale(symbol, max(sizes))
        texts = _texts(laws, symbol, factor)
        rows.append(EstimateRow(symbol, unit, QUANTITIES[symbol].long_name, texts))
    if any(row.symbol == "K" for row in rows):
        # other programs give the stiffness divided by normal stress
        texts = _texts(laws, "K", 1e-6 / value_of(next(iter(laws.values())), "sigma"))
        meaning = "stiffness, in friction per displacement"
        rows.append(EstimateRow("K/sigma", "1/um", meaning, texts))
    ratios = [stiffness_over_critical(part) for part in laws.values()]
    if any(ratios):
        texts = [(_ratio_text(*ratio), "", "") if ratio else NONE for ratio in ratios]
        rows.append(EstimateRow("K/K_c_qs", "", _stability(filter(None, ratios)), texts))
    return rows


def estimated_symbols(laws: Laws) -> list[str]:
    """Return symbols estimated under any of these laws, in the order of the result."""
    parts = sorted(laws.values(), key=lambda part: -part.sizes["parameter"])
    return [*dict.fromkeys(str(name) for part in parts for name in part["parameter"].values)]


def _texts(laws: Laws, symbol: str, factor: float) -> list[Cells]:
    """Return an estimate under each law as text, multiplied by `factor` to leave SI.

    Errors are left out if they are not finite.  An infinite end of an interval reads "(open)".
    """
    cells = []
    for part in laws.values():
        if symbol not in part["parameter"].values:
            cells.append(NONE)
            continue
        value, error = factor * value_of(part, symbol), factor * error_of(part, symbol)
        ends = factor * part["interval"].sel(parameter=symbol).transpose("level", "side").values
        # if one side is open, the closed side sets the digits
        closed = [abs(end - value) for end in ends[0] if np.isfinite(end) and end != 0.0]
        digits = error if np.isfinite(error) else min(closed, default=np.inf)
        usual, wide = (" to ".join(_end_text(end, digits) for end in pair) for pair in ends)
        cells.append((_plus_minus(value, error, digits), usual, wide))
    return cells


def _end_text(value: float, digits: float) -> str:
    return rounded(value, digits) if np.isfinite(value) else "(open)"


def _plus_minus(value: float, error: float, digits: float) -> str:
    """Return a value with its error, if finite, rounded as for an error of `digits`."""
    if not 0.0 < digits < np.inf:
        return f"{value:.4g}"
    shown = rounded(value, digits)
    return f"{shown} +- {rounded(error, digits)}" if 0.0 < error < np.inf else shown


def _ratio_text(ratio: float, error: float) -> str:
    """Return K/K_c_qs, with a finite error; `STABLE_AT_ANY_K` if K_c_qs <= 0."""
    if np.isinf(ratio):
        return STABLE_AT_ANY_K
    return _plus_minus(ratio, error, error if np.isfinite(error) else ERROR_FOR_DIGITS * ratio)


def _stability(ratios: Iterable[tuple[float, float]]) -> str:
    """Return what K/K_c_qs means, for the side of 1 if all ratios are clearly on it."""
    sides = {
        np.sign(ratio - 1.0) if abs(ratio - 1.0) > TWO_ERRORS * error else 0.0
        for ratio, error in ratios
    }
    if sides == {-1.0}:
        return "below 1: steady sliding is unstable"
    return "above 1: steady sliding is stable" + (", below it is not" if sides != {1.0} else "")


def name_of(symbol: str, laws: Laws) -> str:
    """Return the name of a quantity in tables."""
    return rate_dependence_text(map(law_of, laws.values())) if symbol == "a_minus_b" else symbol


def _table(laws: Laws) -> TextTable:
    columns, rows = [left()], []
    for law in laws:
        columns += [Heading(f"{law} law"), Heading("68 % interval", may_go=True, joined=True)]
        columns.append(Heading("95 % interval", joined=True))
    for row in estimates(laws):
        label = name_of(row.symbol, laws) + (f" [{row.unit}]" if row.unit else "")
        rows.append([label, *(text for cells in row.texts for text in cells), row.meaning])
    return TextTable([*columns, left("", may_go=True)], rows, splits=True)


def _statistics(laws: Laws) -> Blocks:
    heads = ["r.m.s. residual", "chi-square, if white", "AIC", "BIC"]
    rows = []
    for law, part in laws.items():
        numbers = [short(float(part[name])) for name in ("aic", "bic")]
        white = f"{float(part['chi2_white']):.3g}"
        rows.append([f"{law} law", f"{float(part['rms']):.3g}", white, *numbers, noise_text(part)])
    note = (
        "Chi-square is the variance of the residuals divided by the variance of the noise from "
        "sample to sample. If it is well above 1, the noise is correlated or the law does not fit. "
        "The errors of the estimates allow for the correlation."
    )
    columns = [left(), *map(Heading, heads), left("noise in friction")]
    return [TextTable(columns, rows), "", note]


def _features(laws: Laws) -> Blocks:
    """Return features of cycles, measured and fitted, and chi-square under each law."""
    first = next(iter(laws.values()))
    rows = []
    for segment in range(first.sizes["segment"]):
        for feature in first["feature"].values.tolist():
            parts = [fit.isel(segment=segment).sel(feature=feature) for fit in laws.values()]
            speed = readable("V_lp", float(parts[0]["segment_V"]))
            measured = with_error(float(parts[0]["measured"]), float(parts[0]["measured_error"]))
            shown = measured if bool(parts[0]["used"]) else "not resolved"
            fitted = [f"{float(fit['fitted']):.5g}" for fit in parts]
            rows.append([speed, feature, shown, *fitted])
    heads = [left("load point"), left("feature"), Heading("measured")]
    texts = [
        f"{law} law: chi-square {float(part['chi2']):.3g} for {int(part['used'].sum())} features "
        "of cycles"
        for law, part in laws.items()
    ]
    columns = [*heads, *(Heading(f"{law} law") for law in laws)]
    return [TextTable(columns, rows, splits=True), "", "Times are in s.", *texts]


def _fixed_parameters(laws: Laws) -> str:
    """Return a sentence with the given parameters, under any of the laws."""
    values: dict[str, float] = {}
    for part in laws.values():
        symbols = motion_symbols(law_of(part))
        if "normal_stress" in part.attrs:
            symbols = (*symbols, "alpha")  # which matters only if normal stress varies
        given = [s for s in symbols if s not in part.data_vars]
        values |= {s: value_of(part, s) for s in (*given, "sigma", "V0")}
    return f"Given: {', '.join(f'{s} = {readable(s, value)}' for s, value in values.items())}."


def _kinds_of_intervals(laws: Laws) -> list[str]:
    """Return sentences on the intervals that are not from the covariance."""
    texts = []
    for law, part in laws.items():
        symbols: dict[str, list[str]] = {}
        for symbol, kind in zip(
            part["parameter"].values.tolist(), part["interval_kind"].values.tolist(), strict=True
        ):
            symbols.setdefault(kind, []).append(name_of(symbol, {law: part}))
        symbols.pop("covariance", None)
        texts += [
            f"{law} law: the intervals of {', '.join(listed)} are from the {kind}, and +- is half "
            "the 68 % interval."
            for kind, listed in symbols.items()
        ]
    return texts


def noise_text(part: xarray.Dataset) -> str:
    """Return size and correlation time of a record's noise."""
    white, red = float(part["noise_white"]), float(part["noise_red"])
    if not red > 0.0:
        return f"{white:.2g}, white"
    exponent = float(part.get("noise_exponent", 0.0))  # results of older versions have none
    if exponent > 0.0:
        correlated = f"{red:.2g}, with a spectrum of 1/f^{exponent:.2g}"
    else:
        correlated = f"{red:.2g}, correlated over {readable('t', float(part['noise_time']), 3)}"
    return correlated if white < NEGLIGIBLE * red else f"{white:.2g}, white, and {correlated}"
