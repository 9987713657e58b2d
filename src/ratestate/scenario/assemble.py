"""Build the scenario from its tables; refuse arguments that exclude each other."""

import functools
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.continuation.branch import checked_family
from ..dynamics.simulation.settings import check_normal_stress, saved_times
from ..model.arrays import Batch
from ..model.initial_state import initial_state, initial_values
from ..model.loading import Loading
from ..model.parameters import OTHER_QUANTITIES, parameter_to_si
from ..model.quantities import QUANTITIES
from ..model.slider import SpringSlider
from ..model.units import is_array
from .known_keys import NEEDED, example, parameter_keys
from .loading_table import LoadingTable
from .problems import Place, Problem
from .scenario import FUNCTIONS, Output, Scenario
from .tables import Sweep

MAX_CHECKED = 10**5  # cases whose initial values are checked one by one


class Tables(NamedTuple):
    """The values in the tables of a file; None stands for a value with a problem."""

    problems: list[Problem]
    names: frozenset[str]  # of the tables that the file has
    slider: dict[str, Any]
    loading: LoadingTable
    run: dict[str, Any]
    sweep: Sweep
    output: dict[str, Any]

    def table(self, name: str) -> Place:
        """Return a table, for messages."""
        return Place((name,), self.problems)

    def place(self, key: str) -> Place:
        """Return a key, for messages: in [sweep], which comes first, or in [run]."""
        of_sweep = key in self.sweep.values or (key not in self.run and "run" not in self.names)
        return self.table("sweep" if of_sweep and "sweep" in self.names else "run").at(key)


def assemble(tables: Tables) -> Scenario | None:
    """Return the scenario, or None if there are problems; note those that are found here."""
    slider = _slider(tables)
    function, file_function, swept, branch = tables.sweep
    if swept.get("V_lp") is not None and tables.loading.is_record:
        tables.place("V_lp").add("loading.of_record", like=example("V_lp"))
    _note_missing_speed(tables)
    run = dict(tables.run)
    if file_function != function:  # functions have rtol of different meanings
        run.pop("rtol", None)
    if function == "limit_cycle" and (file_function != function or "sweep" in tables.names):
        run.pop("V_start", None)  # of the run
    settings = run | {k: v for k, v in swept.items() if k not in parameter_keys()}
    if function:
        check_rtol = FUNCTIONS[function].check_rtol
        if check_rtol and settings.get("rtol") is not None:
            tables.place("rtol").attempt(lambda: check_rtol(settings["rtol"]))
    if function == "simulate":
        settings.pop("frequency", None)
        V_last = settings.pop("V_lp", None)
        if "t_end" not in settings:
            tables.place("t_end").add("key.missing", wanted=QUANTITIES["t_end"].remedy)
        loading = tables.loading.build(V_last, settings.get("t_end"))
        _check_run(slider, settings, loading, tables)
        settings = {"loading": loading} | settings
    elif function:
        settings = {k: v for k, v in settings.items() if k in FUNCTIONS[function].keys}
        if branch.get("parameter") != "V_lp":
            settings = {"V_lp": _last_speed(tables)} | settings
        if slider is not None and None not in branch.values():
            symbol, given = branch.get("parameter"), slider.values
            ends = branch.keys() - {"parameter"}
            branch = branch | {key: parameter_to_si(symbol, branch[key], given) for key in ends}
        settings = branch | settings
    if function == "continue_cycle" and slider is not None and branch and not tables.problems:
        check = functools.partial(checked_family, slider, **{"V_lp": None, "rtol": 1e-8} | settings)
        tables.table("sweep").at(branch["parameter"]).attempt(check)
    if tables.problems or slider is None:
        return None
    return Scenario(function, slider, settings, Output(**tables.output))


def _slider(tables: Tables) -> SpringSlider | None:
    """Return the slider, or None if it cannot be made."""
    swept, followed = tables.sweep.values, tables.sweep.branch
    values = tables.slider | {k: v for k, v in swept.items() if k in parameter_keys()}
    if followed.get("parameter") in NEEDED:  # the branch begins there
        values = {followed["parameter"]: followed["start"]} | values
    place = tables.table("slider")
    absent = [key for key in NEEDED if key not in values]
    for key in absent:
        place.missing(key)
    if absent or any(value is None for value in values.values()):
        return None
    before = len(tables.problems)
    given: dict[str, Any] = {}
    for key in [key for key in ("area", *OTHER_QUANTITIES) if key in values]:
        read = functools.partial(parameter_to_si, key, values[key], given)
        where = tables.table("sweep" if key in swept else "slider").at(key)
        if (value := where.attempt(read)) is not None:
            given[key] = value
    if len(tables.problems) > before:
        return None
    return place.attempt(lambda: SpringSlider(**values | given))


def _note_missing_speed(tables: Tables) -> None:
    """Note that the load-point speed is missing, or that before its first step."""
    loading = tables.loading
    swept = "V_lp" in tables.sweep.values or tables.sweep.branch.get("parameter") == "V_lp"
    if not (loading.is_record or "V_lp" in loading.given or (swept and loading.final == 0)):
        only_sweep = "sweep" in tables.names and "loading" not in tables.names
        tables.table("sweep" if only_sweep else "loading").missing("V_lp")


def _last_speed(tables: Tables) -> Any:
    """Return the last speed of the loading, or the swept ones; note a rest."""
    swept = tables.sweep.values
    place, last = tables.loading.last
    if "V_lp" in swept:
        place, last = tables.place("V_lp"), swept["V_lp"]
    if last is not None and not np.all(np.greater(last, 0.0)):
        place.add(
            "loading.at_rest", function=tables.sweep.function, wanted=QUANTITIES["V_lp"].remedy
        )
    return last


def _check_run(
    slider: SpringSlider | None,
    values: dict[str, Any],
    loading: Loading | None,
    tables: Tables,
) -> None:
    """Note arguments that `simulate` would refuse, of which some may be unknown or None."""
    t_end, times, place = values.get("t_end"), values.get("times"), tables.place
    if t_end is not None:
        if loading is not None:
            place("t_end").attempt(lambda: loading.covers(t_end))
        if loading is not None and slider is not None:
            check = functools.partial(check_normal_stress, loading, slider, t_end)
            tables.table("loading").at("sigma").attempt(check)
        place("times").attempt(lambda: saved_times(times, t_end))
    if slider is not None and values.get("initial"):
        place("initial").attempt(lambda: _check_initial(slider, values, loading))
    if loading is None or slider is None or t_end is None:
        return
    if "V_start" not in values and not np.all(np.greater(loading.V_first, 0.0)):
        place("V_start").add("run.no_start", wanted=QUANTITIES["V_start"].remedy)
    if np.isinf(slider.K).any() and rests(loading, float(np.max(t_end))):
        tables.table("slider").at("K").add("run.rigid_rest")


def _check_initial(slider: SpringSlider, values: dict[str, Any], loading: Loading | None) -> None:
    """Raise ParameterError for inconsistent initial values, in sweeps that are not too large."""
    if loading is None and np.isinf(slider.K).any():
        return  # the slider's speed is the load point's, which is unknown
    # (whether V, theta and tau agree depends neither on V_start nor on the loading, if K is finite)
    speeds = Loading.constant(1.0) if loading is None else loading
    start = values.get("V_start")
    given = slider.values | {"V_start": 1.0 if start is None else start}
    given |= initial_values(values["initial"], slider.friction_law)
    batch = Batch(given, {"V_lp": speeds.V} if is_array(speeds.V) else {})
    if batch.n <= MAX_CHECKED:
        table, rows = batch.rows(speeds.V)
        with np.errstate(divide="ignore"):
            initial_state(slider.friction_law, batch, table[rows, 0])


def rests(loading: Loading, t_end: float) -> bool:
    """Return whether a load point comes to rest, in any case, before t_end [s]."""
    used = loading.t < t_end
    ends = np.minimum(np.append(loading.t[1:], np.inf), t_end)[used]
    V, rate = np.asarray(loading.V)[..., used], np.asarray(loading.rate)[..., used]
    return bool((np.minimum(V, V + rate * (ends - loading.t[used])) <= 0.0).any())
