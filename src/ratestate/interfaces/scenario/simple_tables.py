"""The tables whose keys have one value each: [slider], [run] and [output]."""

from pathlib import Path
from typing import Any

from ...engine.model import METHODS
from ...errors import ParameterError
from ...files import NUMBERS, PICTURES
from ...friction.laws import LAWS
from ...model.initial_state import SYMBOLS
from .known_keys import LIKE, TABLES, VERBS, keys_to_read, misplaced_axis, note_unknown
from .model import Output
from .problems import Problems, choice, one_of, shown, toml_key
from .values import as_array, number, read_values

ENDINGS = {"file": NUMBERS, "plot": PICTURES}
LONGEST_PATH = 255  # characters
#: key -> the names that it may have as a value
CHOICES = {"law": tuple(LAWS), "method": tuple(METHODS), "verb": tuple(VERBS)}
#: keys that may have many values in [sweep]
AXES = {*TABLES["sweep"]} - {"verb", "law", "rtol", "times"}


def slider_table(table: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """Parameters that all cases share: key -> float or law, or None for one with a problem."""
    known = _known("slider", table, problems)
    return {key: single_value("slider", key, value, problems) for key, value in known}


def run_table(table: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """Arguments of `simulate` but for the loading: key -> value, or None likewise."""
    values: dict[str, Any] = {}
    for key, value in _known("run", table, problems):
        if key == "initial":
            values[key] = _initial(value, problems)
        elif key == "times":
            many = read_values(key, value, "[run] times", problems)
            values[key] = None if many is None else as_array(key, many)
        else:
            values[key] = single_value("run", key, value, problems)
    return values


def single_value(table: str, key: str, value: Any, problems: Problems) -> float | str | None:
    """The value of a key that takes only one."""
    place = f"[{table}] {key}"
    if isinstance(value, dict | list) and key in AXES and table != "sweep":
        problems.add(place, misplaced_axis(key, value))
        return None
    with problems.at(place, key):
        if key in CHOICES:
            return choice(value, CHOICES[key])
        return number(key, value)
    return None


def output_table(table: dict[str, Any], problems: Problems) -> Output:
    """Where the result goes."""
    paths: dict[str, Path] = {}
    for key, value in _known("output", table, problems):
        with problems.at(f"[output] {key}"):
            paths[key] = _path(key, value)
    return Output(**paths)


def _path(key: str, value: Any) -> Path:
    """The path of a file that can be written; ParameterError if it cannot."""
    names = " or ".join(ENDINGS[key])
    wanted = f"expected a file that ends in {names}, such as 'out{ENDINGS[key][0]}'"
    if not isinstance(value, str):
        raise ParameterError(f"{shown(value)} is no text, {wanted}")
    if len(value) > LONGEST_PATH or not value.isprintable():
        raise ParameterError(f"{shown(value)} cannot be a file's name, {wanted}")
    path = Path(value)
    if path.suffix.lower() not in ENDINGS[key]:
        raise ParameterError(f"{shown(value)} ends otherwise, {wanted}")
    if not path.parent.is_dir():
        raise ParameterError(f"{shown(value)}: there is no such folder, {wanted} here")
    return path


def _initial(value: Any, problems: Problems) -> dict[str, float] | None:
    """V, theta and tau at t = 0, as far as they are given."""
    if not isinstance(value, dict):
        what = f"{shown(value)} is no table, expected one such as {LIKE['initial']}"
        problems.add("[run] initial", what)
        return None
    before = len(problems)
    values = {}
    for key, given in value.items():
        place = f"[run] initial.{toml_key(key)}"
        if key in SYMBOLS:
            with problems.at(place, key):
                values[key] = number(key, given)
        else:
            problems.add(place, f"unknown key, {one_of(SYMBOLS, key, LIKE['initial'])}")
    return values if len(problems) == before else None


def _known(name: str, table: dict[str, Any], problems: Problems) -> list[tuple[str, Any]]:
    """The known keys of a table with their values; unknown ones are noted."""
    known = []
    for key, value in keys_to_read(name, table, problems).items():
        if key in TABLES[name]:
            known.append((key, value))
        else:
            note_unknown(name, key, problems)
    return known
