"""The table of estimates as text: values, errors and intervals under each law, in one unit."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import xarray

from ...friction.law import FrictionLaw
from ...model.quantities import QUANTITIES, power_of, prefixed_unit, readable, rounded
from .by_law import critical_stiffness, error_of, law_of, stiffness_over_critical, value_of

#: law -> its part of a result, as from `results_by_law`
Laws = dict[str, xarray.Dataset]
#: white noise below this part of the correlated noise is not mentioned
NEGLIGIBLE = 0.05
#: relative error that sets the digits of K/K_c_qs where its own error is not finite
ERROR_FOR_DIGITS = 0.1
#: errors by which a ratio must be off 1 to be on one side of it
TWO_ERRORS = 2.0
#: text in place of K/K_c_qs where K_c_qs is not positive
STABLE_AT_ANY_K = "stable at any K"


class FormattedEstimate(NamedTuple):
    """An estimate under one law, with its error and its intervals, as text."""

    value: str
    intervals: tuple[str, ...]  # one for each level


#: under a law that does not have the quantity
NONE = FormattedEstimate("-", ())


class Row(NamedTuple):
    """A quantity: its symbol, unit and meaning, and its estimate under each law."""

    symbol: str
    unit: str
    meaning: str
    estimates: tuple[FormattedEstimate, ...]

    @property
    def label(self) -> str:
        """Such as "Dc [um]"; without brackets where it has no unit."""
        return f"{self.symbol} [{self.unit}]" if self.unit else self.symbol


def estimate_rows(laws: Laws) -> list[Row]:
    """Rows of all estimates, of K/sigma if K is one, and of K/K_c_qs if any law has a text."""
    symbols = estimated(laws)
    rows = [_row(laws, symbol) for symbol in symbols]
    if "K" in symbols:
        # the stiffness per normal stress, as other programs have it
        factors = {law: 1e-6 / value_of(part, "sigma") for law, part in laws.items()}
        cells = tuple(formatted_estimate(part, "K", factors[law]) for law, part in laws.items())
        rows.append(Row("K/sigma", "1/um", "stiffness, in friction per displacement", cells))
    if any(ratios := [stiffness_ratio_text(part) for part in laws.values()]):
        cells = tuple(FormattedEstimate(text, ()) if text else NONE for text in ratios)
        rows.append(Row("K/K_c_qs", "", _stability(laws), cells))
    return rows


def _stability(laws: Laws) -> str:
    """What K/K_c_qs says under all laws: of values clearly on one side of 1 that alone."""
    sides = set()
    for part in laws.values():
        if (found := stiffness_over_critical(part)) is not None:
            ratio, error = found
            sides.add(np.sign(ratio - 1.0) if abs(ratio - 1.0) > TWO_ERRORS * error else 0.0)
    if sides == {-1.0}:
        return "below 1: steady sliding is unstable"
    return "above 1: steady sliding is stable" + (", below it is not" if sides - {1.0} else "")


def estimated(laws: Laws) -> list[str]:
    """Symbols of what was estimated under any of these laws, in the order of the result."""
    parts = sorted(laws.values(), key=lambda part: -part.sizes["parameter"])
    names = dict.fromkeys(str(name) for part in parts for name in part["parameter"].values)
    return [*names]


def estimate_cells(laws: Laws, meaning: bool) -> list[list[str]]:
    """The rows as cells: label, value and 95 % interval under each law, the meaning if wanted."""
    return [
        [
            row.label,
            *(text for e in row.estimates for text in (e.value, (e.intervals or ("",))[-1])),
            *([row.meaning] if meaning else []),
        ]
        for row in estimate_rows(laws)
    ]


def stiffness_ratio_text(part: xarray.Dataset) -> str:
    """K/K_c_qs +- error if finite; `STABLE_AT_ANY_K` if K_c_qs <= 0.

    "" if K = inf, and under a law with a speed of its own, on which K_c_qs depends.
    """
    critical = critical_stiffness(part)
    if critical is not None and critical <= 0.0:
        return STABLE_AT_ANY_K
    if (ratio_and_error := stiffness_over_critical(part)) is None:
        return ""
    ratio, error = ratio_and_error
    return _plus_minus(ratio, error, error if np.isfinite(error) else ERROR_FOR_DIGITS * ratio)


def _plus_minus(value: float, error: float, digits: float) -> str:
    """A value, with its error where that is finite, rounded as for an error of `digits`."""
    if not 0.0 < digits < np.inf:
        return f"{value:.4g}"
    shown = rounded(value, digits)
    return f"{shown} +- {rounded(error, digits)}" if 0.0 < error < np.inf else shown


def noise_text(part: xarray.Dataset) -> str:
    """Size and correlation time of a record's noise."""
    white, red = float(part["noise_white"]), float(part["noise_red"])
    if not red > 0.0:
        return f"{white:.2g}, white"
    exponent = float(part.get("noise_exponent", 0.0))  # (older results have none)
    if exponent > 0.0:
        correlated = f"{red:.2g}, with a spectrum of 1/f^{exponent:.2g}"
    else:
        correlated = f"{red:.2g}, correlated over {readable('t', float(part['noise_time']), 3)}"
    return correlated if white < NEGLIGIBLE * red else f"{white:.2g}, white, and {correlated}"


def quality_text(part: xarray.Dataset) -> str:
    """How well a law fits."""
    if "chi2" in part:
        features = int(part["used"].sum())
        return f"chi-square {float(part['chi2']):.3g} for {features} features of cycles"
    return f"r.m.s. residual {float(part['rms']):.3g}; noise {noise_text(part)}"


def law_names(laws: Laws | tuple[str, ...]) -> str:
    """The laws by name.

    >>> law_names(("mine",)), law_names(("mine", "yours", "theirs"))
    ('mine law', 'mine, yours and theirs laws')
    """
    *others, last = laws
    return f"{', '.join(others)} and {last} laws" if others else f"{last} law"


def short_name(symbol: str, laws: Laws) -> str:
    """A quantity as tables call it: by its symbol, or "a - b" where it has a longer one."""
    return rate_dependence_text(map(law_of, laws.values())) if symbol == "a_minus_b" else symbol


def rate_dependence_text(laws: Iterable[FrictionLaw]) -> str:
    """What "a_minus_b" is under these laws: a - b unless one has more states, or other friction."""
    return "a - b" if all(law.one_length for law in laws) else "d mu_ss/d ln V"


def _row(laws: Laws, symbol: str) -> Row:
    """The row of a parameter."""
    quantity = QUANTITIES[symbol]
    has = {law: part for law, part in laws.items() if symbol in part["parameter"].values}
    power = power_of(quantity.unit, max(abs(value_of(part, symbol)) for part in has.values()))
    unit = "" if quantity.unit == "1" else prefixed_unit(quantity.unit, power)
    return Row(
        short_name(symbol, laws),
        unit,
        quantity.long_name,
        tuple(
            formatted_estimate(part, symbol, 10.0**-power) if law in has else NONE
            for law, part in laws.items()
        ),
    )


def formatted_estimate(part: xarray.Dataset, symbol: str, factor: float) -> FormattedEstimate:
    """A parameter of one law's part, multiplied by `factor` to leave SI.

    Without its error where that is not finite; an infinite end of an interval reads "(open)".
    """
    value, error = factor * value_of(part, symbol), factor * error_of(part, symbol)
    ends = factor * part["interval"].sel(parameter=symbol).transpose("level", "side").values
    # of an interval open on one side, the closed side sets the digits
    closed = [abs(end - value) for end in ends[0] if np.isfinite(end) and end != 0.0]
    digits = error if np.isfinite(error) else min(closed, default=np.inf)
    return FormattedEstimate(
        _plus_minus(value, error, digits),
        tuple(f"{_end(low, digits)} to {_end(high, digits)}" for low, high in ends),
    )


def _end(value: float, digits: float) -> str:
    """An end of an interval; one at infinity is open."""
    return rounded(value, digits) if np.isfinite(value) else "(open)"
