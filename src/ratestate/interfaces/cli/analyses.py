"""``ratestate stability``, ``cycle`` and ``branch``: one analysis of a scenario file's slider."""

import dataclasses
from pathlib import Path
from typing import Annotated, Any

import typer

from .options import File, Json, Out, Plot


def stability(file: File, out: Out = None, plot: Plot = None, json: Json = False) -> None:
    """Find whether steady sliding is stable at the load point's last speed.

    Example: ratestate stability lab.toml
    """
    _do(file, "stability", out, plot, json)


def cycle(file: File, out: Out = None, plot: Plot = None, json: Json = False) -> None:
    """Find the limit cycle that the slider reaches at the load point's last speed.

    Example: ratestate cycle brake.toml --plot cycle.png
    """
    _do(file, "limit_cycle", out, plot, json)


def branch(
    file: File,
    parameter: Annotated[
        str | None,
        typer.Option(
            metavar="SYMBOL",
            help="What changes: V_lp, K, M, sigma, a, b or Dc.",
            show_default="V_lp, or as [sweep] says",
        ),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            metavar="VALUE", help="Its first value, with a unit.", show_default="as [sweep] says"
        ),
    ] = None,
    stop: Annotated[
        str | None,
        typer.Option(
            metavar="VALUE", help="Its last value, with a unit.", show_default="as [sweep] says"
        ),
    ] = None,
    out: Out = None,
    plot: Plot = None,
    json: Json = False,
) -> None:
    """Follow limit cycles, stable and unstable, while a parameter changes.

    Example: ratestate branch brake.toml --start "50 mm/s" --stop "3 cm/s"
    """
    if start is None and stop is None and parameter is None:
        _do(file, "continue_cycle", out, plot, json)
        return
    if start is None or stop is None:
        raise typer.BadParameter("both are needed", param_hint="--start and --stop")
    changes = {"parameter": parameter or "V_lp", "start": start, "stop": stop}
    _do(file, "limit_cycle", out, plot, json, **changes)


def _do(
    file: Path, verb: str, out: Path | None, plot: Path | None, json: bool, **changes: Any
) -> None:
    """Call a function with the scenario of a file, whose own verb and [output] are ignored.

    changes : settings that turn a limit cycle into a branch
    """
    from ..scenario import Output
    from .run_scenario import do, load_scenario

    scenario = dataclasses.replace(load_scenario(file, verb), output=Output())
    if changes:
        settings = scenario.settings | changes
        if changes["parameter"] == "V_lp":
            settings.pop("V_lp")
        scenario = dataclasses.replace(scenario, verb="continue_cycle", settings=settings)
    do(scenario, out, plot, json)
