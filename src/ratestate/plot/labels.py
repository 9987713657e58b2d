"""Labels and colours of figures: symbols as mathematics, names of laws, values with units."""

import re
from typing import Any, NamedTuple

import numpy as np

from ..friction.laws import LAWS as friction
from ..model import quantities
from ..model.parameters import WHOLE_CONTACT, of_contact, shown_name
from ..model.quantities import QUANTITIES

STRESS = r"$\tau/\sigma$"
AMPLITUDE = f"Amplitude of {STRESS} (max $-$ min)"
RED, BLUE, GRAY = "#d62728", "#1f4fd8", "0.55"
#: dashes of a line
DASHED = (0, (4, 2))
#: abscissae of runs and records
ABSCISSAE = {"time": "Time", "delta_lp": "Load-point displacement"}


class Law(NamedTuple):
    """A law's name, and the line of its curves where laws are compared; records are gray."""

    name: str
    color: str
    dashes: Any

    @property
    def line(self):
        """The style of such a line."""
        return {"color": self.color, "ls": self.dashes}


# The looks of laws, in their order, and then again.
_COLORS = (RED, BLUE, "#2ca02c", "#9467bd", "#e08214", "#17a2b8", "#222222")
_DASHES = ("-", (0, (5, 1.6)), (0, (1, 1)), (0, (5, 1.5, 1, 1.5)), (0, (9, 2)))


class _Looks(dict[str, Law]):
    """Name of a friction law -> its look, found when it is needed: users add laws."""

    def __missing__(self, name: str) -> Law:
        i = list(friction).index(name)
        color, dashes = _COLORS[i % len(_COLORS)], _DASHES[i % len(_DASHES)]
        self[name] = Law(friction[name].label, color, dashes)
        return self[name]


#: name of a friction law -> its look
LAWS = _Looks()

#: power of ten -> prefix
PREFIXES = quantities.PREFIXES | {-6: "\N{GREEK SMALL LETTER MU}"}
#: pure numbers below this are given in thousandths
SMALL = 0.1
#: symbol -> how a label writes it, where it is more than one letter
LETTERS = {
    "Dc": "D_c",
    "V0": "V_0",
    "mu0": r"\mu_0",
    "sigma": r"\sigma",
    "tau": r"\tau",
    "mu": r"\mu",
    "V_lp": "V_{lp}",
    "V_max": r"V_{\max}",
    "V_min": r"V_{\min}",
    "frequency": "f",
    "period": "T",
    "omega": r"\omega",
    "growth_rate": r"\mathrm{Re}\,\lambda",
    "K_c_qs": "K_{c,qs}",
    "V_c_upper": r"V_{c,\mathrm{upper}}",
    "eta": r"\eta",
    "theta": r"\theta",
    "a_minus_b": "a-b",
    "area": "A",
    "damping": r"\mathrm{damping}",
    "alpha": r"\alpha",
    "normal_force": "F_n",
    "force_amplitude": "F_{pp}",
    "displacement_amplitude": r"\delta_{pp}",
    "acceleration_max": r"|\dot{V}|_{\max}",
}


#: Greek letters that only begin symbols
GREEK = ("beta", "delta")
#: symbols that sentences name; single letters that are words as well are not among them
SYMBOLS = (*LETTERS, "K_c", "V_c", "V_c_upper", "f_n", "V_from", "sigma_from", "K", "M", "V", "b")
_NAMED = "|".join(sorted(map(re.escape, SYMBOLS), key=len, reverse=True))
_SYMBOL = re.compile(rf"(?<![\w'\"$])(tau/sigma|{_NAMED})(?![\w'\"^])")
_POWER = re.compile(r"(\d)e([+-]?)0*(\d+)\b")
_MICRO = re.compile(r"(?<=\d )u(?=m|s|Hz)")


def prefixed(unit, value):
    """Return the factor and text of a unit in which a value is readable, such as mm/s.

    The value in this unit is at least 1, if there is such a prefix.  Times from 2 hours, 2 days or
    2 years on are in hours, days or years.  The factor is 1 if the unit takes no prefix, or if no
    prefix makes the value readable.

    Parameters
    ----------
    unit : str
        SI unit of the value.
    value : float
        Value in SI.

    Returns
    -------
    factor : float
        Factor by which to multiply a value in SI.
    text : str
        The unit with its prefix, as a label writes it, with the Greek letter for micro and powers
        such as m$^2$; "" for a pure number.

    Examples
    --------
    >>> prefixed("m/s", 0.0032)
    (1000.0, 'mm/s')
    """
    if unit == "s" and (long := quantities.long_time_unit(abs(value))):
        return 1.0 / long[1], long[0]
    power = quantities.power_of(unit, value)
    text = quantities.prefixed_unit(unit, power, PREFIXES).replace("^2", "$^2$")
    return 10.0**-power, "" if unit == "1" else text


def fitting_unit(symbol, values, area=None):
    """Factor from SI, and the unit's text, that fit the largest finite one of these values.

    area : of the contact [m^2], if known: the unit is then of the whole contact
    """
    values = np.abs(np.asarray(values, float))
    quantity, largest = of_contact(symbol, values[np.isfinite(values)].max(initial=0.0), area)
    factor, unit = prefixed(QUANTITIES[quantity].unit, float(largest))
    return of_contact(symbol, factor, area)[1], unit


def scaled(symbol, largest):
    """What values of a quantity, up to this one [SI], are multiplied by, and the unit with that.

    As `prefixed`; mu0 and small pure numbers, such as a and b, are in thousandths.
    """
    unit = QUANTITIES[symbol].unit
    if unit == "1" and (symbol == "mu0" or abs(largest) < SMALL):
        return 1e3, "$10^{-3}$"
    return prefixed(unit, largest)


def label(symbol):
    """Return a symbol as mathematics, for example ``$V_{lp}$``.

    Parameters
    ----------
    symbol : str
        Symbol of a quantity, such as "V_lp".

    Returns
    -------
    str
        Text that matplotlib sets as mathematics: upright if the symbol is a word, such as lag.
    """
    return f"${_letters(symbol)}$"


def _letters(symbol):
    """A symbol as mathematics; what follows an underscore, and digits, are lowered."""
    symbol = symbol if symbol in LETTERS else WHOLE_CONTACT.get(symbol, symbol)
    if symbol in LETTERS:
        return LETTERS[symbol]
    for ratio in ("_over_", "_by_"):
        if ratio in symbol:
            return "/".join(map(_letters, symbol.split(ratio, 1)))
    first, *indices = symbol.split("_")
    head = first.rstrip("0123456789")
    if len(head) > 1 and head not in (*LETTERS, *GREEK):
        return rf"\mathrm{{{symbol.replace('_', '~')}}}"
    letter, _, index = LETTERS.get(head, rf"\{head}" if head in GREEK else head).partition("_")
    lowered = ",".join(filter(None, [index.strip("{}") + first[len(head) :], *indices]))
    if lowered.isalpha() and len(lowered) == 1:
        return f"{letter}_{lowered}"
    return f"{letter}_{{{lowered}}}" if lowered else letter


def label_of_contact(symbol, area):
    """Return `label`, or F_n for the normal stress of a contact whose area is known."""
    return label("normal_force" if symbol == "sigma" and area is not None else symbol)


def name_and_symbol(symbol, area=None):
    """A quantity by its name and symbol, for an axis; KeyError if it is not in `QUANTITIES`.

    area : as for `fitting_unit`
    """
    return f"{shown_name(symbol, area).capitalize()} {label_of_contact(symbol, area)}"


def in_unit(text, unit):
    """A text followed by a unit, if there is one."""
    return f"{text} [{unit}]" if unit else text


def value_text(symbol, value, unit_of=None, area=None):
    """Return a quantity as text: symbol, value and a readable unit.

    Parameters
    ----------
    symbol : str
        Symbol of the quantity, a key of ``ratestate.QUANTITIES``.
    value : float
        Value in SI.
    unit_of : float, optional
        Value in SI for which the unit is chosen, in place of `value`.
    area : float, optional
        Area of the contact [m^2].  Normal stress, stiffness, mass and damping are then shown for
        the whole contact, such as the normal force F_n for sigma.

    Returns
    -------
    str
        Text such as ``$V_{lp}$ = 3.2 mm/s``.  inf is written as its symbol.
    """
    return f"{label_of_contact(symbol, area)} = {with_unit(symbol, value, unit_of, area)}"


def with_unit(symbol, value, unit_of=None, area=None):
    """A quantity's value and a unit that fits it, or fits `unit_of`, as text; the sign for inf."""
    if value == float("inf"):
        return r"$\infty$"
    factor, unit = fitting_unit(symbol, value if unit_of is None else unit_of, area)
    return f"{value * factor:.4g} {unit}".rstrip()


def mathematics(text):
    """A plain sentence with its symbols and powers of ten as mathematics."""
    text = _SYMBOL.sub(lambda found: STRESS if found[0] == "tau/sigma" else label(found[0]), text)
    text = _POWER.sub(lambda f: rf"{f[1]}$\cdot$10$^{{{f[2].strip('+')}{f[3]}}}$", text)
    text = _MICRO.sub(PREFIXES[-6], text)
    return text.replace("<=", r"$\leq$").replace("m^2", "m$^2$").replace("+-", r"$\pm$")
