"""Values as literals of TOML and Python that are read back bit-for-bit."""

import textwrap
from collections.abc import Iterable
from typing import Any

import numpy as np

from ...model.quantities import QUANTITIES, exact_text
from ...model.units import is_array
from .values import AxisRange

WIDTH = 93  # characters of a line


def quantity(symbol: str, x: float) -> str:
    """A value in SI as a literal of both TOML and Python: a number, or a string with a unit.

    Infinite ones are "inf", which of the two only TOML reads.
    """
    if not np.isfinite(x):
        return repr(float(x))
    text = exact_text(symbol, x)
    return text if QUANTITIES[symbol].unit == "1" else f'"{text}"'


def numbers(values: Iterable[float], indent: str = "    ") -> str:
    """A list of numbers, over several lines if it is long; for both TOML and Python."""
    literals = [repr(float(x)) for x in values]
    if sum(map(len, literals)) + 2 * len(literals) <= 70:
        return f"[{', '.join(literals)}]"
    line = "".join(f"{literal}, " for literal in literals)
    lines = textwrap.wrap(
        line, WIDTH, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False
    )
    return "\n".join(["[", *lines, "]"])


def find_axis(symbol: str, values: np.ndarray) -> AxisRange | None:
    """The axis between two ends that has exactly these values (n,); None if none has, or n < 3."""
    if values.size < 3 or not np.isfinite(values).all():
        return None
    first, last = float(values[0]), float(values[-1])
    for scale in ("log", "linear") if first > 0 and last > 0 else ("linear",):
        axis = AxisRange(first, last, values.size, scale)
        if np.array_equal(axis.values(symbol), values):
            return axis
    return None


def is_own_axis(symbol: str, value: Any) -> bool:
    """Whether an array's only dimension is named like its symbol and labelled by its values."""
    if not is_array(value) or value.dims != (symbol,):
        return False
    labels = value.coords.get(symbol)
    same = labels is None or (labels.dims == (symbol,) and np.array_equal(labels, value))
    return bool(same and not value.coords.keys() - {symbol})
