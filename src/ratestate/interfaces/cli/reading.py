"""The options that say how a record is read, as `read_lab` takes them."""

from pathlib import Path
from typing import Any, Literal

import typer

from .command import pairs_of

Join = Literal["auto", "absolute", "restart"]


def reading_options(
    columns: list[str] | None,
    column_units: list[str] | None,
    time: str | None,
    displacement: str | None,
    format_: Path | None,
    rows: int | None = None,
    join: Join = "auto",
) -> dict[str, Any]:
    """Keywords of `read_lab` for those options that are given."""
    numbered = {k: int(v) if v.isdigit() else v for k, v in pairs_of(columns, "--columns").items()}
    reading = {
        "columns": numbered,
        "units": pairs_of(column_units, "--units", separator=","),
        "time": _window(time, "--time"),
        "displacement": _window(displacement, "--displacement"),
        "rows": rows,
        "join": None if join == "auto" else join,
        "format": format_ and format_.as_posix(),
    }
    return {name: value for name, value in reading.items() if value not in (None, {})}


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
