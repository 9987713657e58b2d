"""``ratestate explore``: the page in the browser."""

from typing import Annotated

import typer


def explore(
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

    serve(port=port, open_browser=not no_browser)
