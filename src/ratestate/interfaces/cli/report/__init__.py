"""What is printed of a result: what a person wants to know first, in units that fit."""

from typing import TYPE_CHECKING, Any

from .fit import fit
from .single import branch, cycle, run, stability
from .sweep import cases

if TYPE_CHECKING:
    import xarray

    from ..spoken import Spoken

__all__ = ["report"]

#: verb -> its table for a single slider
SINGLE = {
    "simulate": run,
    "limit_cycle": cycle,
    "stability": stability,
    "continue_cycle": branch,
    "fit": fit,
}


def report(result: "xarray.Dataset", said: "Spoken | None" = None) -> list[Any]:
    """What to print, for rich.

    Parameters
    ----------
    result : Dataset
        From a verb, or from `sweep`.
    said : Spoken, optional
        On a single slider.
    """
    from rich.text import Text

    verb = result.attrs["title"].removeprefix("ratestate ")
    if "message" in result:
        return cases(result, verb)
    table = SINGLE[verb](result)
    if not said:
        return table
    if verb == "simulate":
        return [*table, Text(""), Text(f"{said.about}:", style="bold"), Text(said.text)]
    return [Text(said.text), Text(""), *table]
