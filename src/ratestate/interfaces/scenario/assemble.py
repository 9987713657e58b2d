"""Assembles a scenario from the tables of a file, once all of them have been read."""

import functools
from typing import Any, NamedTuple

import numpy as np

from ...dynamics.continuation.branch import checked_family
from ...model.parameters import OTHER_QUANTITIES, parameter_to_si
from ...model.quantities import remedy
from ...model.slider import SpringSlider
from .checks import check_rtol, check_run
from .known_keys import NEEDED, example, parameter_keys
from .loading_table import LoadingTable
from .model import FUNCTIONS, Output, Scenario
from .problems import Place, Problem
from .tables import Sweep


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
        """A table, for messages."""
        return Place((name,), self.problems)

    def place(self, key: str) -> Place:
        """The key, for messages, where it is or should be: in [sweep] before [run]."""
        of_sweep = key in self.sweep.values or (key not in self.run and "run" not in self.names)
        return self.table("sweep" if of_sweep and "sweep" in self.names else "run").at(key)


def assemble(tables: Tables) -> Scenario | None:
    """The scenario, or None if there are problems; those found here join `tables.problems`."""
    slider = _slider(tables)
    verb, own, swept, branch = tables.sweep
    if swept.get("V_lp") is not None and tables.loading.is_record:
        tables.place("V_lp").add("loading.of_record", like=example("V_lp"))
    _note_missing_speed(tables)
    of_slider = parameter_keys()
    run = dict(tables.run)
    if verb != "frequency_response":
        run.pop("frequency", None)
    if own != verb:  # the meaning of rtol differs between functions
        run.pop("rtol", None)
    if verb == "limit_cycle" and (own != verb or "sweep" in tables.names):
        run.pop("V_start", None)  # of the run
    settings = run | {k: v for k, v in swept.items() if k not in of_slider}
    if verb == "simulate":
        V_last = settings.pop("V_lp", None)
        if "t_end" not in settings:
            tables.place("t_end").add("key.missing", wanted=remedy("t_end"))
        loading = tables.loading.build(V_last, settings.get("t_end"))
        check_run(slider, settings, loading, tables.place)
        settings = {"loading": loading} | settings
    elif verb:
        settings = {k: v for k, v in settings.items() if k in FUNCTIONS[verb].keys}
        if branch.get("parameter") != "V_lp":
            settings = {"V_lp": _last_speed(tables)} | settings
        if "rtol" in settings:
            check_rtol(verb, settings["rtol"], tables.place("rtol"))
        settings = _in_si(branch, slider) | settings
    if verb == "continue_cycle" and slider is not None and branch and not tables.problems:
        arguments = {"V_lp": None, "rtol": 1e-8} | settings
        check = functools.partial(checked_family, slider, **arguments)
        place = tables.table("sweep").at(branch["parameter"])
        place.noting(check)
    if tables.problems or slider is None:
        return None
    return Scenario(verb, slider, settings, Output(**tables.output))


def _in_si(branch: dict[str, Any], slider: SpringSlider | None) -> dict[str, Any]:
    """The keys of a branch with its ends in SI, if they are known."""
    if slider is None or None in branch.values():
        return branch
    symbol = branch.get("parameter", "")
    ends = {key: value for key, value in branch.items() if key != "parameter"}
    given = slider.values
    return branch | {key: parameter_to_si(symbol, x, given) for key, x in ends.items()}


def _slider(tables: Tables) -> SpringSlider | None:
    """The slider, or None if it cannot be made."""
    of_slider = parameter_keys()
    values = tables.slider | {k: v for k, v in tables.sweep.values.items() if k in of_slider}
    followed = tables.sweep.branch
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
        where = tables.table("sweep" if key in tables.sweep.values else "slider").at(key)
        read = functools.partial(parameter_to_si, key, values[key], given)
        if (value := where.noting(read)) is not None:
            given[key] = value
    if len(tables.problems) > before:
        return None
    make = functools.partial(SpringSlider, **values | given)
    return place.noting(make)


def _note_missing_speed(tables: Tables) -> None:
    """Note a missing load-point speed, or a missing one before its first step."""
    loading = tables.loading
    swept = "V_lp" in tables.sweep.values or tables.sweep.branch.get("parameter") == "V_lp"
    if not (loading.is_record or "V_lp" in loading.given or (swept and loading.final == 0)):
        only_sweep = "sweep" in tables.names and "loading" not in tables.names
        tables.table("sweep" if only_sweep else "loading").missing("V_lp")


def _last_speed(tables: Tables) -> Any:
    """The speed at which the loading ends, where it is not swept."""
    swept = tables.sweep.values
    place, last = tables.loading.last
    if "V_lp" in swept:
        place, last = tables.place("V_lp"), swept["V_lp"]
    if last is not None and not np.all(np.greater(last, 0.0)):
        place.add("loading.at_rest", verb=tables.sweep.verb, wanted=remedy("V_lp"))
    return last
