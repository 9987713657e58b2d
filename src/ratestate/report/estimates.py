"""Estimates as cells of a table: values, errors and intervals under each law."""

from typing import NamedTuple

import numpy as np
import xarray

from ..model.quantities import QUANTITIES, power_of, prefixed_unit, readable, rounded
from ..records.fitting.by_law import (
    error_of,
    law_of,
    rate_dependence_text,
    stiffness_over_critical,
    value_of,
)

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


class Row(NamedTuple):
    """A quantity: label with the unit, meaning, and estimate under each law."""

    symbol: str
    label: str
    meaning: str
    estimates: list[Cells]


def estimate_rows(laws: Laws) -> list[Row]:
    """Return a row for each estimate, and rows for K/sigma and K/K_c_qs, if known."""
    rows = []
    for symbol in estimated_symbols(laws):
        unit, meaning, *_ = QUANTITIES[symbol]
        power = power_of(unit, largest(laws, symbol))
        label = short_name(symbol, laws)
        label += "" if unit == "1" else f" [{prefixed_unit(unit, power)}]"
        rows.append(Row(symbol, label, meaning, estimate_texts(laws, symbol, 10.0**-power)))
    if any(row.symbol == "K" for row in rows):
        # other programs give the stiffness divided by normal stress
        factor = 1e-6 / value_of(next(iter(laws.values())), "sigma")
        meaning = "stiffness, in friction per displacement"
        cells = estimate_texts(laws, "K", factor)
        rows.append(Row("K/sigma", "K/sigma [1/um]", meaning, cells))
    if any(ratios := [stiffness_ratio_text(part) for part in laws.values()]):
        cells = [(text, "", "") if text else NONE for text in ratios]
        rows.append(Row("K/K_c_qs", "K/K_c_qs", _stability(laws), cells))
    return rows


def estimate_cells(laws: Laws, meaning: bool) -> list[list[str]]:
    """Return rows of cells: label, value and 95 % interval under each law, meaning."""
    return [
        [row.label, *(text for one in row.estimates for text in one[::2]), *[row.meaning] * meaning]
        for row in estimate_rows(laws)
    ]


def estimated_symbols(laws: Laws) -> list[str]:
    """Return symbols estimated under any of these laws, in the order of the result."""
    parts = sorted(laws.values(), key=lambda part: -part.sizes["parameter"])
    return [*dict.fromkeys(str(name) for part in parts for name in part["parameter"].values)]


def largest(laws: Laws, symbol: str) -> float:
    """Return the largest absolute estimate [SI] under any of the laws."""
    return max(abs(value_of(part, symbol)) for part in laws.values() if symbol in part)


def estimate_texts(laws: Laws, symbol: str, factor: float) -> list[Cells]:
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
        usual, wide = (" to ".join(_end(end, digits) for end in pair) for pair in ends)
        cells.append((_plus_minus(value, error, digits), usual, wide))
    return cells


def _end(value: float, digits: float) -> str:
    return rounded(value, digits) if np.isfinite(value) else "(open)"


def _plus_minus(value: float, error: float, digits: float) -> str:
    """Return a value with its error, if finite, rounded as for an error of `digits`."""
    if not 0.0 < digits < np.inf:
        return f"{value:.4g}"
    shown = rounded(value, digits)
    return f"{shown} +- {rounded(error, digits)}" if 0.0 < error < np.inf else shown


def stiffness_ratio_text(part: xarray.Dataset) -> str:
    """Return K/K_c_qs, with a finite error; `STABLE_AT_ANY_K` if K_c_qs <= 0; or ""."""
    if (pair := stiffness_over_critical(part)) is None:
        return ""
    ratio, error = pair
    if np.isinf(ratio):
        return STABLE_AT_ANY_K
    return _plus_minus(ratio, error, error if np.isfinite(error) else ERROR_FOR_DIGITS * ratio)


def _stability(laws: Laws) -> str:
    """Return what K/K_c_qs means, for the side of 1 if all ratios are clearly on it."""
    ratios = [stiffness_over_critical(part) for part in laws.values()]
    sides = {
        np.sign(ratio - 1.0) if abs(ratio - 1.0) > TWO_ERRORS * error else 0.0
        for ratio, error in filter(None, ratios)
    }
    if sides == {-1.0}:
        return "below 1: steady sliding is unstable"
    return "above 1: steady sliding is stable" + (", below it is not" if sides != {1.0} else "")


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


def quality_text(part: xarray.Dataset) -> str:
    """Return how well a law fits."""
    if "chi2" in part:
        features = int(part["used"].sum())
        return f"chi-square {float(part['chi2']):.3g} for {features} features of cycles"
    return f"r.m.s. residual {float(part['rms']):.3g}; noise {noise_text(part)}"


def short_name(symbol: str, laws: Laws) -> str:
    """Return the name of a quantity in tables."""
    return rate_dependence_text(map(law_of, laws.values())) if symbol == "a_minus_b" else symbol
