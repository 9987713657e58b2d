"""The tables of a scenario file, their keys, and which of them a verb needs."""

import dataclasses
from collections.abc import Iterable
from typing import Any, NamedTuple

from ..quantities import expected
from ..slider import SpringSlider
from .problems import Problems, bare, nearest, one_of

#: keys of a table that are looked at, at most
MOST_KEYS = 1000


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
#: verb -> its own parameters in [sweep]
VERBS = {
    "limit_cycle": Keys(("V_lp",), ("rtol",)),
    "simulate": Keys(("V_lp", "t_end"), ("V_start", "times", "rtol")),
    "stability": Keys(("V_lp",)),
    "continue_cycle": Keys(("V_lp",), ("rtol",)),
}
#: table -> its keys
TABLES = {
    "slider": SLIDER.keys,
    "loading": ("V_lp", "steps", "sinusoid", "file", "columns", "units", "t"),
    "run": ("verb", "t_end", "V_start", "initial", "times", "rtol", "method", "dt"),
    "sweep": ("verb", "V_lp", "t_end", "V_start", "times", "rtol", *SLIDER.keys),
    "output": ("file", "plot"),
}


def fewer(table: str, given: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """The keys that are looked at: all, unless there are far too many."""
    if len(given) > MOST_KEYS:
        known = ", ".join(TABLES[table])
        problems.add(f"[{table}]", f"has {len(given)} keys, expected some of {known}")
        return {key: value for key, value in given.items() if key in TABLES[table]}
    return given


def unknown(table: str, key: str, problems: Problems, what: str = "unknown key") -> None:
    """Note a key that a table does not have: where it belongs, or what was perhaps meant."""
    place = f"[{table}] {bare(key)}"
    if homes := _homes(key, table):
        problems.add(place, f"stands in the wrong table, expected in {homes}")
        return
    keys = TABLES[table]
    near = None if nearest(key, keys) else nearest(key, {k for t in TABLES.values() for k in t})
    meant = f"; did you mean {near} in {_homes(near, table)}?" if near else ""
    problems.add(place, f"{what}, {one_of(keys, key)}{meant}")


def _homes(key: str, but: str) -> str:
    """The tables that have a key, but for one."""
    homes = [f"[{name}]" for name, keys in TABLES.items() if key in keys and name != but]
    return " or ".join(homes)


def missing(table: str, keys: Iterable[str], problems: Problems) -> None:
    """Note the keys of these names as missing."""
    for key in keys:
        problems.add(f"[{table}] {key}", f"is missing, {expected(key)}")
