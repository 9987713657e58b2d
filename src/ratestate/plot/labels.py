"""How pictures write quantities: symbols as mathematics, values with units that fit them."""

from ..quantities import QUANTITIES

STRESS = r"$\tau/\sigma$"
AMPLITUDE = f"Amplitude of {STRESS} (max $-$ min)"
RED, BLUE, GRAY = "#d62728", "#1f4fd8", "0.55"

#: power of ten -> prefix
PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "\N{GREEK SMALL LETTER MU}", -9: "n"}
#: SI unit -> how a label writes it, and the prefixes it takes
UNITS = {
    "1": ("", (0,)),
    "m": ("m", (0, -3, -6, -9)),
    "s": ("s", (0, -3, -6)),
    "m/s": ("m/s", (0, -3, -6, -9)),
    "Pa": ("Pa", (9, 6, 3, 0)),
    "Pa/m": ("Pa/m", (9, 6, 3, 0)),
    "kg/m^2": (r"kg/m$^2$", (0,)),
    "Hz": ("Hz", (3, 0)),
}
#: symbol -> how a label writes it, where it is more than one letter
LETTERS = {
    "Dc": "D_c",
    "V0": "V_0",
    "mu0": r"\mu_0",
    "sigma": r"\sigma",
    "V_lp": "V_{lp}",
    "K_c_qs": "K_{c,qs}",
    "eta": r"\eta",
}


def prefixed(unit, value):
    """Factor from SI, and the unit's text, that bring a value to 1 or more.

    >>> prefixed("m/s", 0.0032)
    (1000.0, 'mm/s')
    """
    text, powers = UNITS[unit]
    size = abs(value) * (1 + 1e-9)  # 1e-3 is 1 m, whatever its rounding
    power = next((p for p in powers if size >= 10.0**p), powers[-1] if size > 0 else 0)
    return 10.0**-power, PREFIXES[power] + text


def label(symbol):
    """A symbol as mathematics, for example ``$V_{lp}$``."""
    return f"${LETTERS.get(symbol, symbol)}$"


def value_text(symbol, value, unit_of=None):
    """A quantity as text: symbol, value and a unit that fits it, or fits `unit_of`."""
    factor, unit = prefixed(QUANTITIES[symbol].unit, value if unit_of is None else unit_of)
    return f"{label(symbol)} = {value * factor:.4g} {unit}".rstrip()
