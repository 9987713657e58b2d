"""Checks of arguments that are valid by themselves but that a function would refuse together."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...dynamics.continuation.branch import check_rtol as check_rtol_of_branch
from ...dynamics.continuation.branch import checked_family
from ...dynamics.cycles.limit_cycle import limit_cycle_call
from ...dynamics.simulation.cases import MAX_STEPS
from ...dynamics.simulation.simulate import saved_times, solver_settings
from ...errors import ParameterError
from ...model.batch import Batch
from ...model.initial_state import initial_state, initial_values
from ...model.loading import Loading
from ...model.slider import SpringSlider
from ...model.units import is_array
from .known_keys import LIKE
from .problems import Problems, expected
from .sweep_table import BRANCH

# For checks that do not depend on the slider.
ANY = SpringSlider(a=1, b=2, Dc=1, sigma=1, K=1, M=1)
FEW = 10**5  # cases that are checked one by one
TIMES = "expected increasing times up to t_end such as [0.5, '1 s']"
DT = "expected the time step of im2017 such as dt = '0.1 ms'"


#: key -> its table and key in messages, such as "[run] dt"
Place = Callable[[str], str]


def check_rtol(verb: str, rtol: float | None, place: Place, problems: Problems) -> None:
    """Note an rtol that the function would refuse."""
    if rtol is None:
        return
    with problems.at(place("rtol"), "rtol", expected("rtol")):
        if verb == "simulate":
            solver_settings(rtol, "rodas5p", None, ANY)
        elif verb == "limit_cycle":
            limit_cycle_call(ANY, 1.0, rtol=rtol)
        elif verb == "continue_cycle":
            check_rtol_of_branch(rtol)


def check_branch(slider: SpringSlider, settings: dict[str, Any], problems: Problems) -> None:
    """Note arguments with which a branch cannot be followed."""
    place = f"[sweep] {settings['parameter']}"
    with problems.at(place, expected="expected M > 0, b > a and two different ends", like=BRANCH):
        checked_family(slider, **({"V_lp": None, "rtol": 1e-8} | settings))


def check_run(
    slider: SpringSlider | None,
    values: dict[str, Any],
    loading: Loading | None,
    place: Place,
    problems: Problems,
) -> None:
    """Note arguments that `simulate` would refuse; some of them may be unknown.

    values : key -> value, None for one with a problem
    """
    t_end, times = values.get("t_end"), values.get("times")
    check_rtol("simulate", values.get("rtol"), place, problems)
    _check_method(slider, values, place, problems)
    if loading is not None and t_end is not None:
        with problems.at(place("t_end"), "t_end", expected("t_end")):
            loading.covers(t_end)
    if times is not None and t_end is not None:
        with problems.at(place("times"), "times", TIMES):
            saved_times(times, t_end)
    if slider is not None and values.get("initial"):
        _check_initial(slider, values, loading, problems)
    if loading is None or slider is None or t_end is None:
        return
    if "V_start" not in values and not np.all(np.greater(loading.V_first, 0.0)):
        what = f"is missing; at V_lp = 0 nothing slides, {expected('V_start')}"
        problems.add(place("V_start"), what)
    if np.isinf(slider.K).any() and rests(loading, float(np.max(t_end))):
        what = "inf moves the slider with the load point, which comes to rest, where eq. 1 gives no"
        problems.add("[slider] K", f"{what} friction, expected a finite one such as '900 MPa/m'")


def _check_method(
    slider: SpringSlider | None, values: dict[str, Any], place: Place, problems: Problems
) -> None:
    """Note a method and time step that are incompatible with each other or with the slider."""
    method, dt, t_end = (values.get(key) for key in ("method", "dt", "t_end"))
    if {"method", "dt"} & {key for key, value in values.items() if value is None}:
        return
    try:
        solver_settings(1e-6, method or "rodas5p", dt, slider or ANY)
    except ParameterError as error:
        about_dt = str(error).startswith("dt") or "needs a time step" in str(error)
        key, wanted = ("dt", DT) if about_dt else ("method", "expected one such as 'rodas5p'")
        with problems.at(place(key), key, wanted):
            raise
    if dt is not None and t_end is not None and (steps := float(np.max(t_end)) / dt) > MAX_STEPS:
        what = f"{dt:.6g} s makes {steps:.3g} steps up to t_end, more than {MAX_STEPS:.0e}"
        problems.add(place("dt"), f"{what}, {expected('dt')}")


def _check_initial(
    slider: SpringSlider, values: dict[str, Any], loading: Loading | None, problems: Problems
) -> None:
    """Note inconsistent initial values, in sweeps that are not too large.

    Only the slider, the first speed and the initial values themselves matter.
    """
    if loading is None and np.isinf(slider.K).any():
        return  # the slider's speed is the load point's, which is not known
    first = values.get("V_start")
    if first is None:
        first = 1.0  # (which of V, theta and tau agree does not depend on it)
    speeds = Loading.constant(1.0) if loading is None else loading
    with problems.at(
        "[run] initial", expected="expected one or two of V, theta and tau", like=LIKE["initial"]
    ):
        given = initial_values(values["initial"])
        own = {"V_lp": speeds.V} if is_array(speeds.V) else {}
        batch = Batch({**slider.values, "V_start": first, **given}, own)
        if batch.n <= FEW:
            table, rows = batch.rows(speeds.V)
            with np.errstate(divide="ignore"):
                initial_state(batch, table[rows, 0])


def rests(loading: Loading, t_end: float) -> bool:
    """Whether a load point comes to rest, in any case, before t_end [s]."""
    used = loading.t < t_end
    ends = np.minimum(np.append(loading.t[1:], np.inf), t_end)[used]
    V, rate = np.asarray(loading.V)[..., used], np.asarray(loading.rate)[..., used]
    return bool((np.minimum(V, V + rate * (ends - loading.t[used])) <= 0.0).any())
