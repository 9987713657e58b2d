"""The entries of the page as a slider, a speed and an experiment, and back."""

from typing import Any
from urllib.parse import urlencode

import numpy as np

from ....errors import ParameterError
from ....friction.composition import composed, form_of
from ....friction.law_formula import HASH_MARK
from ....friction.laws import LAWS, find_law_name, friction_law
from ....model.quantities import readable
from ....model.slider import SpringSlider
from . import protocol, typed
from .state import BEFORE, EXPERIMENT, NONE, PageState

#: the fields of the page for every law, in its order
SYMBOLS = ("a", "b", "Dc", "sigma", "M", "K", "V_lp", "mu0", "V0")
# Digits of values that are not the paper's: all that survive a change of unit.
DIGITS = 15
#: characters of the text of a value, and of those that may be longer
LONGEST = {"value": typed.LONGEST, "protocol": protocol.LONGEST}
#: key of scenario files that entries must not have
LAW_FILE = "law_file"


class BadEntries(Exception):
    """Entries that cannot be used; problems: field -> message."""

    def __init__(self, problems):
        super().__init__("; ".join(problems.values()))
        self.problems = problems


def state_of(entries: Any) -> PageState:
    """The `PageState` that these entries describe; `BadEntries` with all that is wrong with them.

    entries : dict of strings as typed, symbol -> string, where a number without a unit is in SI;
        also "law", perhaps "friction" and those of `EXPERIMENT`, and with others that are not read:

        V_from, sigma_from : speed and normal stress before time 0, if they were others
        protocol : what there is from time 0 on, before V_lp and sigma: see `protocol.segments_of`
        kick : a factor, by which the slip velocity is multiplied at time 0
    """
    if not isinstance(entries, dict):
        raise BadEntries({"": "entries must be an object of texts, such as {'a': '0.003'}"})
    law, form, problems = _law_of(entries)
    own = composed(law, form).parameters if law else ()
    given = {name: entries[name] for name in EXPERIMENT if entries.get(name) is not None}
    values: dict[str, Any] = {}
    texts = {field: entries.get(field, NONE.get(field)) for field in (*SYMBOLS, *own, *NONE)}
    for field, text in (texts | given).items():
        try:
            values[field] = _value(field, text)
        except ParameterError as error:
            problems[field] = str(error)
    problems |= _problems_of_rigid(values)
    if problems:
        raise BadEntries(problems)
    V_lp, experiment = values.pop("V_lp"), {name: values.pop(name) for name in given}
    try:
        return PageState(SpringSlider(law=law.name, friction=form, **values), V_lp, **experiment)
    except ParameterError as error:  # parameters of the law that do not go together
        raise BadEntries({"law": str(error)}) from None


def _problems_of_rigid(values):
    """Entries of an experiment that cannot be where K = inf, of those in `values`: name -> why."""
    if not np.isinf(values.get("K", 0.0)):
        return {}
    problems = {}
    holds = [k for k, segment in enumerate(values.get("protocol", ()), 1) if segment.V == 0.0]
    if holds:
        problems["protocol"] = (
            f"V of segment {holds[0]} = 0 m/s with K = inf: eq. 1 gives no friction at rest; give "
            f"a finite K, or a small V for the hold"
        )
    if "kick" in values:
        problems["kick"] = (
            "kick: where K = inf the slider moves at the load point's speed; give a finite K, or "
            "leave the kick out"
        )
    return problems


def _value(field, text):
    """What the text of a field means, in SI."""
    if field == "protocol":
        return protocol.segments_of(text)
    if field == "kick":
        return typed.factor(text, field)
    return typed.value(BEFORE.get(field, field), text, field)


def _law_of(entries):
    """The law and the form of friction of entries, or None and None; a dict of what is wrong."""
    name = find_law_name(entries.get("law"))
    if name is None or LAW_FILE in entries:
        return None, None, {"law": _problem_of_law(entries)}
    law, form = friction_law(name), entries.get("friction")
    try:
        form = form_of(law, form[: typed.LONGEST] if isinstance(form, str) else form)
        composed(law, form)
    except ParameterError as error:
        return None, None, {"friction": str(error)}
    return law, form, {}


def _problem_of_law(entries):
    """What is wrong with the law: it is not known, or in a file, which no page can have run."""
    law = str(entries.get("law"))[: typed.LONGEST]
    if LAW_FILE in entries or HASH_MARK in law:
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


def entries_of(state, digits=6):
    """symbol -> text with unit, rounded to `digits`, and names: what `state_of` reads."""
    values = state.values
    own = state.slider.friction_law.parameters
    earlier = [name for name in BEFORE if values[name] is not None]
    texts = {
        name: readable(BEFORE.get(name, name), values[name], digits)
        for name in dict.fromkeys((*SYMBOLS, *own, *NONE, *earlier))
    }
    if state.protocol:
        texts["protocol"] = protocol.text_of(state.protocol, digits)
    if state.kick is not None:
        texts["kick"] = f"{state.kick:.{digits}g}"
    return texts | {name: values[name] for name in ("law", "friction")}


def fragment_of(slider, V_lp):
    """The fragment (after #) of the page's address that opens it with a slider and a speed."""
    return urlencode(entries_of(PageState(slider, V_lp), digits=DIGITS))
