"""The entries of the page as a slider and a speed, and the paper's sliders as entries."""

import re
from typing import Any, NamedTuple
from urllib.parse import urlencode

import numpy as np

from ...errors import ParameterError
from ...friction.composition import EXTRAS
from ...friction.laws import LAW_OF, LAWS, friction_law, known_law, own_parameters
from ...friction.user_law import MARK
from ...model.quantities import KINDS, POWERS, QUANTITIES, expected, prefixed_unit, readable
from ...model.slider import SpringSlider
from ...model.units import to_si
from ...paper import parameters as paper

#: the fields of the page for every law, in its order
SYMBOLS = ("a", "b", "Dc", "sigma", "M", "K", "V_lp", "mu0", "V0")
LONGEST = 64  # characters of an entry
# Magnitudes [SI] beyond which nothing exists, and numbers overflow.
SMALLEST, LARGEST = 1e-20, 1e20
# Digits of values that are not the paper's: all that survive a change of unit.
DIGITS = 15
FIG1_STEP = float(np.e * paper.FIG1.V0)
#: what links need not have -> what it is then
NONE = {symbol: readable(symbol, 0.0) for symbol in EXTRAS}
#: key of scenario files that entries must not have
LAW_FILE = "law_file"
_BARE = re.compile(r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|inf)")


class PageState(NamedTuple):
    """The state of the page: a slider, a speed, and the speed from which it stepped there."""

    slider: SpringSlider
    V_lp: float
    V_from: float | None  # None: the start is steady sliding, see motion.START

    @property
    def values(self):
        """dict of the values of all fields, in SI."""
        values = {symbol: getattr(self.slider, symbol) for symbol in EXTRAS} | self.slider.values
        return values | {"V_lp": self.V_lp, "V_from": self.V_from, "law": self.slider.law}


class BadEntries(Exception):
    """Entries that cannot be used; problems: field -> message."""

    def __init__(self, problems):
        super().__init__("; ".join(problems.values()))
        self.problems = problems


def state_of(entries: Any) -> PageState:
    """The `PageState` that these entries describe; `BadEntries` with all that is wrong with them.

    entries : dict of strings as typed, symbol -> string, where a number without a unit is in SI;
        also "law", perhaps "V_from", and with others that are not read
    """
    if not isinstance(entries, dict):
        raise BadEntries({"": "entries must be an object of texts, such as {'a': '0.003'}"})
    values: dict[str, float] = {}
    problems: dict[str, str] = {}
    law = law_of(entries)
    fields = [*SYMBOLS, *(friction_law(law).parameters if law else ()), *EXTRAS]
    for field in fields if entries.get("V_from") is None else [*fields, "V_from"]:
        try:
            values[field] = _value(field, entries.get(field, NONE.get(field)))
        except ParameterError as error:
            problems[field] = str(error)
    if law is None or LAW_FILE in entries:
        problems["law"] = _problem_of_law(entries)
    if problems:
        raise BadEntries(problems)
    V_lp, V_from = values.pop("V_lp"), values.pop("V_from", None)
    try:
        return PageState(SpringSlider(law=law, **values), V_lp, V_from)
    except ParameterError as error:  # parameters of the law that do not go together
        raise BadEntries({"law": str(error)}) from None


def law_of(entries):
    """The name of the law in these entries; None if they have none that is known."""
    return known_law(entries.get("law")) if isinstance(entries, dict) else None


def _problem_of_law(entries):
    """What is wrong with the law: it is not known, or in a file, which no page can have run."""
    law = str(entries.get("law"))[:LONGEST]
    if LAW_FILE in entries or MARK in law:
        return (
            f"law = {law!r}: the page runs no law file, which is code; end the explorer, and start "
            f"it with ratestate explore --law-file FILE.py"
        )
    return f"law = {law!r} is unknown; choose {' or '.join(LAWS)}"


def values_of(entries):
    """dict of the values of entries, in SI; None if they cannot be used."""
    try:
        return state_of(entries).values
    except BadEntries:
        return None


def fields(usual):
    """list of dicts: symbol, name, unit and usual value [SI], the centre of the field's control.

    Of a law's own parameters, which follow, and damping also the text with which the field begins.
    """
    begin = {symbol: example(symbol) for symbol in own_parameters(LAWS.values())} | NONE
    rows = [{"symbol": symbol, "usual": usual[symbol]} for symbol in SYMBOLS]
    rows += [{"symbol": s, "usual": _value(s, example(s)), "text": x} for s, x in begin.items()]
    for row in rows:
        quantity = QUANTITIES[row["symbol"]]
        row |= {"name": quantity.long_name, "unit": quantity.unit}
    return rows


def example(symbol):
    """A value of a quantity as a user would type it."""
    quantity = QUANTITIES[symbol]
    return (quantity.example or KINDS[quantity.unit][1]).strip("'\"")


def menu():
    """list of dicts, of each law: name, all its names, label and symbols of its own fields."""
    return [
        {
            "name": name,
            "names": [known for known, its in LAW_OF.items() if its == name],
            "label": law.label,
            "parameters": [*law.parameters, *EXTRAS],
        }
        for name, law in LAWS.items()
    ]


def prefixes():
    """The prefixes that values of a unit are shown with: unit -> [[power of ten, prefix], ...]."""
    return {
        unit: [[power, prefixed_unit(unit, power).removesuffix(unit)] for power in powers]
        for unit, powers in POWERS.items()
    }


def _value(field, text):
    """The value [SI] that is typed into a field; a number without a unit is in SI."""
    symbol = "V_lp" if field == "V_from" else field
    if not isinstance(text, str):
        problem = "has no text"
    elif len(text) > LONGEST:
        problem = f"is longer than {LONGEST} characters"
    elif not (text := text.strip()):
        problem = "is empty"
    else:
        unit = QUANTITIES[symbol].unit
        bare = unit != "1" and _BARE.fullmatch(text)
        value = to_si(symbol, f"{text} {unit}" if bare else text, label=field)
        if value == 0.0 or np.isinf(value) or SMALLEST <= abs(value) <= LARGEST:
            return value
        problem = f"= {text!r} is beyond any size"
    raise ParameterError(f"{field} {problem}; {expected(symbol)}")


def presets():
    """list of dicts with ``name``, ``title``, ``entries``; the page opens with the first one."""
    names = ("Step to stable sliding", "Step to just below V_c", "Step to just above V_c")
    slow, fast = paper.FIG6_SPEEDS
    rows: list[tuple[str, str, Any, float, float | None]] = [
        ("Stick-slip", "Fig. 4b", paper.FIG4, paper.FIG4_EXAMPLES["stick_slip"], None),
        ("Quasi-harmonic vibration", "Fig. 4c", paper.FIG4, paper.FIG4_EXAMPLES["harmonic"], None),
        *(
            (name, "Fig. 2", paper.FIG2, V, paper.FIG2_START)
            for name, V in zip(names, paper.FIG2_SPEEDS, strict=True)
        ),
        ("Slow stick-slip", "Fig. 6", paper.FIG6, fast, slow),
        ("Velocity step, rigid drive", "Fig. 1", paper.FIG1, FIG1_STEP, paper.FIG1.V0),
    ]
    return [
        {"name": name, "title": f"{figure}: {name}", "entries": entries_of(slider, V_lp, V_from)}
        for name, figure, slider, V_lp, V_from in rows
    ]


def entries_of(slider, V_lp, V_from=None, digits=6):
    """symbol -> text with unit, rounded to `digits`, and law: what `state_of` reads."""
    values = PageState(slider, V_lp, V_from).values
    symbols = dict.fromkeys((*SYMBOLS, *slider.friction_law.parameters, *EXTRAS))
    texts = {symbol: readable(symbol, values[symbol], digits) for symbol in symbols}
    texts["law"] = slider.law
    return texts | ({} if V_from is None else {"V_from": readable("V_lp", V_from, digits)})


def fragment_of(slider, V_lp):
    """The fragment (after #) of the page's address that opens it with a slider and a speed."""
    return urlencode(entries_of(slider, V_lp, digits=DIGITS))
