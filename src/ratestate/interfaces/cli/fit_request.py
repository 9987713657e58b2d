"""The options of ``ratestate fit``, as arguments of `read_lab` and `fit`."""

from pathlib import Path
from typing import Any, NamedTuple

import typer

from .options import Law


class FitRequest(NamedTuple):
    """A fit requested on the command line."""

    file: Path
    named: dict[str, Any]  # of read_lab
    window: dict[str, Any]  # of read_lab
    values: dict[str, str | None]  # of the slider, as they were given
    free: tuple[str, ...]
    laws: tuple[str, ...]
    settings: dict[str, Any]  # of fit
    noise: str | None

    @property
    def reading(self) -> dict[str, Any]:
        """Arguments of `read_lab` beside the file."""
        return {k: v for k, v in (self.named | self.window).items() if v}

    @property
    def fitting(self) -> dict[str, Any]:
        """Arguments of `fit` beside record and slider."""
        law = self.laws[0] if len(self.laws) == 1 else self.laws
        return {"free": self.free, "law": law, **self.settings, "noise": _noise(self.noise)}


def laws(texts: list[str] | None, option: str) -> tuple[str, ...]:
    """The laws, each once, from strings with one or several laws separated by commas."""
    names = [name.strip() for text in texts or ["slip"] for name in text.split(",")]
    for name in names:
        if name not in [*Law]:
            raise typer.BadParameter(
                f"{name!r} is no law; choose slip, aging or slip,aging", param_hint=option
            )
    return tuple(dict.fromkeys(names))


def pair(text: str | None, option: str) -> tuple[str | None, str | None] | None:
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


def pairs(texts: list[str] | None, option: str) -> dict[str, str]:
    """Strings of the form NAME=TEXT as a dict."""
    named: dict[str, str] = {}
    for text in texts or []:
        name, sign, value = (part.strip() for part in text.partition("="))
        if not (name and sign and value):
            raise typer.BadParameter(f"{text!r} has no NAME=...", param_hint=option)
        named[name] = value
    return named


def numbered(columns: dict[str, str]) -> dict[str, Any]:
    """Columns, with those given by number converted to int."""
    return {name: int(text) if text.isdigit() else text for name, text in columns.items()}


def _noise(text: str | None) -> Any:
    """The noise as `fit` takes it."""
    if text is None or "=" not in text:
        return text
    parts = (part.partition("=") for part in text.split(","))
    return {name.strip(): value.strip() for name, _, value in parts}
