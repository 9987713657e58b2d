"""The estimates of a fit as text: values, errors and intervals, under each law, in one unit."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...model.quantities import PREFIXES, QUANTITIES, power_of, readable, rounded
from .each import error_of, stiffness_over_critical, value_of

if TYPE_CHECKING:
    import xarray

#: names by which people know what has a longer one
NAMES = {"a_minus_b": "a - b"}
#: of the correlated noise, the part below which white noise is not worth a word
NEGLIGIBLE = 0.05
#: error, in parts of K/K_c_qs, in the digits of which it is told if its own is not finite
VAGUE = 0.1
#: instead of K/K_c_qs, where K_c_qs is not positive
ALWAYS = "a > b: stable at any K"


class Estimate(NamedTuple):
    """An estimate under one law: with its error, and its intervals."""

    value: str
    intervals: tuple[str, ...]  # one for each level


class Line(NamedTuple):
    """A quantity: symbol, unit, what it is, and what it is under each law."""

    symbol: str
    unit: str
    meaning: str
    each: tuple[Estimate, ...]

    @property
    def label(self) -> str:
        return f"{self.symbol} [{self.unit}]" if self.unit else self.symbol


def lines(laws: "dict[str, xarray.Dataset]") -> list[Line]:
    """All estimates, and what follows from them; laws as `each_law` gives them."""
    first = next(iter(laws.values()))
    symbols = [str(symbol) for symbol in first["parameter"].values]
    found = [_line(laws, symbol) for symbol in symbols]
    if "K" in symbols:
        found.append(_per_sigma(laws))
    if any(ratios := [over_critical(part) for part in laws.values()]):
        cells = tuple(Estimate(text or "-", ()) for text in ratios)
        found.append(Line("K/K_c_qs", "", "above 1: steady sliding is stable", cells))
    return found


def over_critical(part: "xarray.Dataset") -> str:
    """K/K_c_qs of one law's part with its error, or why there is none; "" of a rigid machine."""
    if value_of(part, "a") > value_of(part, "b"):
        return ALWAYS
    if (found := stiffness_over_critical(part)) is None:
        return ""
    ratio, error = found
    return _plus_minus(ratio, error, error if np.isfinite(error) else VAGUE * ratio)


def _plus_minus(value: float, error: float, digits: float) -> str:
    """A value with its error, if there is one, in the digits that an error of `digits` leaves."""
    if not 0.0 < digits < np.inf:
        return f"{value:.4g}"
    shown = rounded(value, digits)
    return f"{shown} +- {rounded(error, digits)}" if 0.0 < error < np.inf else shown


def noise(part: "xarray.Dataset") -> str:
    """The noise of a record in words."""
    white, red = float(part["noise_white"]), float(part["noise_red"])
    if not red > 0.0:
        return f"{white:.2g}, white"
    said = f"{red:.2g}, correlated over {readable('t', float(part['noise_time']), 3)}"
    return said if white < NEGLIGIBLE * red else f"{white:.2g}, white, and {said}"


def quality(part: "xarray.Dataset") -> str:
    """How well a law fits, in words."""
    if "chi2" in part:
        features = int(part["used"].sum())
        return f"chi-square {float(part['chi2']):.3g} for {features} features of cycles"
    return f"r.m.s. residual {float(part['rms']):.3g}; noise {noise(part)}"


def named(laws: "dict[str, xarray.Dataset] | tuple[str, ...]") -> str:
    """The laws in words.

    >>> named(("slip",)), named(("slip", "aging"))
    ('slip law', 'slip and aging laws')
    """
    return f"{' and '.join(laws)} {'law' if len(laws) == 1 else 'laws'}"


def _line(laws: "dict[str, xarray.Dataset]", symbol: str) -> Line:
    """The line of a parameter."""
    quantity = QUANTITIES[symbol]
    power = power_of(quantity.unit, max(abs(value_of(part, symbol)) for part in laws.values()))
    unit = "" if quantity.unit == "1" else f"{PREFIXES[power]}{quantity.unit}"
    return Line(
        NAMES.get(symbol, symbol),
        unit,
        quantity.long_name.removesuffix(", a - b"),
        tuple(estimate(part, symbol, 10.0**-power) for part in laws.values()),
    )


def _per_sigma(laws: "dict[str, xarray.Dataset]") -> Line:
    """The stiffness as other programs have it."""
    cells = [estimate(part, "K", 1e-6 / value_of(part, "sigma")) for part in laws.values()]
    return Line("K/sigma", "1/um", "stiffness, in friction per displacement", tuple(cells))


def estimate(part: "xarray.Dataset", symbol: str, factor: float) -> Estimate:
    """A parameter of one law's part, in a unit that is SI over `factor`."""
    value, error = factor * value_of(part, symbol), factor * error_of(part, symbol)
    ends = factor * part["interval"].sel(parameter=symbol).transpose("level", "side").values
    # of an open interval, the side that is closed tells how far the value is known
    reach = [abs(end - value) for end in ends[0] if np.isfinite(end) and end != 0.0]
    digits = error if np.isfinite(error) else min(reach, default=np.inf)
    return Estimate(
        _plus_minus(value, error, digits),
        tuple(f"{_end(low, digits)} to {_end(high, digits)}" for low, high in ends),
    )


def _end(value: float, digits: float) -> str:
    """An end of an interval; one that has none is open."""
    return rounded(value, digits) if np.isfinite(value) else "(open)"
