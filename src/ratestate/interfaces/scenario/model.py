"""A scenario: a function to call, its slider, its settings, and where the result goes."""

import dataclasses
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...dynamics.continuation.branch import checked_family, continue_cycle
from ...dynamics.cycles.limit_cycle import limit_cycle, limit_cycle_call
from ...dynamics.simulation.simulate import simulate, simulate_call
from ...dynamics.steady_sliding import stability, stability_call
from ...model.slider import SpringSlider

#: name -> function
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "limit_cycle": limit_cycle,
    "simulate": simulate,
    "stability": stability,
    "continue_cycle": continue_cycle,
}
#: name -> function that checks its arguments
CHECKS: dict[str, Callable[..., Any]] = {
    "limit_cycle": lambda **given: limit_cycle_call(**given).batch,
    "simulate": lambda **given: simulate_call(**given).batch,
    "stability": lambda **given: stability_call(**given).batch,
    "continue_cycle": checked_family,
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


def check(scenario: Scenario) -> None:
    """Raise ParameterError for a scenario that its function would refuse."""
    verb = FUNCTIONS[scenario.verb]
    bound = inspect.signature(verb).bind(scenario.slider, **scenario.settings)
    bound.apply_defaults()
    CHECKS[scenario.verb](**bound.arguments)


def run(scenario: Scenario) -> Any:
    """Run a scenario and return the function's Dataset; its ``output`` is left to the caller."""
    return FUNCTIONS[scenario.verb](scenario.slider, **scenario.settings)
