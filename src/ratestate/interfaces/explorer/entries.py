"""The entries of the page as a slider and a speed, and back."""

import re
from typing import Any, NamedTuple
from urllib.parse import urlencode

import numpy as np

from ...errors import ParameterError
from ...friction.composition import EXTRAS, composed, form_of
from ...friction.laws import LAWS, friction_law, known_law
from ...friction.user_law import MARK
from ...model.quantities import QUANTITIES, expected, readable
from ...model.slider import SpringSlider
from ...model.units import to_si

#: the fields of the page for every law, in its order
SYMBOLS = ("a", "b", "Dc", "sigma", "M", "K", "V_lp", "mu0", "V0")
LONGEST = 64  # characters of an entry
# Magnitudes [SI] beyond which nothing exists, and numbers overflow.
SMALLEST, LARGEST = 1e-20, 1e20
# Digits of values that are not the paper's: all that survive a change of unit.
DIGITS = 15
#: parameters that links need not have -> what they are then
NONE = {symbol: readable(symbol, 0.0) for symbol in (*EXTRAS, "alpha")}
#: entries that are there after a step only -> of what they are the value before it
BEFORE = {"V_from": "V_lp", "sigma_from": "sigma"}
#: key of scenario files that entries must not have
LAW_FILE = "law_file"
_DIGIT = re.compile(r"^[-+]?[0.]*[1-9]")  # of a number that is not 0, at its beginning
_BARE = re.compile(r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|inf)")


class PageState(NamedTuple):
    """The state of the page: a slider and a speed, after a step of either or both if there was one.

    Without a step the start is steady sliding, see motion.START.
    """

    slider: SpringSlider
    V_lp: float
    V_from: float | None = None  # before the step; None if this does not change
    sigma_from: float | None = None

    @property
    def values(self):
        """dict of the values of all fields, in SI."""
        of_all = {symbol: getattr(self.slider, symbol) for symbol in NONE}
        names = {"law": self.slider.law, "friction": self.slider.friction}
        speeds = {"V_lp": self.V_lp, **{name: getattr(self, name) for name in BEFORE}}
        return of_all | self.slider.values | speeds | names

    @property
    def before(self):
        """The `PageState` before the step; None if there was none."""
        if self.V_from is None and self.sigma_from is None:
            return None
        sigma = self.slider.sigma if self.sigma_from is None else self.sigma_from
        V_lp = self.V_lp if self.V_from is None else self.V_from
        return PageState(self.slider.replace(sigma=sigma), V_lp)


class BadEntries(Exception):
    """Entries that cannot be used; problems: field -> message."""

    def __init__(self, problems):
        super().__init__("; ".join(problems.values()))
        self.problems = problems


def state_of(entries: Any) -> PageState:
    """The `PageState` that these entries describe; `BadEntries` with all that is wrong with them.

    entries : dict of strings as typed, symbol -> string, where a number without a unit is in SI;
        also "law", perhaps "friction" and those of `BEFORE`, and with others that are not read
    """
    if not isinstance(entries, dict):
        raise BadEntries({"": "entries must be an object of texts, such as {'a': '0.003'}"})
    values: dict[str, float] = {}
    law, form, problems = _law_of(entries)
    own = composed(law, form).parameters if law else ()
    stepped = [name for name in BEFORE if entries.get(name) is not None]
    for field in (*SYMBOLS, *own, *NONE, *stepped):
        try:
            values[field] = _value(field, entries.get(field, NONE.get(field)))
        except ParameterError as error:
            problems[field] = str(error)
    if problems:
        raise BadEntries(problems)
    V_lp, before = values.pop("V_lp"), {name: values.pop(name) for name in stepped}
    try:
        return PageState(SpringSlider(law=law.name, friction=form, **values), V_lp, **before)
    except ParameterError as error:  # parameters of the law that do not go together
        raise BadEntries({"law": str(error)}) from None


def _law_of(entries):
    """The law and the form of friction of entries, or None and None; a dict of what is wrong."""
    name = known_law(entries.get("law"))
    if name is None or LAW_FILE in entries:
        return None, None, {"law": _problem_of_law(entries)}
    law, form = friction_law(name), entries.get("friction")
    try:
        form = form_of(law, form[:LONGEST] if isinstance(form, str) else form)
        composed(law, form)
    except ParameterError as error:
        return None, None, {"friction": str(error)}
    return law, form, {}


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


def _value(field, text):
    """The value [SI] that is typed into a field; a number without a unit is in SI."""
    symbol = BEFORE.get(field, field)
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
        exact = (value == 0.0 and not _DIGIT.search(text)) or (np.isinf(value) and "inf" in text)
        if exact or SMALLEST <= abs(value) <= LARGEST:
            return value
        problem = f"= {text!r} is beyond any size"
    raise ParameterError(f"{field} {problem}; {expected(symbol)}")


def entries_of(state, digits=6):
    """symbol -> text with unit, rounded to `digits`, and names: what `state_of` reads."""
    values = state.values
    own = state.slider.friction_law.parameters
    stepped = [name for name in BEFORE if values[name] is not None]
    texts = {
        name: readable(BEFORE.get(name, name), values[name], digits)
        for name in dict.fromkeys((*SYMBOLS, *own, *NONE, *stepped))
    }
    return texts | {name: values[name] for name in ("law", "friction")}


def fragment_of(slider, V_lp):
    """The fragment (after #) of the page's address that opens it with a slider and a speed."""
    return urlencode(entries_of(PageState(slider, V_lp), digits=DIGITS))
