"""Run the law file that a scenario names, which is code, and make its law the slider's."""

from pathlib import Path
from typing import Any

from ..friction.law_formula import HASH_MARK
from ..friction.laws import find_law_name, friction_law
from ..model.user_laws import register
from .known_keys import example, keys_of, tables_with
from .problems import Place, Problem, message, refusal

LONGEST_NAME = 1000  # characters


def take_law_file(
    tables: dict[str, dict[str, Any]],
    given: str | Path | None,
    folder: Path | None,
    problems: list[Problem],
) -> None:
    """Make the law of a law file the law of the slider, in tables as they are parsed.

    If the file cannot be used, note it, and take out keys that may belong to its law; for the given
    file raise ParameterError.

    given : a law file that replaces the scenario's own, or None
    folder : the folder of the law files that the scenario names; None: they are not run
    """
    slider, sweep = tables.setdefault("slider", {}), tables.get("sweep", {})
    named = slider.pop("law_file", None)
    is_known = HASH_MARK in str(slider.get("law")) and find_law_name(slider["law"])
    if given is not None:
        name, file = register(given), str(given)
    elif named is None or is_known:  # no file need be run
        return
    else:
        place = Place(("slider", "law_file"), problems)
        file, name = named, place.attempt(lambda: _register(named, folder)) or ""
    if name:
        law, base_name = friction_law(name), name.partition(HASH_MARK)[0]
        for key, table in {"slider": slider, "sweep": sweep}.items():
            other = table.pop("law", name)
            text = str(other).lower()
            if text not in (name, base_name, *law.synonyms):
                is_edited = text.partition(HASH_MARK)[0] == base_name
                kind = "law_file.edited" if is_edited else "law_file.other"
                place = Place((key, "law"), problems)
                place.add(kind, given=other, file=file, name=name, own=base_name)
        slider["law"] = name
        return
    for name, table in {"slider": slider, "sweep": sweep}.items():
        for key in [key for key in table if key not in keys_of(name) and not tables_with(key)]:
            del table[key]
        table.pop("law", None)
    tables.get("run", {}).pop("initial", None)  # with the states of that law


def _register(named: Any, folder: Path | None) -> str:
    """Return the name of the law in the file that a scenario names; else raise ParameterError."""
    if not isinstance(named, str) or not named.isprintable() or len(named) > LONGEST_NAME:
        wanted = message("law_file.wanted", like=example("law_file"))
        raise refusal("law_file.no_name", given=named, wanted=wanted)
    if folder is None:
        raise refusal("law_file.of_text", given=named)
    return register(folder / named)
