"""From what the tables say to a scenario, once all of them have been read."""

import functools
from typing import Any, NamedTuple

import numpy as np

from ...model.slider import SpringSlider
from .checks import check_branch, check_rtol, check_run
from .drive import Drive
from .model import Output, Scenario
from .problems import Problems, expected
from .sweeps import Sweep
from .tables import SLIDER, VERBS, example, missing


class Read(NamedTuple):
    """What the tables of a file say; None stands for a value with a problem."""

    tables: frozenset[str]  # that the file has
    slider: dict[str, Any]
    drive: Drive
    run: dict[str, Any]
    sweep: Sweep
    output: Output

    def place(self, key: str) -> str:
        """Where a key of [run] or [sweep] stands, or should."""
        if key in self.run:
            return f"[run] {key}"
        if key in self.sweep.values or ("run" not in self.tables and "sweep" in self.tables):
            return f"[sweep] {key}"
        return f"[run] {key}"


def assembled(read: Read, problems: Problems) -> Scenario | None:
    """The scenario, or None if there are problems."""
    slider = _slider(read, problems)
    verb = read.sweep.verb
    V_lp = read.sweep.values.get("V_lp")
    if V_lp is not None and read.drive.is_record:
        what = (
            "cannot stand for the speeds of a record, expected a loading without file and t such as"
        )
        problems.add("[sweep] V_lp", f"{what} {example('V_lp')}")
    _missing_speed(read, problems)
    if verb == "simulate":
        settings = _run(read, slider, problems)
    elif verb == "continue_cycle":
        settings = _branch(read, slider, problems)
    else:
        settings = _of_one_speed(read, problems) if verb else {}
    if problems or slider is None:
        return None
    return Scenario(verb, slider, settings, read.output)


def _slider(read: Read, problems: Problems) -> SpringSlider | None:
    """The slider, or None if it cannot be made."""
    values = read.slider | {k: v for k, v in read.sweep.values.items() if k in SLIDER.keys}
    followed = read.sweep.branch
    if followed.get("parameter") in SLIDER.required:  # the branch begins there
        values = {followed["parameter"]: followed["start"]} | values
    absent = [key for key in SLIDER.required if key not in values]
    missing("slider", absent, problems)
    if absent or any(value is None for value in values.values()):
        return None
    with problems.at("[slider]", expected="expected values", like=example("a")):
        return SpringSlider(**values)
    return None


def _missing_speed(read: Read, problems: Problems) -> None:
    """Note that nothing says how fast the load point goes, or how fast before its first step."""
    drive = read.drive
    swept = "V_lp" in read.sweep.values or read.sweep.branch.get("parameter") == "V_lp"
    if drive.is_record or "V_lp" in drive.given or (swept and drive.final is None):
        return
    alone = "sweep" in read.tables and "loading" not in read.tables
    missing("sweep" if alone else "loading", ["V_lp"], problems)


def _run(read: Read, slider: SpringSlider | None, problems: Problems) -> dict[str, Any]:
    """The settings of `simulate`."""
    given = {k: v for k, v in read.sweep.values.items() if k in VERBS["simulate"].keys}
    V_last = given.pop("V_lp", None)
    run = {k: v for k, v in read.run.items() if k != "rtol" or read.sweep.own == "simulate"}
    values = run | given
    if "t_end" not in values:
        missing(read.place("t_end")[1:].split("]")[0], ["t_end"], problems)
    loading = read.drive.build(V_last, values.get("t_end"), problems)
    place = functools.partial(_place, read, given)
    check_run(slider, values, loading, place, problems)
    return {"loading": loading, **values}


def _place(read: Read, given: dict[str, Any], key: str) -> str:
    """Where a key stands, that of [sweep] before that of [run]."""
    return f"[sweep] {key}" if key in given else read.place(key)


def _branch(read: Read, slider: SpringSlider | None, problems: Problems) -> dict[str, Any]:
    """The settings of `continue_cycle`."""
    settings = dict(read.sweep.branch)
    if settings.get("parameter") == "V_lp":
        settings |= _rtol(read, problems)
    else:
        settings |= _of_one_speed(read, problems)
    if slider is not None and settings and not problems:
        check_branch(slider, settings, problems)
    return settings


def _of_one_speed(read: Read, problems: Problems) -> dict[str, Any]:
    """The settings of a verb that takes the speed at which the loading ends."""
    given = read.sweep.values
    place, last = ("[sweep] V_lp", given["V_lp"]) if "V_lp" in given else read.drive.last
    if last is not None and not np.all(np.greater(last, 0.0)):
        what = f"0 m/s, a loading that ends at rest, has no {read.sweep.verb}"
        problems.add(place, f"{what}, {expected('V_lp')}")
    return {"V_lp": last, **_rtol(read, problems)}


def _rtol(read: Read, problems: Problems) -> dict[str, Any]:
    """The setting rtol of a verb other than `simulate`; it does not mean the same to all."""
    given = {key: value for key, value in read.run.items() if read.sweep.own == read.sweep.verb}
    given |= read.sweep.values
    if "rtol" not in given or "rtol" not in VERBS[read.sweep.verb].keys:
        return {}
    check_rtol(read.sweep.verb, given["rtol"], read.place, problems)
    return {"rtol": given["rtol"]}
