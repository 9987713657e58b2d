"""Checks of arguments that are valid by themselves but that a function would refuse together."""

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from ...dynamics.simulation.settings import check_normal_stress, saved_times
from ...model.arrays import Batch
from ...model.initial_state import initial_state, initial_values
from ...model.loading import Loading
from ...model.quantities import remedy
from ...model.slider import SpringSlider
from ...model.units import is_array
from .model import FUNCTIONS
from .problems import Place

FEW = 10**5  # cases that are checked one by one


def check_rtol(verb: str, rtol: float | None, place: Place) -> None:
    """Note an rtol that the function would refuse."""
    check = FUNCTIONS[verb].check_rtol
    if check and rtol is not None:
        place.noting(lambda: check(rtol))


def check_run(
    slider: SpringSlider | None,
    values: dict[str, Any],
    loading: Loading | None,
    place: Callable[[str], Place],
) -> None:
    """Note arguments that `simulate` would refuse, of which some may be unknown or None."""
    t_end, times = values.get("t_end"), values.get("times")
    check_rtol("simulate", values.get("rtol"), place("rtol"))
    if loading is not None and t_end is not None:
        place("t_end").noting(lambda: loading.covers(t_end))
    stressed = loading is not None and loading.normal_stress is not None
    if stressed and slider is not None and t_end is not None:
        check = functools.partial(check_normal_stress, loading, slider, t_end)
        where = Place(("loading", "sigma"), place("K").problems)
        where.noting(check)
    if times is not None and t_end is not None:
        place("times").noting(lambda: saved_times(times, t_end))
    if slider is not None and values.get("initial"):
        place("initial").noting(lambda: _check_initial(slider, values, loading))
    if loading is None or slider is None or t_end is None:
        return
    if "V_start" not in values and not np.all(np.greater(loading.V_first, 0.0)):
        place("V_start").add("run.no_start", wanted=remedy("V_start"))
    if np.isinf(slider.K).any() and rests(loading, float(np.max(t_end))):
        Place(("slider", "K"), place("K").problems).add("run.rigid_rest")


def _check_initial(slider: SpringSlider, values: dict[str, Any], loading: Loading | None) -> None:
    """Raise ParameterError for inconsistent initial values, in sweeps that are not too large."""
    if loading is None and np.isinf(slider.K).any():
        return  # the slider's speed is the load point's, which is not known
    first = values.get("V_start")
    if first is None:
        first = 1.0  # (which of V, theta and tau agree does not depend on it)
    speeds = Loading.constant(1.0) if loading is None else loading
    own = {"V_lp": speeds.V} if is_array(speeds.V) else {}
    given = {
        **slider.values,
        "V_start": first,
        **initial_values(values["initial"], slider.friction_law),
    }
    batch = Batch(given, own)
    if batch.n <= FEW:
        table, rows = batch.rows(speeds.V)
        with np.errstate(divide="ignore"):
            initial_state(slider.friction_law, batch, table[rows, 0])


def rests(loading: Loading, t_end: float) -> bool:
    """Whether a load point comes to rest, in any case, before t_end [s]."""
    used = loading.t < t_end
    ends = np.minimum(np.append(loading.t[1:], np.inf), t_end)[used]
    V, rate = np.asarray(loading.V)[..., used], np.asarray(loading.rate)[..., used]
    return bool((np.minimum(V, V + rate * (ends - loading.t[used])) <= 0.0).any())
