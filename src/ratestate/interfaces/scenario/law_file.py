"""The law file of a scenario: Python of its user's, which is run to know the friction law in it."""

from pathlib import Path
from typing import Any

from ...friction.laws import friction_law, known_law
from ...friction.user_law import MARK
from ...model.user_laws import register
from .known_keys import example, keys_of, tables_with
from .problems import Place, message, refusal

KEY = "law_file"
LONGEST_NAME = 1000  # characters


def take_law_file(
    tables: dict[str, dict[str, Any]],
    given: str | Path | None,
    folder: Path | None,
    problems: list[str],
) -> bool:
    """Make the law of a law file the law of the slider, in tables as they are parsed.

    False where it cannot be known, which is noted: then keys that may be the law's own are taken
    out.  ParameterError for a given file that cannot be used.

    given : a law file in place of the scenario's own, or None
    folder : where law files lie that the scenario names; None: those are not run
    """
    slider = tables.setdefault("slider", {})
    named = slider.pop(KEY, None)
    if given is not None:
        _settle(tables, register(given), str(given), problems)
        return True
    if named is None or _names_known_source(slider.get("law")):
        return True
    place, wanted = Place(f"[slider] {KEY}", problems), message("law_file.wanted")
    name = place.noting(lambda: _registered(named, folder), wanted=wanted, like=example(KEY))
    if name is None:
        _take_out_unknown(tables)
        return False
    _settle(tables, name, named, problems)
    return True


def _registered(named: Any, folder: Path | None) -> str:
    """The name of the law in the file that a scenario names; ParameterError if it has none."""
    if not isinstance(named, str) or not named.isprintable() or len(named) > LONGEST_NAME:
        raise refusal("law_file.no_name", given=named)
    if folder is None:
        raise refusal("law_file.of_text", given=named)
    return register(folder / named)


def _names_known_source(law: Any) -> bool:
    """Whether a law is named with the hash of its source, and known: no file need be run."""
    return MARK in (known_law(law) or "") and MARK in law


def _settle(tables: dict[str, dict[str, Any]], name: str, file: str, problems: list[str]) -> None:
    """Make the law of this name that of the slider; a key law that names another one is noted."""
    law, own = friction_law(name), name.partition(MARK)[0]
    for table in ("slider", "sweep"):
        given = tables.get(table, {}).pop("law", None)
        if given is None or (
            isinstance(given, str) and given.lower() in (name, own, *law.synonyms)
        ):
            continue
        edited = isinstance(given, str) and given.lower().partition(MARK)[0] == own
        kind = "law_file.edited" if edited else "law_file.other"
        Place(f"[{table}] law", problems).add(kind, given=given, file=file, name=name, own=own)
    tables["slider"]["law"] = name


def _take_out_unknown(tables: dict[str, dict[str, Any]]) -> None:
    """Take out the law, and keys that may be its parameters: those of no table."""
    for name in ("slider", "sweep"):
        table, known = tables.get(name, {}), keys_of(name)
        for key in [key for key in table if key not in known and not tables_with(key)]:
            del table[key]
        table.pop("law", None)
