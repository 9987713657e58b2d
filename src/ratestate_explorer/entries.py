"""Convert the entries of the page into a `PageState`, and back."""

from typing import Any
from urllib.parse import urlencode

import numpy as np

import ratestate as rs

from .state import (
    BEFORE,
    EXPERIMENT,
    LONGEST,
    LONGEST_PROTOCOL,
    NONE,
    PageState,
    factor_of,
    rows_of,
    segments_of,
    text_of,
    text_of_rows,
    value_of,
    with_unit,
)

#: the fields of the page for every law, in its order
SYMBOLS = ("a", "b", "Dc", "sigma", "M", "K", "V_lp", "mu0", "V0")
# Digits that survive any change of unit.
DIGITS = 15
#: the port tried first if none is given
PORT = 8765
#: most characters of a text: of a value, and of texts that may be longer
TEXT_LIMITS = {"value": LONGEST, "protocol": LONGEST_PROTOCOL}


class BadEntries(Exception):
    """Entries that cannot be used; problems: field -> message."""

    def __init__(self, problems):
        super().__init__("; ".join(problems.values()))
        self.problems = problems


def state_of(entries: Any) -> PageState:
    """Return the `PageState` of entries; `BadEntries` with everything that is wrong with them.

    entries : dict of strings as typed, symbol -> string, in which a number without a unit is in SI;
        also "law", perhaps "friction_form" and the keys of `EXPERIMENT`; others are ignored:

        V_from, sigma_from : speed and normal stress before time 0, if they were different
        protocol : what happens from time 0 on, before V_lp and sigma: see `state.segments_of`
        kick : a factor, by which the slip velocity is multiplied at time 0
    """
    if not isinstance(entries, dict):
        raise BadEntries({"": "entries must be an object of texts, such as {'a': '0.003'}"})
    law, form, problems = _law_of(entries)
    given = {name: entries[name] for name in EXPERIMENT if entries.get(name) is not None}
    values: dict[str, Any] = {}
    symbols = law.forms[form] if law else ()
    texts = {field: entries.get(field, NONE.get(field)) for field in (*SYMBOLS, *symbols, *NONE)}
    for field, text in (texts | given).items():
        try:
            values[field] = _value(field, text)
        except rs.ParameterError as error:
            problems[field] = str(error)
    problems |= _problems_of_rigid(values)
    if problems:
        raise BadEntries(problems)
    V_lp, experiment = values.pop("V_lp"), {name: values.pop(name) for name in given}
    try:
        slider = rs.SpringSlider(law=law.name, friction_form=form, **values)
    except rs.ParameterError as error:  # parameters of the law that do not go together
        raise BadEntries({"law": str(error)}) from None
    return PageState(slider, V_lp, **experiment)


def _problems_of_rigid(values):
    """Return the problems of an experiment if K = inf, name -> message."""
    if not np.isinf(values.get("K", 0.0)):
        return {}
    problems = {}
    holds = [k for k, segment in enumerate(values.get("protocol", ()), 1) if segment.V == 0.0]
    if holds:
        problems["protocol"] = (
            f"V of segment {holds[0]} = 0 m/s with K = inf: eq. 1 gives no friction at rest. Give "
            f"a finite K, or a small V for the hold."
        )
    if "kick" in values:
        problems["kick"] = (
            "kick: with K = inf the slider moves at the load point's speed. Give a finite K, or "
            "remove the kick."
        )
    return problems


def _value(field, text):
    if field == "protocol":
        return segments_of(text)
    if field == "kick":
        return factor_of(text, field)
    return value_of(BEFORE.get(field, field), text, field)


def _law_of(entries):
    """Return the law's `LawEntry` and form of friction, or None and None; and their problems."""
    laws = rs.laws.catalogue()
    name = str(entries.get("law"))[:LONGEST]
    law = next((law for law in laws if name.lower() in law.names), None)
    if law is None or "law_file" in entries:  # a law file is code, which no page can have run
        problem = (
            f"law = {name!r} is unknown. Choose {' or '.join(law.name for law in laws)}, or start "
            f"the explorer with your own law: ratestate explore --law-file FILE.py."
        )
        return None, None, {"law": problem}
    form = entries.get("friction_form")
    if form is None:
        return law, next(iter(law.forms)), {}
    form = str(form)[:LONGEST]
    if form.lower() in law.forms:
        return law, form.lower(), {}
    known = " or ".join(law.forms)
    problem = f"friction_form = {form!r} does not go with law = {law.name!r}. Choose {known}."
    return None, None, {"friction_form": problem}


def values_of(entries):
    """Return the values of entries, a dict in SI; None if they cannot be used."""
    try:
        return state_of(entries).values
    except BadEntries:
        return None


def protocol_of(entries):
    """Return the rows of the protocol in entries, see `state.rows_of`; [] if there is none."""
    text = entries.get("protocol") if isinstance(entries, dict) else None
    return rows_of(text) if isinstance(text, str) and text else []


def completed(entries):
    """Return the texts of valid entries with their units, a dict."""
    quantities = rs.QUANTITIES
    texts = {
        name: with_unit(BEFORE.get(name, name), text)
        for name, text in entries.items()
        if isinstance(text, str) and BEFORE.get(name, name) in quantities
    }
    if rows := protocol_of(entries):
        texts["protocol"] = text_of_rows(rows)
    return texts


def entries_of(state, digits=6):
    """Return what `state_of` reads: symbol -> text with unit, rounded to `digits`, and names."""
    values = state.values
    parameters = state.slider.friction_law.parameters
    earlier = [name for name in BEFORE if values[name] is not None]
    texts = {
        name: rs.readable(BEFORE.get(name, name), values[name], digits)
        for name in dict.fromkeys((*SYMBOLS, *parameters, *NONE, *earlier))
    }
    if state.protocol:
        texts["protocol"] = text_of(state.protocol, digits)
    if state.kick is not None:
        texts["kick"] = f"{state.kick:.{digits}g}"
    return texts | {name: values[name] for name in ("law", "friction_form")}


def fragment_of(slider, V_lp):
    """Return the fragment (after #) of the page's address that opens a slider and a speed."""
    return urlencode(entries_of(PageState(slider, V_lp), digits=DIGITS))


def address_of(port, fragment=""):
    """Return the page's address, which opens it with a slider if there is a fragment."""
    return f"http://127.0.0.1:{port}/{fragment and '#'}{fragment}"
