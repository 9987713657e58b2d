"""The law file of a scenario: Python of its user's, which is run to know the friction law in it."""

from pathlib import Path
from typing import Any

from ...friction.law_formula import HASH_MARK
from ...friction.laws import find_law_name, friction_law
from ...model.user_laws import register
from .known_keys import example, keys_of, tables_with
from .problems import Place, Problem, message, refusal

KEY = "law_file"
LONGEST_NAME = 1000  # characters


def take_law_file(
    tables: dict[str, dict[str, Any]],
    given: str | Path | None,
    folder: Path | None,
    problems: list[Problem],
) -> None:
    """Make the law of a law file the law of the slider, in tables as they are parsed.

    A file that cannot be used is noted, and keys that may be of its law are taken out; if it is the
    given one, it is a ParameterError.

    given : a law file in place of the scenario's own, or None
    folder : where law files lie that the scenario names; None: those are not run
    """
    slider = tables.setdefault("slider", {})
    named = slider.pop(KEY, None)
    if given is not None:
        _settle(tables, register(given), str(given), problems)
    elif named is not None and not _names_known_source(slider.get("law")):
        place = Place(("slider", KEY), problems)
        name = place.noting(lambda: _registered(named, folder))
        if name is None:
            _take_out_unknown(tables)
        else:
            _settle(tables, name, named, problems)


def _registered(named: Any, folder: Path | None) -> str:
    """The name of the law in the file that a scenario names; ParameterError if it has none."""
    if not isinstance(named, str) or not named.isprintable() or len(named) > LONGEST_NAME:
        wanted = message("law_file.wanted", like=example(KEY))
        raise refusal("law_file.no_name", given=named, wanted=wanted)
    if folder is None:
        raise refusal("law_file.of_text", given=named)
    return register(folder / named)


def _names_known_source(law: Any) -> bool:
    """Whether a law is named with the hash of its source, and known: no file need be run."""
    return HASH_MARK in (find_law_name(law) or "") and HASH_MARK in law


def _settle(
    tables: dict[str, dict[str, Any]], name: str, file: str, problems: list[Problem]
) -> None:
    """Make the law of this name that of the slider; a key law that names another one is noted."""
    law, own = friction_law(name), name.partition(HASH_MARK)[0]
    for table in ("slider", "sweep"):
        given = tables.get(table, {}).pop("law", name)
        text = str(given).lower()
        if text not in (name, own, *law.synonyms):
            is_edited = text.partition(HASH_MARK)[0] == own
            kind = "law_file.edited" if is_edited else "law_file.other"
            Place((table, "law"), problems).add(kind, given=given, file=file, name=name, own=own)
    tables["slider"]["law"] = name


def _take_out_unknown(tables: dict[str, dict[str, Any]]) -> None:
    """Take out the law, and what may be of it: keys of no table, and the states at t = 0."""
    for name in ("slider", "sweep"):
        table, known = tables.get(name, {}), keys_of(name)
        for key in [key for key in table if key not in known and not tables_with(key)]:
            del table[key]
        table.pop("law", None)
    tables.get("run", {}).pop("initial", None)
