"""Tables of a result for the terminal: what a person wants to know first, in fitting units."""

from typing import TYPE_CHECKING, Any

from .fit import fit
from .single import branch, cycle, run, stability
from .sweep import cases

if TYPE_CHECKING:
    import xarray

    from ..verdict_text import VerdictText

__all__ = ["report"]

#: function -> the table of its result for a single slider
SINGLE = {
    "simulate": run,
    "limit_cycle": cycle,
    "stability": stability,
    "continue_cycle": branch,
    "fit": fit,
}


def report(result: "xarray.Dataset", verdict: "VerdictText | None" = None) -> list[Any]:
    """What to print, for rich.

    Parameters
    ----------
    result : Dataset
        Of one of the package's functions, `sweep` included.
    verdict : VerdictText, optional
        On a single slider.
    """
    from rich.text import Text

    verb = result.attrs["title"].removeprefix("ratestate ")
    if "message" in result:
        return cases(result, verb)
    table = SINGLE[verb](result)
    if not verdict:
        return table
    if verb == "simulate":
        return [*table, Text(""), Text(f"{verdict.about}:", style="bold"), Text(verdict.text)]
    return [Text(verdict.text), Text(""), *table]
