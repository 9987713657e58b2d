"""The choices on the page: fields, laws with their forms of friction, the paper's sliders."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np

import ratestate as rs
from ratestate.paper import parameters as paper

from . import charts
from .entries import SYMBOLS, TEXT_LIMITS, entries_of, state_of
from .picture import MARKED
from .state import BEFORE, EXPERIMENT, NONE, PageState

FIG1_STEP = float(np.e * paper.FIG1.V0)
# The text of a parameter that only one law has: its name says what it is.
OWN = "A parameter that only this friction law has."


def page_data(starts):
    """Return what the page needs to begin, a dict; starts : as `presets`, the first is opened."""
    # (a page may open with a value that no slider can be centred on, such as 0 or inf)
    defaults = fields(state_of(presets()[0]["entries"]).values)
    return {
        "fields": defaults,
        "laws": menu(),
        "presets": starts,
        "prefixes": {q.unit: q.prefixes for q in rs.QUANTITIES.values() if q.prefixes},
        "before": BEFORE,
        "experiment": EXPERIMENT,
        "meanings": meanings(field["symbol"] for field in defaults),
        "longest": TEXT_LIMITS,
        "span": charts.SPAN,
    }


def fields(defaults):
    """Return list of dicts: symbol, name, unit, usual value [SI], and whether it is marked.

    Fields that only some laws and forms of friction have come last, with the text that they begin
    with.
    """
    laws = rs.laws.catalogue()
    lists = [[*law.forms.values()][:1] for law in laws] + [law.forms.values() for law in laws]
    begin = {symbol: example(symbol) for forms in lists for form in forms for symbol in form} | NONE
    rows = [{"symbol": symbol, "usual": defaults[symbol]} for symbol in SYMBOLS]
    rows += [
        {"symbol": symbol, "usual": rs.to_si(symbol, example(symbol)), "text": text}
        for symbol, text in begin.items()
    ]
    for row in rows:
        quantity = rs.QUANTITIES[row["symbol"]]
        row |= {"name": quantity.long_name, "unit": quantity.unit}
        row["marked"] = row["symbol"] in MARKED
    return rows


def example(symbol):
    """Return a value of a quantity as a user would type it."""
    return rs.QUANTITIES[symbol].example.strip("'\"")


def menu():
    """Return list of dicts, one a law: name, all its names, label, and its forms of friction.

    forms : dict of each form that the law takes, its own first -> symbols of the fields that only
        some laws and forms have
    """
    return [
        {
            "name": law.name,
            "names": law.names,
            "label": law.label,
            "forms": {form: [*symbols, *NONE] for form, symbols in law.forms.items()},
        }
        for law in rs.laws.catalogue()
    ]


def meanings(others):
    """Return symbol or term -> name, unit and text, for meanings.toml and these others."""
    rows = tomllib.loads(Path(__file__).with_name("meanings.toml").read_text("utf-8"))
    return {symbol: _meaning(symbol, rows.get(symbol, OWN)) for symbol in (*rows, *others)}


def _meaning(symbol, row):
    if isinstance(row, dict):
        return row
    quantity = rs.QUANTITIES[symbol]
    return {"name": quantity.long_name, "unit": quantity.unit, "text": row}


def presets():
    """Return list of dicts: ``name``, ``title``, ``entries``; the page opens with the first one."""
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
        {
            "name": name,
            "title": f"{figure}: {name}",
            "entries": entries_of(PageState(slider, V_lp, V_from)),
        }
        for name, figure, slider, V_lp, V_from in rows
    ]
