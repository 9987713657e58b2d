"""The paper's sliders as starting points."""

from typing import Any
from urllib.parse import urlencode

import numpy as np

from ...model.quantities import readable
from ...paper import parameters as paper
from .entries import SYMBOLS

# Digits of values that are not the paper's: all that survive a change of unit.
DIGITS = 15
FIG1_STEP = float(np.e * paper.FIG1.V0)


def presets():
    """dicts with ``name``, ``title`` and ``entries``; the page opens with the first one."""
    rows: list[tuple[str, str, Any, float, float | None]] = [
        ("Stick-slip", "Fig. 4b", paper.FIG4, paper.FIG4_EXAMPLES["stick_slip"], None),
        ("Quasi-harmonic vibration", "Fig. 4c", paper.FIG4, paper.FIG4_EXAMPLES["harmonic"], None),
    ]
    names = ("Step to stable sliding", "Step to just below V_c", "Step to just above V_c")
    for name, V in zip(names, paper.FIG2_SPEEDS, strict=True):
        rows.append((name, "Fig. 2", paper.FIG2, V, paper.FIG2_START))
    slow, fast = paper.FIG6_SPEEDS
    rows.append(("Slow stick-slip", "Fig. 6", paper.FIG6, fast, slow))
    rows.append(("Velocity step, rigid drive", "Fig. 1", paper.FIG1, FIG1_STEP, paper.FIG1.V0))
    return [
        {"name": name, "title": f"{figure}: {name}", "entries": entries_of(slider, V_lp, V_from)}
        for name, figure, slider, V_lp, V_from in rows
    ]


def entries_of(slider, V_lp, V_from=None, digits=6):
    """The entries that describe a slider and a speed."""
    values = {**slider.values, "V_lp": V_lp}
    texts = {symbol: readable(symbol, values[symbol], digits) for symbol in SYMBOLS}
    texts["law"] = slider.law
    return texts | ({} if V_from is None else {"V_from": readable("V_lp", V_from, digits)})


def fragment_of(slider, V_lp):
    """The fragment (after #) of the page's address that opens it with a slider and a speed."""
    return urlencode(entries_of(slider, V_lp, digits=DIGITS))
