"""From what is typed into the page to a slider and a speed."""

import re
from typing import Any, NamedTuple

import numpy as np

from ...errors import ParameterError
from ...friction.laws import LAWS
from ...model.quantities import POWERS, PREFIXES, QUANTITIES, expected
from ...model.slider import SpringSlider
from ...model.units import to_si

#: what the page has a field for, in its order
SYMBOLS = ("a", "b", "Dc", "sigma", "M", "K", "V_lp", "mu0", "V0")
LONGEST = 64  # characters of an entry
# Sizes [SI] beyond which nothing exists, and numbers overflow.
SMALLEST, LARGEST = 1e-20, 1e20
_BARE = re.compile(r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|inf)")


class Asked(NamedTuple):
    """What the page shows: a slider, a speed, and the speed from which it stepped there."""

    slider: SpringSlider
    V_lp: float
    V_from: float | None  # None: the start is steady sliding, see motion.START

    @property
    def values(self):
        """dict of what all fields mean, in SI."""
        numbers = {symbol: getattr(self.slider, symbol) for symbol in SYMBOLS if symbol != "V_lp"}
        return numbers | {"V_lp": self.V_lp, "V_from": self.V_from, "law": self.slider.law}


class BadEntries(Exception):
    """Entries that cannot be used: field -> what is wrong with it."""

    def __init__(self, problems):
        super().__init__("; ".join(problems.values()))
        self.problems = problems


def asked_of(entries: Any) -> Asked:
    """The slider that these entries describe.

    entries : dict of texts as typed, symbol -> text, a number without a unit being in SI; also
        "law", and perhaps "V_from"

    Raises
    ------
    BadEntries
        With the message of `to_si` for each field that cannot be read.
    """
    if not isinstance(entries, dict):
        raise BadEntries({"": "entries must be an object of texts, such as {'a': '0.003'}"})
    values: dict[str, float] = {}
    problems: dict[str, str] = {}
    wanted = {symbol: symbol for symbol in SYMBOLS}
    if entries.get("V_from") is not None:
        wanted["V_from"] = "V_lp"
    for field, symbol in wanted.items():
        try:
            text = _text(field, entries.get(field))
            values[field] = _sized(field, text, to_si(symbol, _in_unit(symbol, text), label=field))
        except ParameterError as error:
            problems[field] = str(error)
    law = str(entries.get("law"))
    if law not in LAWS:
        problems["law"] = f"law = {law[:LONGEST]!r} is unknown; choose {' or '.join(LAWS)}"
    if problems:
        raise BadEntries(problems)
    V_lp, V_from = values.pop("V_lp"), values.pop("V_from", None)
    return Asked(SpringSlider(law=law, **values), V_lp, V_from)


def values_of(entries):
    """dict of what entries mean, in SI; None where they cannot be used."""
    try:
        return asked_of(entries).values
    except BadEntries:
        return None


def fields(usual):
    """What the page must know of each field.

    usual : dict of numbers in SI, symbol -> value about which a slider begins
    """
    return [
        {
            "symbol": symbol,
            "name": QUANTITIES[symbol].long_name,
            "unit": QUANTITIES[symbol].unit,
            "usual": usual[symbol],
        }
        for symbol in SYMBOLS
    ]


def prefixes():
    """The prefixes that values of a unit are shown with: unit -> [[power of ten, prefix], ...]."""
    return {unit: [[p, PREFIXES[p]] for p in powers] for unit, powers in POWERS.items()}


def _text(field, value):
    """What stands in a field."""
    if not isinstance(value, str):
        raise ParameterError(f"{field} has no text; {_such(field)}")
    if len(value) > LONGEST:
        raise ParameterError(f"{field} is longer than {LONGEST} characters; {_such(field)}")
    if not value.strip():
        raise ParameterError(f"{field} is empty; {_such(field)}")
    return value.strip()


def _in_unit(symbol, text):
    """The text; that of a number in SI with its unit."""
    unit = QUANTITIES[symbol].unit
    return f"{text} {unit}" if unit != "1" and _BARE.fullmatch(text) else text


def _sized(field, text, value):
    """A value of a size that can be."""
    if value == 0.0 or np.isinf(value) or SMALLEST <= abs(value) <= LARGEST:
        return value
    raise ParameterError(f"{field} = {text!r} is beyond any size; {_such(field)}")


def _such(field):
    """What it should be."""
    return expected("V_lp" if field == "V_from" else field)
