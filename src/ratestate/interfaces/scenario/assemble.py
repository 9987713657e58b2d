"""Assembles a scenario from the tables of a file, once all of them have been read."""

import functools
from typing import Any, NamedTuple

import numpy as np

from ...model.slider import SpringSlider
from .checks import check_branch, check_rtol, check_run
from .known_keys import SLIDER, VERBS, example, note_missing
from .loading_table import LoadingTable
from .model import Output, Scenario
from .problems import Problems, expected
from .sweep_table import Sweep


class Tables(NamedTuple):
    """The values in the tables of a file; None stands for a value with a problem."""

    names: frozenset[str]  # of the tables that the file has
    slider: dict[str, Any]
    loading: LoadingTable
    run: dict[str, Any]
    sweep: Sweep
    output: Output

    def place(self, key: str) -> str:
        """The table and key, for messages, where a key of [run] or [sweep] is or should be."""
        if key in self.run:
            return f"[run] {key}"
        if key in self.sweep.values or ("run" not in self.names and "sweep" in self.names):
            return f"[sweep] {key}"
        return f"[run] {key}"


def assemble(tables: Tables, problems: Problems) -> Scenario | None:
    """The scenario, or None if there are problems."""
    slider = _slider(tables, problems)
    verb = tables.sweep.verb
    V_lp = tables.sweep.values.get("V_lp")
    if V_lp is not None and tables.loading.is_record:
        what = (
            "cannot stand for the speeds of a record, expected a loading without file and t such as"
        )
        problems.add("[sweep] V_lp", f"{what} {example('V_lp')}")
    _missing_speed(tables, problems)
    if verb == "simulate":
        settings = _run(tables, slider, problems)
    elif verb == "continue_cycle":
        settings = _branch(tables, slider, problems)
    else:
        settings = _of_one_speed(tables, problems) if verb else {}
    if problems or slider is None:
        return None
    return Scenario(verb, slider, settings, tables.output)


def _slider(tables: Tables, problems: Problems) -> SpringSlider | None:
    """The slider, or None if it cannot be made."""
    values = tables.slider | {k: v for k, v in tables.sweep.values.items() if k in SLIDER.keys}
    followed = tables.sweep.branch
    if followed.get("parameter") in SLIDER.required:  # the branch begins there
        values = {followed["parameter"]: followed["start"]} | values
    absent = [key for key in SLIDER.required if key not in values]
    note_missing("slider", absent, problems)
    if absent or any(value is None for value in values.values()):
        return None
    with problems.at("[slider]", expected="expected values", like=example("a")):
        return SpringSlider(**values)
    return None


def _missing_speed(tables: Tables, problems: Problems) -> None:
    """Note a missing load-point speed, or a missing one before its first step."""
    loading = tables.loading
    swept = "V_lp" in tables.sweep.values or tables.sweep.branch.get("parameter") == "V_lp"
    if loading.is_record or "V_lp" in loading.given or (swept and loading.final is None):
        return
    only_sweep = "sweep" in tables.names and "loading" not in tables.names
    note_missing("sweep" if only_sweep else "loading", ["V_lp"], problems)


def _run(tables: Tables, slider: SpringSlider | None, problems: Problems) -> dict[str, Any]:
    """The settings of `simulate`."""
    given = {k: v for k, v in tables.sweep.values.items() if k in VERBS["simulate"].keys}
    V_last = given.pop("V_lp", None)
    run = {k: v for k, v in tables.run.items() if k != "rtol" or tables.sweep.own == "simulate"}
    values = run | given
    if "t_end" not in values:
        note_missing(tables.place("t_end")[1:].split("]")[0], ["t_end"], problems)
    loading = tables.loading.build(V_last, values.get("t_end"), problems)
    place = functools.partial(_place, tables, given)
    check_run(slider, values, loading, place, problems)
    return {"loading": loading, **values}


def _place(tables: Tables, given: dict[str, Any], key: str) -> str:
    """The table and key, for messages: that of [sweep] before that of [run]."""
    return f"[sweep] {key}" if key in given else tables.place(key)


def _branch(tables: Tables, slider: SpringSlider | None, problems: Problems) -> dict[str, Any]:
    """The settings of `continue_cycle`."""
    settings = dict(tables.sweep.branch)
    if settings.get("parameter") == "V_lp":
        settings |= _rtol(tables, problems)
    else:
        settings |= _of_one_speed(tables, problems)
    if slider is not None and settings and not problems:
        check_branch(slider, settings, problems)
    return settings


def _of_one_speed(tables: Tables, problems: Problems) -> dict[str, Any]:
    """The settings of a function that takes the speed at which the loading ends."""
    given = tables.sweep.values
    place, last = ("[sweep] V_lp", given["V_lp"]) if "V_lp" in given else tables.loading.last
    if last is not None and not np.all(np.greater(last, 0.0)):
        what = f"0 m/s, a loading that ends at rest, has no {tables.sweep.verb}"
        problems.add(place, f"{what}, {expected('V_lp')}")
    return {"V_lp": last, **_rtol(tables, problems)}


def _rtol(tables: Tables, problems: Problems) -> dict[str, Any]:
    """The setting rtol of a function other than `simulate`; its meaning differs between them."""
    given = {
        key: value for key, value in tables.run.items() if tables.sweep.own == tables.sweep.verb
    }
    given |= tables.sweep.values
    if "rtol" not in given or "rtol" not in VERBS[tables.sweep.verb].keys:
        return {}
    check_rtol(tables.sweep.verb, given["rtol"], tables.place, problems)
    return {"rtol": given["rtol"]}
