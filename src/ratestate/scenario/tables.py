"""The tables [slider] and [sweep]: which keys they have, and what their values are."""

import dataclasses
import math
from collections.abc import Container, Iterable
from typing import Any, NamedTuple

import numpy as np

from ..cycles import limit_cycle_call
from ..laws import LAWS
from ..quantities import expected
from ..simulate import saved_times, solver_settings
from ..slider import SpringSlider
from .problems import Problems, bare, choice, one_of, shown
from .values import AXIS, Many, array, axis, number, read

#: cases of a sweep, at most
MOST_CASES = 10**9
ONE_FOR_ALL = {"law", "rtol"}  # keys with one value for all cases
# For checks in which the slider plays no part.
ANY = SpringSlider(a=1, b=2, Dc=1, sigma=1, K=1)


class Keys(NamedTuple):
    """Keys that must be given, and those that may be."""

    required: tuple[str, ...]
    optional: tuple[str, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        return self.required + self.optional


def _keys_of_slider() -> Keys:
    must = {f.name: f.default is dataclasses.MISSING for f in dataclasses.fields(SpringSlider)}
    return Keys(tuple(k for k in must if must[k]), tuple(k for k in must if not must[k]))


#: parameters of the slider
SLIDER = _keys_of_slider()
#: verb -> its own parameters
VERBS = {
    "limit_cycle": Keys(("V_lp",), ("rtol",)),
    "simulate": Keys(("V_lp", "t_end"), ("V_start", "times", "rtol")),
    "stability": Keys(("V_lp",)),
}


def missing(table: str, required: Iterable[str], given: Container[str], problems: Problems) -> None:
    """Note the keys that are required and not given."""
    for key in required:
        if key not in given:
            problems.add(f"[{table}] {key}", f"is missing, {expected(key)}")


def slider_table(table: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """Parameters that all cases share: key -> float or law, or None for one with a problem."""
    values: dict[str, Any] = {}
    for key, value in table.items():
        place = f"[slider] {bare(key)}"
        verbs = [name for name, verb in VERBS.items() if key in verb.keys]
        if verbs or key == "verb":
            problems.add(place, "stands in the wrong table, expected in [sweep]")
        elif key not in SLIDER.keys:
            problems.add(place, f"unknown key, {one_of(SLIDER.keys, key)}")
        elif isinstance(value, dict | list) and key not in ONE_FOR_ALL:
            problems.add(place, f"{shown(value)} makes an axis, expected in [sweep]")
        else:
            values[key] = _one(key, value, place, problems)
    return values


def sweep_table(table: dict[str, Any], problems: Problems) -> tuple[str, dict[str, Any]]:
    """The verb, and parameters: key -> float, law, or DataArray of an axis, or None likewise."""
    verb = ""
    if "verb" not in table:
        problems.add("[sweep] verb", f"is missing, {one_of(VERBS)}")
    else:
        with problems.at("[sweep] verb"):
            verb = choice(table["verb"], VERBS)
    kinds = [VERBS[verb]] if verb else list(VERBS.values())
    known = dict.fromkeys([*SLIDER.keys, *(key for kind in kinds for key in kind.keys)])
    values: dict[str, Any] = {}
    for key, value in table.items():
        place = f"[sweep] {bare(key)}"
        if key in ONE_FOR_ALL & known.keys():
            values[key] = _one(key, value, place, problems)
        elif key in known:
            bound = ">= 0" if key == "V_lp" and verb == "simulate" else None
            values[key] = read(key, value, place, problems, bound)
        elif key != "verb":
            whose = f"the slider or of {verb}" if verb else "the slider or of any verb"
            problems.add(place, f"is no parameter of {whose}, {one_of(known, key)}")
    needed = set.intersection(*(set(kind.required) for kind in kinds))
    missing("sweep", needed, table, problems)
    many = {key for key, value in table.items() if isinstance(value, dict | list)}
    if not many & known.keys() - ONE_FOR_ALL - {"times"}:
        problems.add("[sweep]", f"nothing has many values, expected an axis such as M = {AXIS}")
    if _few_enough(values, problems):
        for key, value in values.items():
            if key == "times" and value is not None:
                values[key] = array(key, value)
            elif isinstance(value, Many):
                values[key] = axis(key, value)
        _check(verb, values, problems)
    return verb, values


def _one(key: str, value: Any, place: str, problems: Problems) -> float | str | None:
    """The value of a key that takes no more than one."""
    with problems.at(place, key):
        if key == "law":
            return choice(value, LAWS)
        return number(key, value)
    return None


def _few_enough(values: dict[str, Any], problems: Problems) -> bool:
    sizes = {k: len(v) for k, v in values.items() if isinstance(v, Many) and k != "times"}
    if (cases := math.prod(sizes.values())) <= MOST_CASES:
        return True
    product = " x ".join(f"{size} {key}" for key, size in sizes.items())
    problems.add("[sweep]", f"{product} are {cases} cases, expected {MOST_CASES} at most")
    return False


def _check(verb: str, values: dict[str, Any], problems: Problems) -> None:
    """Note what the verb will not take, though it is a good value by itself."""
    rtol, times, t_end, V_lp = map(values.get, ("rtol", "times", "t_end", "V_lp"))
    with problems.at("[sweep] rtol", "rtol"):
        if verb == "simulate" and rtol is not None:
            solver_settings(rtol, "rodas5p", None, ANY)
        elif verb == "limit_cycle" and rtol is not None:
            limit_cycle_call(ANY, 1.0, rtol=rtol)
    with problems.at("[sweep] times", "times"):
        if times is not None and t_end is not None:
            saved_times(times, t_end)
    if V_lp is not None and np.any(V_lp == 0.0) and "V_start" not in values:
        what = f"is missing; at V_lp = 0 nothing slides, {expected('V_start')}"
        problems.add("[sweep] V_start", what)
