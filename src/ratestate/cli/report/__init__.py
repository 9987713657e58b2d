"""What is printed of a result: what a person wants to know first, in units that fit."""

from typing import TYPE_CHECKING, Any

from ...quantities import readable
from .single import branch, cycle, run, stability
from .sweep import cases

if TYPE_CHECKING:
    import xarray

__all__ = ["report"]

#: verb -> its table for a single slider
SINGLE = {"simulate": run, "limit_cycle": cycle, "stability": stability, "continue_cycle": branch}


def report(result: "xarray.Dataset", judged: Any = None) -> list[Any]:
    """What to print, for rich.

    Parameters
    ----------
    result : Dataset
        From a verb, or from `sweep`.
    judged : Verdict, optional
        On a single slider.
    """
    from rich.text import Text

    verb = result.attrs["title"].removeprefix("ratestate ")
    if "message" in result:
        return cases(result, verb)
    table = SINGLE[verb](result)
    if not judged:
        return table
    if verb == "simulate":
        ahead = Text(f"In the long run, at V_lp = {readable('V_lp', judged.V_lp)}", style="bold")
        return [*table, Text(""), ahead, Text(judged.text)]
    return [Text(judged.text), Text(""), *table]
