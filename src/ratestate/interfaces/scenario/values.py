"""Values of a scenario file: a number, a string with a unit, a list, or an axis between two ends.

All are the floats of the Python API to the last bit.  An axis stays two ends and a number until it
is known that there are not too many cases.
"""

import dataclasses
from decimal import Decimal
from typing import Any

import numpy as np

from ...errors import ParameterError
from ...model.arrays import logspace
from ...model.quantities import attrs
from ...model.units import to_si
from .problems import Problems, bare, choice, expected, one_of, shown
from .sizes import unusual

#: values along one axis, and saved times, at most
LONGEST = 10**6
LONGEST_TEXT = 100  # characters of a number with its unit
AXIS = '{ from = "100 kg/m^2", to = "1e5 kg/m^2", n = 12, scale = "log" }'
KEYS = ("from", "to", "n", "scale")


@dataclasses.dataclass(frozen=True)
class Spread:
    """n values in SI between two ends, which are kept exactly."""

    first: float
    last: float
    n: int
    scale: str

    def __len__(self) -> int:
        return self.n

    def values(self, symbol: str) -> np.ndarray:
        """The values, shape (n,), rounded to 15 digits like those of `ratestate.logspace`."""
        if self.scale == "log":
            return logspace(symbol, self.first, self.last, self.n).values
        # Exact until rounded, so that an axis through 0 meets it.
        first, last, m = Decimal(repr(self.first)), Decimal(repr(self.last)), self.n - 1
        between = ((first * (m - i) + last * i) / m for i in range(1, m))
        return np.array([self.first, *(float(f"{x:.15g}") for x in between), self.last])


Many = Spread | np.ndarray


def array(symbol: str, value: float | Many) -> np.ndarray:
    """Values as a plain array, shape (n,)."""
    return value.values(symbol) if isinstance(value, Spread) else np.atleast_1d(value)


def axis(symbol: str, many: Many) -> Any:
    """Values as a DataArray along a dimension and coordinate of their own, all named `symbol`."""
    import xarray

    values = array(symbol, many)
    return xarray.DataArray(values, {symbol: (symbol, values, attrs(symbol))}, (symbol,), symbol)


def number(symbol: str, value: Any, bound: str | None = None) -> float:
    """One value in SI, of a usual size; ParameterError if it is none."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ParameterError(f"{shown(value)} is not one number; {expected(symbol)}")
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        raise ParameterError(f"{shown(value)} is too long; {expected(symbol)}")
    try:  # (an integer may have more digits than Python writes into a message)
        x = to_si(symbol, float(value) if isinstance(value, int) else value, bound=bound)
    except ArithmeticError:
        raise ParameterError(f"{shown(value)} is beyond what can be; {expected(symbol)}") from None
    if complaint := unusual(symbol, x):
        raise ParameterError(f"{shown(value)} {complaint}; {expected(symbol)}")
    return x


def read(
    symbol: str, value: Any, place: str, problems: Problems, bound: str | None = None
) -> float | Many | None:
    """One value or many, in SI; None if there are problems, which are noted."""
    if isinstance(value, dict):
        return _spread(symbol, value, place, problems, bound)
    if isinstance(value, list):
        return _list(symbol, value, place, problems, bound)
    with problems.at(place, symbol):
        return number(symbol, value, bound)
    return None


def _list(
    symbol: str, values: list[Any], place: str, problems: Problems, bound: str | None
) -> np.ndarray | None:
    """The values of a list; of those that cannot be used, the first."""
    if not 1 <= len(values) <= LONGEST:
        what = f"is a list of {len(values)}, expected 1 to {LONGEST} values"
        problems.add(place, f'{what}, such as ["100 kg/m^2", 3000]')
        return None
    found = []
    for i, value in enumerate(values):
        with problems.at(f"{place}[{i}]", symbol):
            found.append(number(symbol, value, bound))
        if len(found) <= i:
            return None
    return np.array(found)


def _spread(
    symbol: str, table: dict[str, Any], place: str, problems: Problems, bound: str | None
) -> Spread | None:
    """An axis between two ends."""
    before = len(problems)
    for key in table.keys() - set(KEYS):
        problems.add(f"{place}.{bare(key)}", f"unknown key, {one_of(KEYS, key, AXIS)}")
    scale, n = "", 0
    with problems.at(f"{place}.scale"):
        scale = choice(table.get("scale", "linear"), ("linear", "log"))
    first, last = ends(symbol, table, place, problems, "> 0" if scale == "log" else bound)
    with problems.at(f"{place}.n"):
        n = _n(table)
    if first is None or last is None or len(problems) > before:
        return None
    return Spread(first, last, n, scale)


def ends(
    symbol: str, table: dict[str, Any], place: str, problems: Problems, bound: str | None = None
) -> tuple[float | None, float | None]:
    """The first and the last value, None for one with a problem."""
    first = last = None
    with problems.at(f"{place}.from", symbol):
        first = _end(symbol, table, "from", bound)
    with problems.at(f"{place}.to", symbol):
        last = _end(symbol, table, "to", bound)
    return first, last


def _end(symbol: str, table: dict[str, Any], key: str, bound: str | None) -> float:
    """The first or last value of an axis."""
    if key not in table:
        raise ParameterError(f"is missing; {expected(symbol)}")
    x = number(symbol, table[key], bound)
    if np.isinf(x):
        raise ParameterError(f"{x} is no end of an axis, which must be finite; {expected(symbol)}")
    return x


def _n(table: dict[str, Any]) -> int:
    """How many values an axis has."""
    n = table.get("n")
    if isinstance(n, int) and not isinstance(n, bool) and 2 <= n <= LONGEST:
        return n
    what = "is missing" if n is None else f"{shown(n)} cannot be the number of values"
    raise ParameterError(f"{what}, expected an integer from 2 to {LONGEST}, such as 12")
