"""The tables whose keys are read one by one: [slider], [run] and [output]."""

from pathlib import Path
from typing import Any

from ...errors import ParameterError
from .known_keys import AXES, CHOICES, ENDINGS, INITIAL, known_items, misplaced_axis
from .problems import Place, choice, shown
from .values import as_array, read_number, read_values

LONGEST_PATH = 255  # characters


def plain_table(name: str, table: dict[str, Any], problems: list[str]) -> dict[str, Any]:
    """The values of such a table: key -> value, or None for one with a problem."""
    place = Place(f"[{name}]", problems)
    items = known_items(name, table, place)
    return {key: read_value(key, value, place.at(key)) for key, value in items}


def read_value(key: str, value: Any, place: Place) -> Any:
    """The value of a key that has no axis here."""
    if key == "initial":
        before = len(place.problems)
        values = INITIAL.read(value, place, "one such as")
        return values if len(place.problems) == before else None
    if key == "times":
        many = read_values(key, value, place)
        return None if many is None else as_array(key, many)
    if isinstance(value, dict | list) and key in AXES:
        place.add(misplaced_axis(key, value))
        return None
    if key in CHOICES:
        return place.noting(lambda: choice(value, CHOICES[key]))
    if key in ENDINGS:
        return place.noting(lambda: _path(key, value))
    return read_number(key, value, place)


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
