"""Tables of a result for the terminal: what a person wants to know first, in fitting units.

=============================== ===========================================================
``single``                      a run, a cycle, stability, a branch
``response``                    a frequency response: gains and phases
``sweep``                       a sweep: how cases ended, ranges, failed cases
``fit``                         a fit, in the fullest layout that the terminal has room for
``events``                      a catalogue of stick-slip events
``domain``                      cases that leave the domain of the friction law
``rows``                        rows about one slider: what stands for NaN and inf
``markdown``, ``markdown.toml`` report.md of a fit, and its sentences
=============================== ===========================================================
"""

from typing import Any

import xarray
from rich.text import Text

from ..verdict_text import VerdictText
from .response import response
from .rows import Units
from .single import branch, cycle, run, stability
from .sweep import cases

#: function -> the table of its result for a single slider
SINGLE = {
    "simulate": run,
    "limit_cycle": cycle,
    "stability": stability,
    "frequency_response": response,
    "continue_cycle": branch,
}


def report(
    result: xarray.Dataset, verdict: VerdictText | None, units: Units | None = None
) -> list[Any]:
    """What to print, a list for rich: a result of any of the package's functions, `sweep` included.

    units : symbol -> the unit in which the tables have it; without effect on a fit
    verdict : on a single slider; without effect on a sweep or a fit
    """
    verb = result.attrs["title"].removeprefix("ratestate ")
    if "message" in result and verb != "fit":
        return cases(result, verb, units or {})
    if verb == "fit":
        from .fit import fit  # what it needs takes long to load

        return fit(result)
    table = SINGLE[verb](result, units or {})
    if not verdict:
        return table
    if verb == "simulate":
        return [*table, Text(""), Text(f"{verdict.about}:", style="bold"), Text(verdict.text)]
    return [Text(verdict.text), Text(""), *table]
