"""``ratestate explore``: the page in the browser."""

import os
from pathlib import Path

import typer

from ...errors import ParameterError
from ..explorer import explorer_package
from .command import register_file
from .exits import INTERRUPTED
from .output import print_line


def explore(
    file: Path | None = None,
    *,
    law_file: Path | None = None,
    port: int | None = None,
    no_browser: bool = False,
    save: Path | None = None,
) -> None:
    """Serve the explorer: sliders, live pictures and the map of regimes, in the browser.

    Nothing leaves this machine.  Ctrl-C ends it.  With --save it is written to one HTML file
    instead, which opens without a server.

    Example: ratestate explore --port 8765
    """
    explorer = explorer_package()
    if file is None:
        register_file(law_file)
        opened = None
    else:
        opened = _opened(file, law_file)
    if save is not None:
        if port is not None or no_browser:
            given = "--port" if port is not None else "--no-browser"
            raise ParameterError(
                f"{given} is for serving the page, and --save writes it to a file instead",
                "Leave out one of them.",
            )
        print_line(f"wrote {_saved(explorer, save, opened)}", err=True)
        return
    try:
        fragment = explorer.fragment_of(*opened) if opened else ""
        explorer.serve(port=port, open_browser=not no_browser, fragment=fragment)
    except KeyboardInterrupt:
        typer.echo("interrupted; the explorer has ended", err=True)
        os._exit(INTERRUPTED)  # at once, without waiting for threads that compute or compile


def _opened(file, law_file):
    """The slider and the speed of a scenario file."""
    from .run_scenario import load_scenario, swept_dims

    scenario = load_scenario(file, "stability", law_file)
    if swept := swept_dims(scenario):
        raise ParameterError(
            (
                f"[sweep]: the file has a sweep over {', '.join(swept)}, but the explorer "
                "shows one slider"
            ),
            f"Give a file without [sweep], or run it with ratestate run {file}.",
        )
    return scenario.slider, scenario.settings["V_lp"]


def _saved(explorer, path, opened):
    """Save the page with a slider, or as it opens without one; return the file's Path."""
    if opened:
        return explorer.Page(*opened).save(path)
    return explorer.save_page(path, explorer.presets()[0]["entries"])
