"""A scenario: a function to call, its slider, its settings, and where the result goes."""

import dataclasses
from pathlib import Path
from typing import Any

from ...dynamics.continuation.branch import checked_family, continue_cycle
from ...model.slider import SpringSlider
from ...sweeps.calls import FUNCTIONS as SWEPT

#: name -> function
FUNCTIONS = {name: pair[0] for name, pair in SWEPT.items()} | {"continue_cycle": continue_cycle}
#: name -> function that checks its arguments
CHECKS = {name: pair[1] for name, pair in SWEPT.items()} | {"continue_cycle": checked_family}


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
    """A call to make: ``getattr(ratestate, verb)(slider, **settings)``.

    Attributes
    ----------
    verb : str
        The function: "simulate", "limit_cycle", "stability" or "continue_cycle".
    slider : SpringSlider
        With a DataArray for each parameter that is swept.
    settings : dict
        Keyword arguments of the function, in SI; DataArrays likewise.  Defaults are left out.
    output : Output
        Where the result goes.
    """

    verb: str
    slider: SpringSlider
    settings: dict[str, Any]
    output: Output = Output()


def run(scenario: Scenario) -> Any:
    """Run a scenario; its ``output`` is left to the caller.

    Parameters
    ----------
    scenario : Scenario
        From `load`, `loads` or `from_result`.

    Returns
    -------
    xarray.Dataset
        What the function returns.
    """
    return FUNCTIONS[scenario.verb](scenario.slider, **scenario.settings)
