"""``ratestate run``: runs a scenario file, or the scenario that made a result."""

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
            help="Compute this result again, bit-for-bit the same.",
            show_default=False,
        ),
    ] = None,
    out: Out = None,
    plot: Plot = None,
    json: Json = False,
) -> None:
    """Run a scenario file: its loading, or its sweep in memory.

    Without --out and --plot, files are written as the table [output] of the file says.

    Example: ratestate run lab.toml --plot lab.png
    """
    from .run_scenario import do, load_scenario

    if (file is None) == (source is None):
        raise typer.BadParameter("give either a file or --from RESULT", param_hint="FILE.toml")
    if source is not None:
        from ...files import read
        from ..scenario import from_result

        scenario = from_result(read(source))
    elif file is not None:
        scenario = load_scenario(file)
    do(scenario, out, plot, json)
