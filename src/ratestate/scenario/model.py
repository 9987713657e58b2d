"""A scenario: a verb, its slider, its settings, and where the result goes."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..branch import continue_cycle
from ..cycles import limit_cycle
from ..simulate import simulate
from ..slider import SpringSlider
from ..steady import stability

#: name -> verb
VERBS: dict[str, Callable[..., Any]] = {
    "limit_cycle": limit_cycle,
    "simulate": simulate,
    "stability": stability,
    "continue_cycle": continue_cycle,
}


@dataclasses.dataclass(frozen=True)
class Output:
    """Where a result goes, relative to the current directory.

    Attributes
    ----------
    file : Path or None
        Ends in .nc, .csv or .zarr.
    plot : Path or None
        Ends in .png or .pdf.
    """

    file: Path | None = None
    plot: Path | None = None


@dataclasses.dataclass(frozen=True, eq=False)
class Scenario:
    """What is to be done: ``getattr(ratestate, verb)(slider, **settings)``.

    Attributes
    ----------
    verb : str
        "simulate", "limit_cycle", "stability" or "continue_cycle".
    slider : SpringSlider
        With a DataArray for each parameter that is swept.
    settings : dict
        Keyword arguments of the verb, in SI; DataArrays likewise.  What the verb chooses by
        itself is left out.
    output : Output
        Where the result goes.
    """

    verb: str
    slider: SpringSlider
    settings: dict[str, Any]
    output: Output = Output()


def run(scenario: Scenario) -> Any:
    """Do what a scenario asks for; the verb's Dataset.  Its ``output`` is left to the caller."""
    return VERBS[scenario.verb](scenario.slider, **scenario.settings)
