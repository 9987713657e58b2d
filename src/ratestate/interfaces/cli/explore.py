"""``ratestate explore``: the page in the browser."""

import os
from pathlib import Path
from typing import Annotated

import typer

from .ends import INTERRUPTED


def explore(
    file: Annotated[
        Path | None,
        typer.Argument(
            metavar="FILE.toml|-",
            help="Scenario file whose slider it opens with, at the last speed of its loading.",
            show_default=False,
        ),
    ] = None,
    port: Annotated[
        int | None,
        typer.Option(
            help="Port of 127.0.0.1.", min=0, max=65535, show_default="8765, or any that is free"
        ),
    ] = None,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Only serve; open the address yourself.")
    ] = False,
) -> None:
    """Serve the explorer: sliders, live pictures and the map of regimes, in the browser.

    Nothing leaves this machine.  Ctrl-C ends it.

    Example: ratestate explore --port 8765
    """
    from ..explorer import serve

    fragment = _fragment(file) if file else ""
    try:
        serve(port=port, open_browser=not no_browser, fragment=fragment)
    except KeyboardInterrupt:
        typer.echo("interrupted; the explorer has ended", err=True)
        os._exit(INTERRUPTED)  # at once: nobody waits for what its threads compute or compile


def _fragment(file: Path) -> str:
    """What the page's address says of the slider in a file."""
    from ...errors import ParameterError
    from ..explorer import fragment_of
    from .job import axes, scenario_of

    asked = scenario_of(file, "stability")
    if swept := axes(asked):
        raise ParameterError(
            f"[sweep]: the file has a sweep over {', '.join(map(str, swept))}, and the explorer "
            f"shows one slider; expected a file without [sweep], or run it: ratestate run {file}"
        )
    return fragment_of(asked.slider, asked.settings["V_lp"])
