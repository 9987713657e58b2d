"""``ratestate explore``: the page in the browser."""

import os
from pathlib import Path

import typer

from ...errors import ParameterError
from .command import register_file
from .exits import INTERRUPTED


def explore(
    file: Path | None = None,
    *,
    law_file: Path | None = None,
    port: int | None = None,
    no_browser: bool = False,
) -> None:
    """Serve the explorer: sliders, live pictures and the map of regimes, in the browser.

    Nothing leaves this machine.  Ctrl-C ends it.

    Example: ratestate explore --port 8765
    """
    from ..explorer import serve

    fragment = ""
    if file is None:
        register_file(law_file)
    else:
        from ..explorer import fragment_of
        from .run_scenario import load_scenario, swept_dims

        scenario = load_scenario(file, "stability", law_file)
        if swept := swept_dims(scenario):
            raise ParameterError(
                f"[sweep]: the file has a sweep over {', '.join(swept)}, and the explorer shows "
                f"one slider; expected a file without [sweep], or run it: ratestate run {file}"
            )
        fragment = fragment_of(scenario.slider, scenario.settings["V_lp"])
    try:
        serve(port=port, open_browser=not no_browser, fragment=fragment)
    except KeyboardInterrupt:
        typer.echo("interrupted; the explorer has ended", err=True)
        os._exit(INTERRUPTED)  # at once, without waiting for threads that compute or compile
