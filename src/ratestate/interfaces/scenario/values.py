"""Values of a scenario file: a number, a string with a unit, a list, or an axis between two ends.

All are bit-for-bit the floats of the Python API.  A value that becomes one with the slider's area
or sigma (`model.parameters`) stays the text that it is.  An axis is kept as two ends and a number
until the number of cases has been checked.  Values of an unusual magnitude are refused, where the
Python API takes any: so a wrong unit or exponent is reported before it costs minutes or overflows.
"""

import math
from collections.abc import Iterable
from decimal import Decimal
from typing import Any, NamedTuple

import numpy as np

from ...model.names import one_of
from ...model.parameters import logspace, quantity_of
from ...model.quantities import KINDS, QUANTITIES, attrs, remedy
from ...model.units import to_si
from .problems import Place, choice, refusal, shown

#: largest number of values along one axis, and of saved times
LONGEST = 10**6
LONGEST_TEXT = 100  # characters of a number with its unit
AXIS = '{ from = "100 kg/m^2", to = "1e5 kg/m^2", n = 12, scale = "log" }'
AXIS_KEYS = ("from", "to", "n", "scale")
#: symbol, or unit of all others -> smallest magnitude except 0, and largest.  Wider than anything
#: measured or imagined, and so narrow that no product of them leaves the range of doubles.
USUAL = {
    "a": (1e-12, 100.0),
    "b": (0.0, 100.0),
    "mu0": (0.0, 1e3),
    "theta": (1e-20, 1e40),
    "m": (1e-15, 1e9),
    "s": (1e-20, 1e18),
    "Hz": (1e-18, 1e20),
    "m/s": (1e-50, 1e5),
    "Pa": (1e-9, 1e15),
    "Pa/m": (1e-20, 1e25),
    "kg/m^2": (1e-20, 1e20),
    "m^2": (1e-20, 1e15),
    "N": (1e-20, 1e25),
    "N/m": (1e-20, 1e25),
    "kg": (1e-20, 1e25),
    "1/m": (1e-15, 1e15),
}


class AxisRange(NamedTuple):
    """Values in SI between two ends, which are exact."""

    first: float
    last: float
    size: int
    scale: str
    quantity: str = ""  # that the values are, if not the axis's own

    def values(self, symbol: str) -> np.ndarray:
        """The values, shape (size,), rounded to 15 digits like those of `ratestate.logspace`."""
        if self.scale == "log":
            return logspace(symbol, self.first, self.last, self.size).values
        # Exact until rounded, so that an axis through 0 contains 0.
        first, last, m = Decimal(repr(self.first)), Decimal(repr(self.last)), self.size - 1
        between = ((first * (m - i) + last * i) / m for i in range(1, m))
        return np.array([self.first, *(float(f"{x:.15g}") for x in between), self.last])


class AxisList(NamedTuple):
    """Values in SI, one by one."""

    numbers: tuple[float, ...]
    quantity: str = ""  # that they are, if not the axis's own

    @property
    def size(self) -> int:
        """How many there are."""
        return len(self.numbers)

    def values(self, symbol: str) -> np.ndarray:
        """The values, shape (size,)."""
        return np.array(self.numbers)


Many = AxisRange | AxisList


def as_array(symbol: str, value: float | Many) -> np.ndarray:
    """Values as a plain array, shape (n,); (1,) for a single one."""
    return value.values(symbol) if isinstance(value, Many) else np.atleast_1d(value)


def as_axis(symbol: str, many: Many) -> Any:
    """Values as a DataArray along a dimension and coordinate of their own, all named `symbol`.

    With the attribute ``units`` if they are of another quantity.
    """
    import xarray

    values, units = as_array(symbol, many), attrs(many.quantity or symbol)
    own = units if many.quantity else None
    return xarray.DataArray(values, {symbol: (symbol, values, units)}, (symbol,), symbol, own)


def unusual(symbol: str, x: float) -> str:
    """The limits that a value [SI] is beyond, as text; "" for others, 0 and inf among them."""
    unit = QUANTITIES[symbol].unit
    low, high = USUAL.get(symbol) or USUAL.get(unit, (0.0, math.inf))
    if x == 0.0 or math.isinf(x) or low <= abs(x) <= high:
        return ""
    sizes = f"{low:g} to {high:g}" if low else f"up to {high:g}"
    return sizes if unit == "1" else f"{sizes} {unit}"


def number(symbol: str, value: Any, bound: str | None = None) -> float | str:
    """One value in SI; ParameterError: no number, another unit, out of range, unusual magnitude.

    As it is, checked likewise, if it is a parameter of the slider given as another quantity.

    bound : range in place of the quantity's own, as of `to_si`
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise refusal("value.no_number", given=value, wanted=remedy(symbol))
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        raise refusal("value.too_long", given=value, wanted=remedy(symbol))
    quantity = quantity_of(symbol, value)
    try:  # (an integer may have more digits than Python writes into a message)
        given = float(value) if isinstance(value, int) else value
        x = to_si(quantity, given, label=symbol, bound=bound)
    except ArithmeticError:
        raise refusal("value.overflow", given=value, wanted=remedy(symbol)) from None
    if sizes := unusual(quantity, x):
        raise refusal("value.unusual", x=shown(value), sizes=sizes, wanted=remedy(quantity))
    return x if quantity == symbol else str(value)


def read_number(symbol: str, value: Any, place: Place, bound: str | None = None) -> Any:
    """One value as by `number`; None if it has a problem, which is noted."""
    return place.noting(lambda: number(symbol, value, bound), symbol)


def read_values(symbol: str, value: Any, place: Place, bound: str | None = None) -> Any:
    """One value as by `number`, or `Many`; None if there are problems, which are noted."""
    if isinstance(value, dict):
        return _axis(symbol, value, place, bound)
    if not isinstance(value, list):
        return read_number(symbol, value, place, bound)
    if not 1 <= len(value) <= LONGEST:
        place.add("axis.length", n=len(value), most=LONGEST)
        return None
    numbers = []
    for i, element in enumerate(value):
        x = read_number(symbol, element, place.at(i), bound)
        if x is None:  # one bad element is enough
            return None
        numbers.append(x)
    return place.noting(lambda: AxisList(*_of_one_quantity(symbol, numbers)))


def _of_one_quantity(symbol: str, values: list[Any]) -> tuple[tuple[float, ...], str]:
    """Values in SI, and the quantity that all are, "" if the axis's own; else ParameterError."""
    quantity, *others = dict.fromkeys(quantity_of(symbol, value) for value in values)
    if others:
        first, other = (KINDS[QUANTITIES[name].unit][0] for name in (quantity, others[0]))
        raise refusal("axis.quantities", first=first, other=other, wanted=remedy(symbol))
    numbers = (x if isinstance(x, float) else to_si(quantity, x) for x in values)
    return tuple(numbers), "" if quantity == symbol else quantity


def _axis(symbol: str, table: dict[str, Any], place: Place, bound: str | None) -> AxisRange | None:
    """An axis between two ends."""
    before = len(place.problems)
    note_unknown_keys(table, AXIS_KEYS, AXIS, place)
    scales = ("linear", "log")
    scale = place.at("scale").noting(lambda: choice(table.get("scale", "linear"), scales))
    first, last = read_ends(symbol, table, place, "> 0" if scale == "log" else bound)
    n = table.get("n")
    if isinstance(n, bool) or not isinstance(n, int) or not 2 <= n <= LONGEST:
        place.at("n").add("axis.no_n" if n is None else "axis.bad_n", given=n, most=LONGEST)
    elif first is not None and last is not None and scale and len(place.problems) == before:
        ends = place.noting(lambda: _of_one_quantity(symbol, [first, last]))
        if ends:
            (first, last), quantity = ends
            return AxisRange(first, last, n, scale, quantity)
    return None


def read_ends(
    symbol: str, table: dict[str, Any], place: Place, bound: str | None = None
) -> list[Any]:
    """[first, last] of an axis as by `number`, finite; None for one with a problem, noted."""
    ends = []
    for key in ("from", "to"):
        x = read_number(symbol, table[key], place.at(key), bound) if key in table else None
        if key not in table:
            place.missing(key, remedy(symbol))
        elif x is not None and math.isinf(to_si(quantity_of(symbol, x), x, bound="")):
            place.at(key).add("axis.infinite_end", given=x, wanted=remedy(symbol))
            x = None
        ends.append(x)
    return ends


class InlineTable(NamedTuple):
    """A table of numbers: key -> symbol and range, or None for the symbol's own; an example."""

    keys: dict[str, tuple[str, str | None]]
    like: str

    def read(self, table: Any, place: Place) -> dict[str, Any] | None:
        """key -> value in SI, of keys given, or None with a problem, noted; None if no table."""
        if not isinstance(table, dict):
            what = "tables" if self.like.startswith("[") else "a table"
            place.add("table.none", given=table, wanted=f"Give {what} such as {self.like}.")
            return None
        note_unknown_keys(table, self.keys, self.like, place)
        return {
            key: read_number(symbol, table[key], place.at(key), bound)
            for key, (symbol, bound) in self.keys.items()
            if key in table
        }


def note_unknown_keys(table: dict[str, Any], keys: Iterable[str], like: str, place: Place) -> None:
    """Note the keys of an inline table that are none of these."""
    for key in table.keys() - set(keys):
        place.at(key).add("key.unknown", wanted=one_of(keys, key, like))
