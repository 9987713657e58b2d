"""What the page offers: fields, laws with their forms of friction, the paper's sliders."""

from typing import Any

import numpy as np

from ....friction.composition import composed, forms_of
from ....friction.forms import FORMS, parameters_of
from ....friction.laws import LAW_NAMES, LAWS, own_parameters
from ....model.quantities import KINDS, POWERS, QUANTITIES, prefixed_unit
from ....model.units import to_si
from ....paper import parameters as paper
from ..computation import charts
from ..computation.marks import MARKED
from ..page_state.entries import LONGEST, SYMBOLS, entries_of, state_of
from ..page_state.state import BEFORE, EXPERIMENT, NONE, PageState
from .meanings import meanings

FIG1_STEP = float(np.e * paper.FIG1.V0)


def offers(starts):
    """dict of what the page needs to begin; starts : as `presets`, the first of them as it opens"""
    # (a page may open with a value that no slider can reach about, such as 0 or inf)
    usual = fields(state_of(presets()[0]["entries"]).values)
    header = {"fields": usual, "laws": menu(), "prefixes": prefixes(), "presets": starts}
    header |= {"before": BEFORE, "experiment": EXPERIMENT}
    header["meanings"] = meanings(field["symbol"] for field in usual)
    return header | {"longest": LONGEST, "span": charts.SPAN}


def fields(usual):
    """list of dicts: symbol, name, unit, usual value [SI], about which its slider reaches, marked.

    Those of a law, of a form of friction and of `NONE`, which follow, also have the text with which
    the field begins.
    """
    own = (own_parameters(LAWS.values()), *map(parameters_of, FORMS))
    begin = {symbol: example(symbol) for symbols in own for symbol in symbols} | NONE
    rows = [{"symbol": symbol, "usual": usual[symbol]} for symbol in SYMBOLS]
    rows += [{"symbol": s, "usual": to_si(s, example(s)), "text": x} for s, x in begin.items()]
    for row in rows:
        quantity = QUANTITIES[row["symbol"]]
        row |= {"name": quantity.long_name, "unit": quantity.unit}
        row["marked"] = row["symbol"] in MARKED
    return rows


def example(symbol):
    """A value of a quantity as a user would type it."""
    quantity = QUANTITIES[symbol]
    return (quantity.example or KINDS[quantity.unit][1]).strip("'\"")


def menu():
    """list of dicts, of each law: name, all its names, label, and its forms of friction.

    forms : dict of each form that the law takes, its own first -> symbols of the fields that only
        some laws and forms have, in this one
    """
    return [
        {
            "name": name,
            "names": [known for known, its in LAW_NAMES.items() if its == name],
            "label": law.label,
            "forms": {form: [*composed(law, form).parameters, *NONE] for form in forms_of(law)},
        }
        for name, law in LAWS.items()
    ]


def prefixes():
    """The prefixes that values of a unit are shown with: unit -> [[power of ten, prefix], ...]."""
    return {
        unit: [[power, prefixed_unit(unit, power).removesuffix(unit)] for power in powers]
        for unit, powers in POWERS.items()
    }


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
        {
            "name": name,
            "title": f"{figure}: {name}",
            "entries": entries_of(PageState(slider, V_lp, V_from)),
        }
        for name, figure, slider, V_lp, V_from in rows
    ]
