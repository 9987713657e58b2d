"""Sizes of quantities in SI: those that nobody can have measured, and those that are rare."""

import numpy as np

from ...model.quantities import QUANTITIES
from ...model.units import one_in_si, scaled, unit_factor
from ..messages import reading as sentences
from .columns import quoted
from .titles import TYPICAL_RANGES

#: friction of rocks and gouges, which only a few minerals are below and nothing is far above; the
#: normal stress of most machines; how far [m] and how fast [m/s] all but rotary machines go
COMMON_FRICTION = (0.1, 1.2)
COMMON_STRESS = (1e3, 1e9)  # Pa
COMMON_DISTANCE, COMMON_SPEED = 1.0, 0.1


def in_si(symbol, values, unit):
    """(n,) values of a column in SI, of any sign; NaN for those that are not finite."""
    converted = scaled(values, unit_factor(QUANTITIES[symbol].unit, unit))
    finite = np.isfinite(values)
    return converted if finite.all() else np.where(finite, converted, np.nan)


def size_warnings(record, speeds):
    """Warnings (list of str) of sizes that few experiments have, but wrong titles and units often.

    record : symbol -> (n,) [SI]; speeds : of the load point's segments [m/s]
    """
    notes = []
    friction = float(np.median(np.abs(record["friction"])))
    low, high = COMMON_FRICTION
    if not low <= friction <= high:
        notes.append(sentences("notes.friction", friction=friction, low=low, high=high))
    stress = float(np.median(record["sigma"])) if "sigma" in record else COMMON_STRESS[0]
    if not COMMON_STRESS[0] <= stress <= COMMON_STRESS[1]:
        notes.append(sentences("notes.stress", stress=stress))
    far = float(np.ptp(record["delta_lp"])) if "delta_lp" in record else 0.0
    fastest = float(np.max(speeds))
    if far > COMMON_DISTANCE or fastest > COMMON_SPEED:
        sizes = {"far": far, "most": COMMON_DISTANCE, "V": fastest, "fast": COMMON_SPEED}
        notes.append(sentences("notes.far" if far > COMMON_DISTANCE else "notes.fast", **sizes))
    return notes


def constant_in_si(symbol, value):
    """A constant in SI; ParameterError for one of a size that nobody has measured friction with."""
    number = one_in_si(symbol, value)
    low, high = TYPICAL_RANGES[symbol]
    if not low <= number <= high:
        si = QUANTITIES[symbol].unit
        raise sentences.refusal(
            "column.constant", symbol=symbol, value=number, low=low, high=high, si=si
        )
    return float(number)


def check_stress(wrong, values):
    """ParameterError, by row, where a recorded normal stress (n,) is wrong, a mask (n,)."""
    if wrong.any():
        row = int(np.argmax(wrong))
        raise sentences.refusal("column.stress", value=values[row], row=row)


def typical_stress(values):
    """Median [Pa] of a recorded normal stress, one number or (n,), finite and > 0.

    ParameterError, by row, where it is not, and for a size that nobody uses.
    """
    values = np.atleast_1d(np.asarray(values, float))
    check_stress(~(np.isfinite(values) & (values > 0.0)), values)
    median = float(np.median(values))
    low, high = TYPICAL_RANGES["sigma"]
    if not low <= median <= high:
        raise sentences.refusal("column.stress_size", median=median, low=low, high=high)
    return median


def check_sizes(symbol, values, column, unit):
    """ParameterError for a column that is constant, or of a size that nobody can have measured.

    sigma, pore_pressure and V_load may be constant.

    values : (n,), n > 0, in SI and finite
    column, unit : for the message
    """
    names = {"title": quoted(column.title), "symbol": symbol, "unit": unit}
    # sigma and pore_pressure may be constant, and V_load in a record without a step
    if symbol not in ("sigma", "V_load", "pore_pressure") and not np.ptp(values) > 0.0:
        what = "tau, and so friction perhaps," if symbol == "tau" else symbol
        raise sentences.refusal(
            "column.dead", what=what, value=values[0], rows=values.size, **names
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
