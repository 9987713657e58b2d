"""Limits on the magnitude of values in a file, where the Python API takes any number.

So a wrong unit or exponent is reported before it costs minutes of computing or overflows.
"""

from ...model.quantities import QUANTITIES

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
}


def magnitude_problem(symbol: str, x: float) -> str:
    """The message about a value [SI] beyond all limits; "" for others, 0 and inf among them.

    (`units.to_si` decides whether a quantity may be 0 or inf.)
    """
    unit = QUANTITIES[symbol].unit
    low, high = USUAL.get(symbol) or USUAL.get(unit, (0.0, float("inf")))
    if x == 0.0 or abs(x) == float("inf") or low <= abs(x) <= high:
        return ""
    sizes = f"{low:g} to {high:g}" if low else f"up to {high:g}"
    return f"is beyond any usual size, {sizes}" + ("" if unit == "1" else f" {unit}")
