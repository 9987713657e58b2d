"""The explorer from Python: in a notebook, in a browser, or as one HTML file."""

import threading
import webbrowser
from html import escape
from pathlib import Path
from typing import Any

import xarray

import ratestate as rs

from .entries import DIGITS, BadEntries, address_of, entries_of, fragment_of, state_of
from .exports import save_page
from .server import listen, server_at
from .state import PageState

#: pages that may have the explorer in a frame: notebooks that this machine serves, or VS Code shows
NOTEBOOKS = " ".join(
    [f"{scheme}://{name}:*" for scheme in ("http", "https") for name in ("localhost", "127.0.0.1")]
    + ["vscode-webview:", "vscode-file:"]
)
#: pixels in a notebook
HEIGHT = 860
# Seconds for the server to begin, and to end.
PATIENCE = 20.0


class _Server:
    """The explorer in a thread of this process, for all its notebooks."""

    def __init__(self):
        self.listening = listen()
        self.port = self.listening.getsockname()[1]
        self.server = server_at(self.listening, frames=NOTEBOOKS)
        self.thread = threading.Thread(target=self._run, name="ratestate-explorer", daemon=True)
        self.thread.start()

    def _run(self):
        with self.listening:
            self.server.run(sockets=[self.listening])

    def end(self):
        self.server.should_exit = True
        self.thread.join(PATIENCE)


_running: _Server | None = None
_lock = threading.Lock()


def _server():
    """Return the `_Server` of this process; start it if there is none."""
    global _running
    with _lock:
        if _running is None or not _running.thread.is_alive():  # it is not in a forked process
            _running = _Server()
        return _running


class Page:
    """A slider in the explorer, which a notebook displays; see `ratestate.explore`."""

    def __init__(self, slider: rs.SpringSlider, V_lp: Any) -> None:
        self._state = PageState(slider, _checked(slider, V_lp))

    @property
    def url(self) -> str:
        """The address of the page, which this process serves from now on."""
        return address_of(_server().port, fragment_of(self._state.slider, self._state.V_lp))

    def __repr__(self) -> str:
        return f"ratestate explorer at {self.url}"

    def _repr_html_(self) -> str:
        url = escape(self.url)
        return (
            f'<iframe src="{url}" title="ratestate explorer" width="100%" height="{HEIGHT}" '
            f'allow="clipboard-write" frameborder="0"></iframe>'
            f'<p>Nothing above? <a href="{url}" target="_blank">Open it in the browser</a>.</p>'
        )

    def open(self) -> None:
        """Open the page in the browser."""
        webbrowser.open(self.url)

    def save(self, path: str | Path) -> Path:
        """Write the page, as it opens, into one HTML file that opens without Python or a server.

        It shows the motion, the phase plane and the map; parameters cannot be changed in it.

        Parameters
        ----------
        path : str or Path
            The file, whose name ends in .html; one of that name is replaced.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        ParameterError
            Another ending, or no such folder.
        SolverError
            It takes more than some minutes to compute what the page shows.
        OSError
            It cannot be written there; what was there before is as it was.
        """
        return save_page(path, entries_of(self._state, DIGITS))

    def close(self) -> None:
        """End the explorer of this process, for all its pages, until one is shown again."""
        global _running
        with _lock:
            if _running is not None:
                _running.end()
                _running = None


def _checked(slider, V_lp):
    """Return the speed [m/s]; ParameterError if the page cannot show it or the slider."""
    if not isinstance(slider, rs.SpringSlider):
        raise rs.ParameterError(
            f"slider is a {type(slider).__name__} and not a SpringSlider. Give a SpringSlider."
        )
    V_lp = rs.to_si("V_lp", V_lp)
    values = {**slider.values, "V_lp": V_lp}
    arrays = [symbol for symbol, x in values.items() if isinstance(x, xarray.DataArray)]
    if arrays:
        raise rs.ParameterError(
            f"{', '.join(arrays)} {'is an array' if len(arrays) == 1 else 'are arrays'}, and the "
            f"explorer shows one slider. Pick one value of each."
        )
    try:
        state_of(entries_of(PageState(slider, V_lp), DIGITS))
    except BadEntries as error:
        raise rs.ParameterError(str(error)) from None
    return V_lp
