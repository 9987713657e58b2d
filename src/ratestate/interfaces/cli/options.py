"""Groups of options that several commands share, and readers of options such as NAME=VALUE.

A command has the options of a group by a parameter whose type is the group.
"""

import itertools
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import typer

from ...errors import ParameterError
from ...friction.laws import law_name

Join = Literal["auto", "absolute", "restart"]


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """Options on the law of a scenario, and on where and how its result goes."""

    law_file: Path | None = None
    out: Path | None = None
    plot: Path | None = None
    units: list[str] | None = None
    json: bool = False


@dataclass(frozen=True, kw_only=True)
class FileReading:
    """Options on how one file of a record is read."""

    time: str | None = None
    displacement: str | None = None
    columns: list[str] | None = None
    column_units: list[str] | None = None
    lab_format: Path | None = None

    def keywords(self) -> dict[str, Any]:
        """Return keywords of `read_lab` for the options that are given."""
        columns = pairs_of(self.columns, "--columns")
        reading = {
            "columns": {k: int(v) if v.isdigit() else v for k, v in columns.items()},
            "units": pairs_of(self.column_units, "--units", separator=","),
            "time": _window(self.time, "--time"),
            "displacement": _window(self.displacement, "--displacement"),
            "lab_format": self.lab_format and self.lab_format.as_posix(),
        }
        return {name: value for name, value in reading.items() if value not in (None, {})}


@dataclass(frozen=True, kw_only=True)
class Reading(FileReading):
    """Options on how a record is read, which may be in several files."""

    max_rows: int | None = None
    join: Join = "auto"

    def keywords(self) -> dict[str, Any]:
        options = {"max_rows": self.max_rows, "join": None if self.join == "auto" else self.join}
        given = {name: value for name, value in options.items() if value is not None}
        return super().keywords() | given


def read_record(paths: Any, keywords: dict[str, Any], sigma: str | None) -> Any:
    """Return the record of one or more files, and the keywords with which `read_lab` read it.

    sigma : normal stress, for files without a column of it
    """
    from ...records.reading import read_lab

    try:
        return read_lab(paths, **keywords), keywords
    except ParameterError as error:
        # (of several files some may have the column)
        several = isinstance(paths, list) and len(paths) > 1
        if sigma is None or several or error.sentence != "columns.no_sigma":
            raise
    keywords = keywords | {"sigma": sigma}
    return read_lab(paths, **keywords), keywords


def noise_of(text: str | None) -> Any:
    """Return the noise as `ratestate.fit` takes it."""
    if text is None or "=" not in text:
        return text
    parts = (part.partition("=") for part in text.split(","))
    return {name.strip(): value.strip() for name, _, value in parts}


def _window(text: str | None, option: str) -> tuple[str | None, str | None] | None:
    """Return START,END as two values, either of which may be omitted."""
    if text is None:
        return None
    ends = [end.strip() or None for end in text.split(",")]
    if len(ends) != 2 or ends == [None, None]:
        raise typer.BadParameter(
            f"{text!r} is not START,END, such as '11640 s,11720 s' or '11640 s,'",
            param_hint=option,
        )
    return ends[0], ends[1]


def pairs_of(texts: list[str] | None, option: str, separator: str = "") -> dict[str, str]:
    """Return strings such as NAME=TEXT as a dict; a separator allows several in one string."""
    named: dict[str, str] = {}
    split = [text.split(separator) if separator else [text] for text in texts or []]
    for text in itertools.chain(*split):
        name, sign, value = (part.strip() for part in text.partition("="))
        if not (name and sign and value):
            raise typer.BadParameter(f"{text!r} has no NAME=...", param_hint=option)
        named[name] = value
    return named


def own_values(texts: list[str] | None, symbols: Iterable[str]) -> dict[str, str]:
    """Return the options --set as a dict; raise `typer.BadParameter` for an unknown symbol."""
    values, known = pairs_of(texts, "--set"), [*symbols]
    if unknown := [name for name in values if name not in known]:
        wanted = f"expected {' or '.join(known)}" if known else "it has none"
        raise typer.BadParameter(
            f"{unknown[0]!r} is not a parameter of the law's own: {wanted}", param_hint="--set"
        )
    return values


def laws_of(
    texts: Iterable[str], law_file: Path | None, defaults: Iterable[str]
) -> tuple[str, ...]:
    """Return the names of the friction laws in the options --law and --law-file, each once.

    Raises `typer.BadParameter` for an unknown law, and if --law lacks the law of the file.
    """
    of_file = register_file(law_file)
    names = tuple(dict.fromkeys(map(_law_of, texts)))
    if of_file and names and of_file not in names:
        raise typer.BadParameter(
            f"{', '.join(map(repr, names))}: the law of {law_file} is {of_file!r}. Add it to "
            f"--law, or leave --law out",
            param_hint="'--law'",
        )
    return names or ((of_file,) if of_file else tuple(defaults))


def register_file(law_file: Path | None) -> str:
    """Register the law of the option --law-file, and return its name; "" without a file."""
    if law_file is None:
        return ""
    from ...model.user_laws import register

    return register(law_file)


def _law_of(text: str) -> str:
    """Return the name of a friction law; raise `typer.BadParameter` if it is unknown."""
    try:
        return law_name(text)
    except ParameterError as error:
        raise typer.BadParameter(str(error), param_hint="'--law'") from None
