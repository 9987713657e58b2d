"""The options that say how a record is read, as `read_lab` takes them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import typer

from .command import pairs_of

Join = Literal["auto", "absolute", "restart"]


@dataclass(frozen=True, kw_only=True)
class FileReading:
    """The options on one file."""

    time: str | None = None
    displacement: str | None = None
    columns: list[str] | None = None
    column_units: list[str] | None = None
    format_: Path | None = None

    def keywords(self) -> dict[str, Any]:
        """Keywords of `read_lab` for those options that are given."""
        columns = pairs_of(self.columns, "--columns")
        reading = {
            "columns": {k: int(v) if v.isdigit() else v for k, v in columns.items()},
            "units": pairs_of(self.column_units, "--units", separator=","),
            "time": _window(self.time, "--time"),
            "displacement": _window(self.displacement, "--displacement"),
            "format": self.format_ and self.format_.as_posix(),
        }
        return {name: value for name, value in reading.items() if value not in (None, {})}


@dataclass(frozen=True, kw_only=True)
class Reading(FileReading):
    """The options on a record, which may be in several files."""

    rows: int | None = None
    join: Join = "auto"

    def keywords(self) -> dict[str, Any]:
        """Keywords of `read_lab` for those options that are given."""
        own = {"rows": self.rows, "join": None if self.join == "auto" else self.join}
        given = {name: value for name, value in own.items() if value is not None}
        return super().keywords() | given


def noise_of(text: str | None) -> Any:
    """The noise as `ratestate.fit` takes it."""
    if text is None or "=" not in text:
        return text
    parts = (part.partition("=") for part in text.split(","))
    return {name.strip(): value.strip() for name, _, value in parts}


def _window(text: str | None, option: str) -> tuple[str | None, str | None] | None:
    """START,END as two values, either of which may be omitted."""
    if text is None:
        return None
    ends = [end.strip() or None for end in text.split(",")]
    if len(ends) != 2 or ends == [None, None]:
        raise typer.BadParameter(
            f"{text!r} is not START,END, such as '11640 s,11720 s' or '11640 s,'",
            param_hint=option,
        )
    return ends[0], ends[1]
