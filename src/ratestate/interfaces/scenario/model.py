"""A scenario: a function to call, its slider, its settings, and where the result goes."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from ...dynamics.continuation.branch import check_rtol, checked_family, continue_cycle
from ...dynamics.cycles.limit_cycle import limit_cycle_call
from ...dynamics.simulation.settings import solver_settings
from ...model.slider import SpringSlider
from ...sweeps.calls import FUNCTIONS as SWEPT

#: for checks that do not depend on the slider
ANY = SpringSlider(a=1, b=2, Dc=1, sigma=1, K=1, M=1)


class Function(NamedTuple):
    """A function that a scenario calls."""

    call: Callable[..., Any]
    checked: Callable[..., Any]  # raises ParameterError for arguments that it would refuse
    keys: tuple[str, ...]  # its parameters in [sweep], beside those of the slider
    commands: tuple[str, str]  # the commands that call it, for one case and for many
    check_rtol: Callable[[float], Any] | None = None  # raises ParameterError


#: value of the key verb -> its function
FUNCTIONS = {
    "limit_cycle": Function(
        *SWEPT["limit_cycle"],
        keys=("V_lp", "V_start", "rtol"),
        commands=("cycle", "sweep"),
        check_rtol=lambda rtol: limit_cycle_call(ANY, 1.0, rtol=rtol),
    ),
    "simulate": Function(
        *SWEPT["simulate"],
        keys=("V_lp", "t_end", "V_start", "times", "rtol"),
        commands=("run", "sweep"),
        check_rtol=lambda rtol: solver_settings(rtol, "auto"),
    ),
    "stability": Function(*SWEPT["stability"], keys=("V_lp",), commands=("stability", "sweep")),
    "frequency_response": Function(
        *SWEPT["frequency_response"],
        keys=("V_lp", "frequency"),
        commands=("response", "sweep"),
    ),
    "continue_cycle": Function(
        continue_cycle,
        checked_family,
        keys=("V_lp", "rtol"),
        commands=("branch", "branch"),
        check_rtol=check_rtol,
    ),
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
        The function: "simulate", "limit_cycle", "stability", "frequency_response" or
        "continue_cycle".
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
        What the function returns; it raises what that raises.
    """
    return FUNCTIONS[scenario.verb].call(scenario.slider, **scenario.settings)
