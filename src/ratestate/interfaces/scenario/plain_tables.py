"""The tables whose keys are read one by one: [slider], [run] and [output]."""

from pathlib import Path
from typing import Any

from .known_keys import AXES, CHOICES, ENDINGS, INITIAL, example, known_items
from .problems import Place, choice, message, refusal
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
        values = INITIAL.read(value, place, "one ")
        return values if len(place.problems) == before else None
    if key == "times":
        many = read_values(key, value, place)
        return None if many is None else as_array(key, many)
    if isinstance(value, dict | list) and key in AXES:
        place.add("key.no_axis", value, like=example(key))
        return None
    if key in CHOICES:
        return place.noting(lambda: choice(value, CHOICES[key]))
    if key in ENDINGS:
        return place.noting(lambda: _path(key, value))
    return read_number(key, value, place)


def _path(key: str, value: Any) -> Path:
    """The path of a file that can be written; ParameterError if it cannot."""
    endings = ENDINGS[key]
    wanted = message("output.wanted", names=" or ".join(endings), ending=endings[0])
    if not isinstance(value, str):
        raise refusal("output.no_text", value, wanted=wanted)
    if len(value) > LONGEST_PATH or not value.isprintable():
        raise refusal("output.no_name", value, wanted=wanted)
    path = Path(value)
    if path.suffix.lower() not in endings:
        raise refusal("output.ending", value, wanted=wanted)
    if not path.parent.is_dir():
        raise refusal("output.no_folder", value, wanted=wanted)
    return path
