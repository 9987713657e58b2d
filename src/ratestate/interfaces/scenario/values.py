"""Values of a scenario file: a number, a string with a unit, a list, or an axis between two ends.

All are bit-for-bit the floats of the Python API.  An axis is kept as two ends and a number until
the number of cases has been checked.
"""

import dataclasses
from decimal import Decimal
from typing import Any

import numpy as np

from ...errors import ParameterError
from ...model.arrays import logspace
from ...model.quantities import attrs
from ...model.units import to_si
from .magnitudes import magnitude_problem
from .problems import Problems, choice, expected, one_of, shown, toml_key

#: largest number of values along one axis, and of saved times
LONGEST = 10**6
LONGEST_TEXT = 100  # characters of a number with its unit
AXIS = '{ from = "100 kg/m^2", to = "1e5 kg/m^2", n = 12, scale = "log" }'
KEYS = ("from", "to", "n", "scale")


@dataclasses.dataclass(frozen=True)
class AxisRange:
    """n values in SI between two ends, which are exact."""

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
        # Exact until rounded, so that an axis through 0 contains 0.
        first, last, m = Decimal(repr(self.first)), Decimal(repr(self.last)), self.n - 1
        between = ((first * (m - i) + last * i) / m for i in range(1, m))
        return np.array([self.first, *(float(f"{x:.15g}") for x in between), self.last])


Many = AxisRange | np.ndarray


def as_array(symbol: str, value: float | Many) -> np.ndarray:
    """Values as a plain array, shape (n,)."""
    return value.values(symbol) if isinstance(value, AxisRange) else np.atleast_1d(value)


def as_axis(symbol: str, many: Many) -> Any:
    """Values as a DataArray along a dimension and coordinate of their own, all named `symbol`."""
    import xarray

    values = as_array(symbol, many)
    return xarray.DataArray(values, {symbol: (symbol, values, attrs(symbol))}, (symbol,), symbol)


def number(symbol: str, value: Any, bound: str | None = None) -> float:
    """One value in SI; ParameterError if it is no number or has an unusual magnitude."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ParameterError(f"{shown(value)} is not one number; {expected(symbol)}")
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        raise ParameterError(f"{shown(value)} is too long; {expected(symbol)}")
    try:  # (an integer may have more digits than Python writes into a message)
        x = to_si(symbol, float(value) if isinstance(value, int) else value, bound=bound)
    except ArithmeticError:
        raise ParameterError(f"{shown(value)} is beyond what can be; {expected(symbol)}") from None
    if complaint := magnitude_problem(symbol, x):
        raise ParameterError(f"{shown(value)} {complaint}; {expected(symbol)}")
    return x


def read_values(
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
    """The values of a list; the first one with a problem is noted."""
    if not 1 <= len(values) <= LONGEST:
        what = f"is a list of {len(values)}, expected 1 to {LONGEST} values"
        problems.add(place, f'{what}, such as ["100 kg/m^2", 3000]')
        return None
    numbers = []
    for i, value in enumerate(values):
        with problems.at(f"{place}[{i}]", symbol):
            numbers.append(number(symbol, value, bound))
        if len(numbers) <= i:
            return None
    return np.array(numbers)


def _spread(
    symbol: str, table: dict[str, Any], place: str, problems: Problems, bound: str | None
) -> AxisRange | None:
    """An axis between two ends."""
    before = len(problems)
    for key in table.keys() - set(KEYS):
        problems.add(f"{place}.{toml_key(key)}", f"unknown key, {one_of(KEYS, key, AXIS)}")
    scale, n = "", 0
    with problems.at(f"{place}.scale"):
        scale = choice(table.get("scale", "linear"), ("linear", "log"))
    first, last = ends(symbol, table, place, problems, "> 0" if scale == "log" else bound)
    with problems.at(f"{place}.n"):
        n = _n(table)
    if first is None or last is None or len(problems) > before:
        return None
    return AxisRange(first, last, n, scale)


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
    """The number of values of an axis."""
    n = table.get("n")
    if isinstance(n, int) and not isinstance(n, bool) and 2 <= n <= LONGEST:
        return n
    what = "is missing" if n is None else f"{shown(n)} cannot be the number of values"
    raise ParameterError(f"{what}, expected an integer from 2 to {LONGEST}, such as 12")
