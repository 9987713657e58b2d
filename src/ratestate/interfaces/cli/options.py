"""Arguments and options that commands have in common."""

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

Law = Literal["slip", "aging"]


def option(metavar: str, what: str, default: str | bool = True, *names: str) -> Any:
    """An option with a value; `default` says what holds without it, if words do."""
    return typer.Option(*names, metavar=metavar, help=what, show_default=default)


SCENARIO = typer.Argument(
    metavar="FILE.toml|-",
    help="Scenario file, or - for standard input; 'ratestate init' writes one.",
)
File = Annotated[Path, SCENARIO]
Out = Annotated[Path | None, option("FILE.nc|.csv|.zarr", "Write all numbers there.")]
Plot = Annotated[Path | None, option("FILE.png|.pdf", "Draw a picture.")]
Folder = Annotated[Path, typer.Option(help="Folder for the files; made if missing.")]
Json = Annotated[
    bool, typer.Option("--json", help="Print one JSON document with all numbers, in SI.")
]
