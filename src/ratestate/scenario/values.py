"""Values of a scenario file: a number, a string with a unit, a list, or an axis between two ends.

All are bit-for-bit the floats of the Python API.  A value that becomes a parameter only with the
slider's area or sigma (`model.parameters`) stays the text that it is.  An axis is expanded after
the number of cases has been checked.  Values of an unusual magnitude are refused, although the
Python API takes any: a wrong unit or exponent is reported before it costs minutes or overflows.
"""

import functools
import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from ..model.names import one_of
from ..model.parameters import evenly_spaced, logspace, quantity_of
from ..model.quantities import KINDS, QUANTITIES, attrs
from ..model.units import to_si
from .problems import Place, choice, refusal, shown

#: largest number of values along one axis, of saved times, and of rows of a record
LONGEST = 10**6
LONGEST_TEXT = 100  # characters of a number with its unit
AXIS = '{ from = "100 kg/m^2", to = "1e5 kg/m^2", n = 12, scale = "log" }'
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


class Many(NamedTuple):
    """Values in SI that a list gives, or an axis between two ends."""

    size: int
    array: Callable[[], np.ndarray]  # returns the values, shape (size,)
    quantity: str  # of the values

    def axis(self, symbol: str) -> Any:
        """Return a DataArray along a dimension and coordinate of its own, all named `symbol`.

        It has the attribute ``units`` if its values are of another quantity than its symbol.
        """
        import xarray

        values, units = self.array(), attrs(self.quantity)
        other = units if self.quantity != symbol else None
        return xarray.DataArray(values, {symbol: (symbol, values, units)}, (symbol,), symbol, other)


def number(symbol: str, value: Any, bound: str | None = None) -> float | str:
    """Return a value in SI, or its text if it is a slider's parameter given as another quantity.

    Raises ParameterError for another type or unit, out of range, and for an unusual magnitude.

    bound : range in place of the quantity's own, as of `to_si`
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise refusal("value.no_number", given=value, wanted=QUANTITIES[symbol].remedy)
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        raise refusal("value.too_long", given=value, wanted=QUANTITIES[symbol].remedy)
    quantity = quantity_of(symbol, value)
    try:  # (an integer may have more digits than Python writes into a message)
        given = float(value) if isinstance(value, int) else value
        x = to_si(quantity, given, label=symbol, bound=bound)
    except ArithmeticError:
        raise refusal("value.overflow", given=value, wanted=QUANTITIES[symbol].remedy) from None
    refuse_unusual(quantity, x, shown(value))
    return x if quantity == symbol else str(value)


def refuse_unusual(quantity: str, x: float, text: str) -> None:
    """Raise ParameterError for a magnitude beyond the usual; 0 and inf pass."""
    unit = QUANTITIES[quantity].unit
    low, high = USUAL.get(quantity) or USUAL.get(unit, (0.0, math.inf))
    if x != 0.0 and not math.isinf(x) and not low <= abs(x) <= high:
        sizes = f"{low:g} to {high:g}" if low else f"up to {high:g}"
        sizes += "" if unit == "1" else f" {unit}"
        raise refusal("value.unusual", x=text, sizes=sizes, wanted=QUANTITIES[quantity].remedy)


def read_number(symbol: str, value: Any, place: Place, bound: str | None = None) -> Any:
    """Return a value as `number` does; note a problem and return None."""
    return place.attempt(lambda: number(symbol, value, bound), symbol)


def read_values(symbol: str, value: Any, place: Place, bound: str | None = None) -> Any:
    """Return a value as `number` does, or `Many`; note problems and return None."""
    if isinstance(value, dict):
        return _axis(symbol, value, place, bound)
    if not isinstance(value, list):
        return read_number(symbol, value, place, bound)
    if not 1 <= len(value) <= LONGEST:
        place.add("axis.length", n=len(value), most=LONGEST)
        return None
    numbers = []
    for i, element in enumerate(value):
        numbers.append(read_number(symbol, element, place.at(i), bound))
        if numbers[-1] is None:  # one bad element is enough
            return None
    shared = place.attempt(lambda: _of_one_quantity(symbol, numbers))
    return shared and Many(len(numbers), lambda: np.array(shared[0]), shared[1])


def _of_one_quantity(symbol: str, values: list[Any]) -> tuple[list[float], str]:
    """Return the values in SI and the quantity that they share; else raise ParameterError."""
    quantity, *others = dict.fromkeys(quantity_of(symbol, value) for value in values)
    if others:
        first, other = (KINDS[QUANTITIES[name].unit][0] for name in (quantity, others[0]))
        raise refusal("axis.quantities", first=first, other=other, wanted=QUANTITIES[symbol].remedy)
    return [x if isinstance(x, float) else to_si(quantity, x) for x in values], quantity


def _axis(symbol: str, table: dict[str, Any], place: Place, bound: str | None) -> Many | None:
    before = len(place.problems)
    note_unknown_keys(table, ("from", "to", "n", "scale"), AXIS, place)
    scale = table.get("scale", "linear")
    place.at("scale").attempt(lambda: choice(scale, ("linear", "log")))
    ends = read_ends(symbol, table, place, "> 0" if scale == "log" else bound)
    n: Any = table.get("n")
    if isinstance(n, bool) or not isinstance(n, int) or not 2 <= n <= LONGEST:
        place.at("n").add("axis.no_n" if n is None else "axis.bad_n", given=n, most=LONGEST)
    if len(place.problems) > before:
        return None
    shared = place.attempt(lambda: _of_one_quantity(symbol, ends))
    if not shared:
        return None
    (first, last), quantity = shared
    if scale == "log":
        return Many(n, lambda: logspace(symbol, first, last, n).values, quantity)
    return Many(n, functools.partial(evenly_spaced, first, last, n), quantity)


def read_ends(
    symbol: str, table: dict[str, Any], place: Place, bound: str | None = None
) -> list[Any]:
    """Return both ends of an axis, finite, as `number` does; None for one with a problem, noted."""
    ends = []
    for key in ("from", "to"):
        x = read_number(symbol, table[key], place.at(key), bound) if key in table else None
        if key not in table:
            place.missing(key, QUANTITIES[symbol].remedy)
        elif x is not None and math.isinf(to_si(quantity_of(symbol, x), x, bound="")):
            place.at(key).add("axis.infinite_end", given=x, wanted=QUANTITIES[symbol].remedy)
            x = None
        ends.append(x)
    return ends


class InlineTable(NamedTuple):
    """A table of numbers: key -> symbol and range, or None for the symbol's own; an example."""

    keys: dict[str, tuple[str, str | None]]
    like: str

    def read(self, table: Any, place: Place) -> dict[str, Any] | None:
        """Return key -> value in SI, None for a problem, noted; None if it is not a table."""
        if not isinstance(table, dict):
            form = "tables" if self.like.startswith("[") else "a table"
            place.add("table.none", given=table, wanted=f"Give {form} such as {self.like}.")
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
