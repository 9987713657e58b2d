"""``ratestate init``: a scenario file to start from."""

import os
from pathlib import Path
from typing import Literal

import typer

from ...errors import ParameterError
from .output import print_line

Kind = Literal["lab", "brake", "fault"]


def init(kind: Kind = "lab", *, out: Path | None = None) -> None:
    """Write a commented scenario file to start from.

    Example: ratestate init brake
    """
    from ...files import checked_path, replace
    from ..scenario import template

    text = template(kind)
    path = out or Path(f"{kind}.toml")
    if path == Path("-"):
        print_line(text.rstrip("\n"))
        return
    if path.suffix.lower() != ".toml":
        raise typer.BadParameter(f"{str(path)!r} does not end in .toml", param_hint="--out")
    if os.path.lexists(path):
        raise ParameterError(f"{path} exists; give another name with --out")
    replace(checked_path(path, (".toml",)), lambda partial: partial.write_text(text, "utf-8"))
    print_line(
        f"{path} is written: open it, read it, change it.  Then\n"
        f"  ratestate run {path} --plot {path.stem}.png    what happens\n"
        f"  ratestate stability {path}    whether steady sliding is stable\n"
        f"  ratestate cycle {path}    the limit cycle that it reaches"
    )
