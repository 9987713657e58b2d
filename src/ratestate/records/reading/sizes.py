"""Convert columns to SI; refuse impossible sizes and warn of unusual ones."""

import numpy as np

from ...model.quantities import QUANTITIES
from ...model.units import one_in_si, scaled, unit_factor
from ..messages import reading as sentences
from .columns import quoted
from .titles import TYPICAL_RANGES

#: friction of rocks and gouges: only a few minerals are below, and nothing is far above
COMMON_FRICTION = (0.1, 1.2)
COMMON_STRESS = (1e3, 1e9)  # normal stress of most machines [Pa]
#: longest displacement [m] and highest speed [m/s] of machines that are not rotary
COMMON_DISTANCE, COMMON_SPEED = 1.0, 0.1


def in_si(symbol, values, unit):
    """Convert the values (n,) of a column to SI; values that are not finite become NaN."""
    converted = scaled(values, unit_factor(QUANTITIES[symbol].unit, unit))
    finite = np.isfinite(values)
    return converted if finite.all() else np.where(finite, converted, np.nan)


def size_warnings(record, speeds):
    """Return warnings (list of str) of sizes that are more often errors than measurements.

    record : symbol -> (n,) [SI]
    speeds : speeds of the load point's segments [m/s]
    """
    notes = []
    friction = float(np.median(np.abs(record["friction"])))
    low, high = COMMON_FRICTION
    if not low <= friction <= high:
        notes.append(sentences("notes.friction", friction=friction, low=low, high=high))
    stress = float(np.median(record["sigma"])) if "sigma" in record else COMMON_STRESS[0]
    if not COMMON_STRESS[0] <= stress <= COMMON_STRESS[1]:
        notes.append(sentences("notes.stress", stress=stress))
    span = float(np.ptp(record["delta_lp"])) if "delta_lp" in record else 0.0
    fastest = float(np.max(speeds))
    if span > COMMON_DISTANCE or fastest > COMMON_SPEED:
        sizes = {"far": span, "most": COMMON_DISTANCE, "V": fastest, "fast": COMMON_SPEED}
        notes.append(sentences("notes.far" if span > COMMON_DISTANCE else "notes.fast", **sizes))
    return notes


def constant_in_si(symbol, value):
    """Return a constant in SI; ParameterError if its size is impossible."""
    number = one_in_si(symbol, value)
    low, high = TYPICAL_RANGES[symbol]
    if not low <= number <= high:
        si = QUANTITIES[symbol].unit
        raise sentences.refusal(
            "column.constant", symbol=symbol, value=number, low=low, high=high, si=si
        )
    return float(number)


def check_stress(is_wrong, values):
    """Raise ParameterError for the first row of a normal stress (n,) in a mask `is_wrong` (n,)."""
    if is_wrong.any():
        row = int(np.argmax(is_wrong))
        raise sentences.refusal("column.stress", value=values[row], row=row)


def typical_stress(values):
    """Return the median [Pa] of a recorded normal stress, one number or (n,).

    ParameterError if a value is not finite and > 0, or if the size is impossible.
    """
    values = np.atleast_1d(np.asarray(values, float))
    check_stress(~(np.isfinite(values) & (values > 0.0)), values)
    median = float(np.median(values))
    low, high = TYPICAL_RANGES["sigma"]
    if not low <= median <= high:
        raise sentences.refusal("column.stress_size", median=median, low=low, high=high)
    return median


def check_sizes(symbol, values, column, unit):
    """Raise ParameterError if a column is constant, or if its size is impossible.

    values : (n,), n > 0, in SI and finite
    column, unit : for the message
    """
    names = {"title": quoted(column.title), "symbol": symbol, "unit": unit}
    # sigma and pore_pressure may be constant, and V_load may be in a record without a step
    if symbol not in ("sigma", "V_load", "pore_pressure") and not np.ptp(values) > 0.0:
        quantity = "tau, and so friction perhaps," if symbol == "tau" else symbol
        raise sentences.refusal(
            "column.dead", what=quantity, value=values[0], rows=values.size, **names
        )
    span = symbol in ("time", "delta_lp")
    size = float(np.ptp(values) if span else np.median(np.abs(values)))
    if symbol == "friction":
        size = max(size, float(np.quantile(np.abs(values), 0.9)))
    low, high = TYPICAL_RANGES[symbol]
    if size > 0.0 and not low <= size <= high:
        sentence = "friction" if symbol == "friction" else "span" if span else "size"
        si = QUANTITIES[symbol].unit
        raise sentences.refusal(f"column.{sentence}", size=size, low=low, high=high, si=si, **names)
