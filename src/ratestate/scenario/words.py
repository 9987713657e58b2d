"""Values as text, from which the same bits come back."""

from collections.abc import Iterable
from decimal import Decimal
from typing import Any

import numpy as np

from ..quantities import QUANTITIES
from ..units import is_array
from .values import Spread

#: SI unit -> the prefixes with which it is written, and their powers of ten
PREFIXES: dict[str, dict[str, int]] = {
    "m": {"nm": -9, "um": -6, "mm": -3, "m": 0, "km": 3},
    "s": {"us": -6, "ms": -3, "s": 0},
    "m/s": {"nm/s": -9, "um/s": -6, "mm/s": -3, "m/s": 0},
    "Pa": {"Pa": 0, "kPa": 3, "MPa": 6, "GPa": 9},
    "Pa/m": {"Pa/m": 0, "kPa/m": 3, "MPa/m": 6, "GPa/m": 9},
    "kg/m^2": {"kg/m^2": 0},
}
WIDTH = 92  # characters of a line


def quantity(symbol: str, x: float) -> str:
    """One value, in SI, as TOML and Python both read it: a number, or a text with a unit."""
    unit = QUANTITIES[symbol].unit
    if unit not in PREFIXES or not np.isfinite(x):
        return repr(float(x))
    exact = Decimal(repr(float(x)))
    if not exact:
        return f'"0 {unit}"'
    sizes, size = PREFIXES[unit], exact.adjusted()
    fitting = [name for name, power in sizes.items() if -3 <= size - power <= 5]
    if not fitting:
        return f'"{float(x)!r} {unit}"'
    name = next((n for n in reversed(fitting) if sizes[n] <= size), fitting[0])
    return f'"{exact.scaleb(-sizes[name]).normalize():f} {name}"'


def numbers(values: Iterable[float], indent: str = "    ") -> str:
    """A list of numbers, over several lines if it is long."""
    words = [repr(float(x)) for x in values]
    if sum(map(len, words)) + 2 * len(words) <= 70:
        return f"[{', '.join(words)}]"
    lines, line = [], indent
    for word in words:
        if len(line) + len(word) > WIDTH:
            lines.append(line.rstrip())
            line = indent
        line += f"{word}, "
    return "\n".join(["[", *lines, line.rstrip(), "]"])


def spread(symbol: str, values: np.ndarray) -> Spread | None:
    """The axis between two ends that has these very values, if there is one."""
    if values.size < 3 or not np.isfinite(values).all():
        return None
    first, last = float(values[0]), float(values[-1])
    for scale in ("log", "linear") if first > 0 and last > 0 else ("linear",):
        axis = Spread(first, last, values.size, scale)
        if np.array_equal(axis.values(symbol), values):
            return axis
    return None


def along_itself(symbol: str, value: Any) -> bool:
    """Whether an array lies along a dimension named like its symbol, labelled by its values."""
    if not is_array(value) or value.dims != (symbol,):
        return False
    labels = value.coords.get(symbol)
    same = labels is None or (labels.dims == (symbol,) and np.array_equal(labels, value))
    return bool(same and not value.coords.keys() - {symbol})
