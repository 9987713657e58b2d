"""The explorer from Python: in a notebook, in a browser, or as one HTML file."""

import threading
import webbrowser
from html import escape
from pathlib import Path
from typing import Any

from ...errors import ParameterError
from ...model.slider import SpringSlider
from ...model.units import is_array, to_si
from .page_state.entries import DIGITS, BadEntries, entries_of, fragment_of, state_of
from .page_state.state import PageState
from .service.server import listen, server_at
from .sharing.address import address_of
from .sharing.standalone import save_page

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
    """The `_Server` of this process, begun if there is none."""
    global _running
    with _lock:
        if _running is None or not _running.thread.is_alive():  # it is not in a forked process
            _running = _Server()
        return _running


class Page:
    """A slider in the explorer, as `explore` gives it: shown where a notebook displays it.

    Parameters
    ----------
    slider : SpringSlider
        One slider.
    V_lp : float
        Load-point velocity [m/s].
    """

    def __init__(self, slider: SpringSlider, V_lp: float) -> None:
        self._state = PageState(slider, V_lp)

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


def explore(slider: SpringSlider, V_lp: Any) -> Page:
    """The explorer with a slider: in a notebook the page itself, with all parameters to be moved.

    A thread of this process serves it on 127.0.0.1, for the browser of this machine only, until
    `Page.close` or the end of the process.

    Parameters
    ----------
    slider : SpringSlider
        One slider: no arrays.
    V_lp : float or str
        Load-point velocity, > 0 [m/s].

    Returns
    -------
    Page
        With its address ``url``, and the methods ``open`` (in the browser), ``save`` (as one HTML
        file) and ``close``.

    Raises
    ------
    ParameterError
        No slider, arrays, or values that the page cannot show.

    Notes
    -----
    Where the notebook runs on another machine, as with JupyterHub or Colab, 127.0.0.1 is not the
    machine of the browser, and the frame stays empty.  Either forward the port of ``url`` by
    ``ssh -L 8765:127.0.0.1:8765 HOST``; or show the saved page, which needs no server::

        from html import escape
        from IPython.display import HTML

        text = escape(page.save("page.html").read_text())
        HTML(f'<iframe srcdoc="{text}" width="100%" height="860"></iframe>')

    Examples
    --------
    >>> slider = SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
    >>> page = explore(slider, "3.2 mm/s")
    >>> page.url.partition("#")[2][:15]
    'a=0.003&b=0.006'
    >>> page.close()
    """
    return Page(slider, _checked(slider, V_lp))


def _checked(slider, V_lp):
    """The speed [m/s]; ParameterError for what the page cannot show."""
    if not isinstance(slider, SpringSlider):
        raise ParameterError(f"explore wants a SpringSlider, and this is a {type(slider).__name__}")
    V_lp = to_si("V_lp", V_lp)
    arrays = [symbol for symbol, x in {**slider.values, "V_lp": V_lp}.items() if is_array(x)]
    if arrays:
        raise ParameterError(
            f"{', '.join(arrays)} {'is an array' if len(arrays) == 1 else 'are arrays'}, and the "
            f"explorer shows one slider; pick one value of each"
        )
    try:
        state_of(entries_of(PageState(slider, V_lp), DIGITS))
    except BadEntries as error:
        raise ParameterError(str(error)) from None
    return V_lp
