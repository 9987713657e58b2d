"""What a file may hold: values of a size that somebody may mean, though Python takes any number.

A slip of the unit or of an exponent is told at once, before it runs for minutes or overflows.
"""

from ...model.quantities import QUANTITIES

#: symbol, or unit of all others -> smallest size but 0, and largest.  Wider than anything measured
#: or imagined, and so narrow that no product of them leaves double precision.
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


def unusual(symbol: str, x: float) -> str:
    """The complaint about a value [SI] that nobody can mean; "" for others, 0 and inf among them.

    (Which of these a quantity may be is known to `units.to_si`.)
    """
    unit = QUANTITIES[symbol].unit
    low, high = USUAL.get(symbol) or USUAL.get(unit, (0.0, float("inf")))
    if x == 0.0 or abs(x) == float("inf") or low <= abs(x) <= high:
        return ""
    sizes = f"{low:g} to {high:g}" if low else f"up to {high:g}"
    return f"is beyond any usual size, {sizes}" + ("" if unit == "1" else f" {unit}")
