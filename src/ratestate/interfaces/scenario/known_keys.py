"""The tables of a scenario file, their keys, and which of them each function needs."""

import dataclasses
from collections.abc import Iterable
from typing import Any, NamedTuple

from ...model.quantities import KINDS, QUANTITIES
from ...model.slider import SpringSlider
from .loading_shapes import SINE_LIKE, STEPS_LIKE
from .problems import Problems, expected, nearest, one_of, shown, toml_key
from .record import COLUMNS_LIKE, UNITS_LIKE

#: in a table with more keys only known ones are read
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
#: value of the key verb -> the function's own parameters in [sweep]
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


TIMES_LIKE = "[0, 1, 1, '5 s']"
SPEEDS_LIKE = "['1 um/s', '1 um/s', '3 um/s', 0]"
#: key, or key and table -> an example of its value, where that is no quantity
LIKE = {
    "law": "'slip'",
    "verb": "'limit_cycle'",
    "method": "'rodas5p'",
    "initial": "{ theta = '10 s' }",
    "times": "[0.5, '1 s']",
    "steps": STEPS_LIKE,
    "sinusoid": SINE_LIKE,
    "file loading": "'record.csv'",
    "columns": COLUMNS_LIKE,
    "units": UNITS_LIKE,
    "t": TIMES_LIKE,
    "file": "'out.nc'",
    "plot": "'out.png'",
}


def example(key: str, table: str = "") -> str:
    """An example of a line that sets a key of a table."""
    value = LIKE.get(f"{key} {table}") or LIKE.get(key)
    if value is None:
        quantity = QUANTITIES[key]
        value = quantity.example or KINDS[quantity.unit][1]
    return f"{key} = {value}"


def misplaced_axis(key: str, value: Any) -> str:
    """The message about many values for a key that takes only one."""
    return f"{shown(value)} makes an axis, expected in [sweep], or one value such as {example(key)}"


def keys_to_read(table: str, given: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """The keys to read of a table: all, or if there are far too many, only the known ones."""
    if len(given) > MOST_KEYS:
        known = ", ".join(TABLES[table])
        what = f"has {len(given)} keys, expected some of {known}"
        problems.add(f"[{table}]", f"{what} such as {example(TABLES[table][0], table)}")
        return {key: value for key, value in given.items() if key in TABLES[table]}
    return given


def note_unknown(table: str, key: str, problems: Problems, what: str = "unknown key") -> None:
    """Note an unknown key of a table: with the table where it belongs, or a similar key."""
    place = f"[{table}] {toml_key(key)}"
    if homes := _homes(key, table):
        what = f"stands in the wrong table, expected in {homes}"
        problems.add(place, f"{what} such as {example(key)}")
        return
    keys = TABLES[table]
    own = nearest(key, keys)
    near = None if own else nearest(key, {k for t in TABLES.values() for k in t})
    meant = f"; did you mean {near} in {_homes(near, table)}?" if near else ""
    problems.add(place, f"{what}, {one_of(keys, key, example(own or keys[0], table))}{meant}")


def _homes(key: str, but: str) -> str:
    """The tables that have a key, except one."""
    homes = [f"[{name}]" for name, keys in TABLES.items() if key in keys and name != but]
    return " or ".join(homes)


def note_missing(table: str, keys: Iterable[str], problems: Problems) -> None:
    """Note that these keys are missing."""
    for key in keys:
        problems.add(f"[{table}] {key}", f"is missing, {expected(key)}")
