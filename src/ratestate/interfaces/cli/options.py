"""Arguments and options that commands have in common."""

import enum
from pathlib import Path
from typing import Annotated

import typer


class Law(enum.StrEnum):
    """Evolution law."""

    slip = "slip"
    aging = "aging"


SCENARIO = typer.Argument(
    metavar="FILE.toml|-",
    help="Scenario file, or - for standard input; 'ratestate init' writes one.",
    show_default=False,
)
File = Annotated[Path, SCENARIO]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="FILE.nc|.csv|.zarr",
        help="Write all numbers there.",
        show_default=False,
    ),
]
Plot = Annotated[
    Path | None,
    typer.Option(
        "--plot",
        metavar="FILE.png|.pdf",
        help="Draw a picture.",
        show_default=False,
    ),
]
Json = Annotated[
    bool, typer.Option("--json", help="Print one JSON document with all numbers, in SI.")
]
