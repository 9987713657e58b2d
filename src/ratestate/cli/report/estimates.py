"""The estimates of a fit as text: values, errors and intervals, under each law, in one unit."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...quantities import PREFIXES, QUANTITIES, power_of, rounded, short, with_error

if TYPE_CHECKING:
    import xarray

#: names by which people know what has a longer one
NAMES = {"a_minus_b": "a - b"}


class Estimate(NamedTuple):
    """An estimate under one law: with its standard error, and its intervals."""

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
    """All estimates, and what follows from them."""
    from ...fitting.each import stiffness_over_critical

    first = next(iter(laws.values()))
    symbols = [str(symbol) for symbol in first["parameter"].values]
    found = [_line(laws, symbol) for symbol in symbols]
    if "K" in symbols:
        found.append(_per_sigma(laws))
    ratios = [stiffness_over_critical(part) for part in laws.values()]
    if any(ratios):
        cells = tuple(Estimate(with_error(*r) if r else "-", ()) for r in ratios)
        found.append(Line("K/K_c_qs", "", "above 1: steady sliding is stable", cells))
    return found


def _line(laws: "dict[str, xarray.Dataset]", symbol: str) -> Line:
    """The line of a parameter."""
    from ...fitting.each import value_of

    quantity = QUANTITIES[symbol]
    power = power_of(quantity.unit, max(abs(value_of(part, symbol)) for part in laws.values()))
    unit = "" if quantity.unit == "1" else f"{PREFIXES[power]}{quantity.unit}"
    return Line(
        NAMES.get(symbol, symbol),
        unit,
        quantity.long_name.removesuffix(", a - b"),
        tuple(_estimate(part, symbol, 10.0**-power) for part in laws.values()),
    )


def _per_sigma(laws: "dict[str, xarray.Dataset]") -> Line:
    """The stiffness as other programs have it."""
    from ...fitting.each import value_of

    cells = [_estimate(part, "K", 1e-6 / value_of(part, "sigma")) for part in laws.values()]
    return Line("K/sigma", "1/um", "stiffness, in friction per displacement", tuple(cells))


def _estimate(part: "xarray.Dataset", symbol: str, factor: float) -> Estimate:
    from ...fitting.each import error_of, value_of

    value, error = factor * value_of(part, symbol), factor * error_of(part, symbol)
    ends = factor * part["interval"].sel(parameter=symbol).transpose("level", "side").values
    return Estimate(
        with_error(value, error),
        tuple(f"{_end(low, error)} to {_end(high, error)}" for low, high in ends),
    )


def _end(value: float, error: float) -> str:
    """An end of an interval; one that has none is open."""
    return rounded(value, error) if np.isfinite(value) else "(open)"


def noise(part: "xarray.Dataset") -> str:
    """The noise of a record in words."""
    white, red = float(part["noise_white"]), float(part["noise_red"])
    said = f"white {white:.3g}"
    if red > 0.0:
        time = float(part["noise_time"])
        said += f", correlated {red:.3g} over {short(time)} s"
    return said
