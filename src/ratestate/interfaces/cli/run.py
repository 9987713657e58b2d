"""``ratestate run``: whatever a scenario file asks for, or once more what a result came from."""

from pathlib import Path
from typing import Annotated

import typer

from .options import SCENARIO, Json, Out, Plot


def run(
    file: Annotated[Path | None, SCENARIO] = None,
    source: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="RESULT.nc|.zarr",
            help="Do again, to the same bits, what this result came from.",
            show_default=False,
        ),
    ] = None,
    out: Out = None,
    plot: Plot = None,
    json: Json = False,
) -> None:
    """Run a scenario file: its loading, or its sweep in memory.

    Without --out and --plot, files are those that the table output of the file names.

    Example: ratestate run lab.toml --plot lab.png
    """
    from .job import do, scenario_of

    if (file is None) == (source is None):
        raise typer.BadParameter("give either a file or --from RESULT", param_hint="FILE.toml")
    if source is not None:
        from ...files import read
        from ..scenario import from_result

        asked = from_result(read(source))
    elif file is not None:
        asked = scenario_of(file)
    do(asked, out, plot, json)
