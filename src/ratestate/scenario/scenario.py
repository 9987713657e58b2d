"""A scenario: a function to call, its slider, its settings, and where the result goes."""

import dataclasses
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.continuation.branch import check_rtol, checked_family, continue_cycle
from ..dynamics.cycles.limit_cycle import limit_cycle_call
from ..dynamics.recipe import recorded_call
from ..dynamics.simulation.settings import solver_settings
from ..errors import ParameterError
from ..model.conversion import check_result
from ..model.slider import SpringSlider
from ..model.units import is_array
from ..sweeps.calls import FUNCTIONS as SWEPT

#: for checks that do not depend on the slider
ANY_SLIDER = SpringSlider(a=1, b=2, Dc=1, sigma=1, K=1, M=1)


class Function(NamedTuple):
    """A function that a scenario calls."""

    call: Callable[..., Any]
    checked: Callable[..., Any]  # raises ParameterError for arguments that it would refuse
    keys: tuple[str, ...]  # its parameters in [sweep], beside those of the slider
    commands: tuple[str, str]  # the commands that call it, for one case and for many
    check_rtol: Callable[[float], Any] | None = None  # raises ParameterError


#: value of the key function -> its function
FUNCTIONS = {
    "limit_cycle": Function(
        *(*SWEPT["limit_cycle"], ("V_lp", "V_start", "rtol"), ("cycle", "sweep")),
        lambda rtol: limit_cycle_call(ANY_SLIDER, 1.0, rtol=rtol),
    ),
    "simulate": Function(
        *(*SWEPT["simulate"], ("V_lp", "t_end", "V_start", "times", "rtol"), ("run", "sweep")),
        lambda rtol: solver_settings(rtol, "auto"),
    ),
    "stability": Function(*SWEPT["stability"], ("V_lp",), ("stability", "sweep")),
    "frequency_response": Function(
        *SWEPT["frequency_response"], ("V_lp", "frequency"), ("response", "sweep")
    ),
    "continue_cycle": Function(
        continue_cycle, checked_family, ("V_lp", "rtol"), ("branch", "branch"), check_rtol
    ),
}


@dataclasses.dataclass(frozen=True)
class Output:
    """Files into which a result is written, relative to the current directory.

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
    """A call to make: ``getattr(ratestate, function)(slider, **settings)``.

    Attributes
    ----------
    function : str
        The function: "simulate", "limit_cycle", "stability", "frequency_response" or
        "continue_cycle".
    slider : SpringSlider
        The slider.  Each parameter that is swept is a DataArray.
    settings : dict
        Keyword arguments of the function, in SI.  Each one that is swept is a DataArray.  Defaults
        are left out.
    output : Output
        Where the result goes.
    """

    function: str
    slider: SpringSlider
    settings: dict[str, Any]
    output: Output = Output()


def run(scenario: Scenario) -> Any:
    """Run a scenario and return its result; no file is written.

    Parameters
    ----------
    scenario : Scenario
        From `load`, `loads` or `from_result`.

    Returns
    -------
    xarray.Dataset
        The result of the function.  Errors of the function are raised as they are.
    """
    check_scenario(scenario)
    return FUNCTIONS[scenario.function].call(scenario.slider, **scenario.settings)


def check_scenario(scenario: Scenario) -> None:
    """Raise ParameterError if it is not a `Scenario`."""
    if not isinstance(scenario, Scenario):
        raise ParameterError(
            f"a {type(scenario).__name__} is not a scenario",
            "Give what scenario.load, scenario.loads or scenario.from_result returns.",
        )


def from_result(result: Any) -> Scenario:
    """Return the scenario that made a result: run again, it gives the same bits.

    Parameters
    ----------
    result : xarray.Dataset
        Result of `simulate`, `limit_cycle`, `stability`, `frequency_response` or `continue_cycle`,
        or of a sweep of one of these, as it was returned or as it is read from a file.

    Returns
    -------
    Scenario
        The scenario, without output, for `run`, `toml` and `python`.  If cases were selected from a
        sweep, it has these cases.

    Raises
    ------
    ParameterError
        If the Dataset is not such a result, if an earlier version of ratestate made it, or if it
        has lost attributes or variables that record the scenario.
    """
    wanted = "Give a Dataset as a function of ratestate returned it, or as read from its file."
    check_result(result)
    title = str(result.attrs.get("title", ""))
    if title == "ratestate fit":
        raise ParameterError(
            "a fit has no scenario",
            "Fit the record again with ratestate fit, or with the lines of Python in its "
            "report.md. For the slider of the fit use ratestate.fitted_slider(result).",
        )
    function = title.removeprefix("ratestate ")
    if function not in FUNCTIONS or title == function:
        raise ParameterError(f"a result with the title {title[:60]!r} has no scenario", wanted)
    try:
        slider, given = recorded_call(result)
        known = FUNCTIONS[function]
        bound = inspect.signature(known.call).bind(SpringSlider(**slider), **given)
        settings = {k: x for k, x in given.items() if not _is_default(x, bound.signature, k)}
        scenario = Scenario(function, bound.arguments["slider"], settings)
        bound.apply_defaults()
        getattr(known.checked(**bound.arguments), "batch", None)  # refuses arrays that clash
    except ParameterError:
        raise
    except Exception as error:  # attributes and variables may be altered in any way
        problem = f"the scenario in the result is altered ({type(error).__name__}: {error})"
        raise ParameterError(problem, wanted) from None
    return scenario


def _is_default(value: Any, signature: inspect.Signature, key: str) -> bool:
    if is_array(value) or isinstance(value, np.ndarray):
        return False
    return bool(value == signature.parameters[key].default)
