"""The function `explore`: open the explorer, a separate package that needs the extra `explorer`."""

from importlib import import_module
from importlib.util import find_spec

from ..errors import ParameterError

#: modules that the extra brings
NEEDED = ("fastapi", "uvicorn", "websockets")


def explorer_package():
    """Return the package `ratestate_explorer`; ParameterError if its extra is not installed."""
    if missing := [name for name in NEEDED if find_spec(name) is None]:
        raise ParameterError(
            f"The explorer needs {' and '.join(missing)}. "
            f"Install the extra: pip install 'ratestate[explorer]'."
        )
    return import_module("ratestate_explorer")


def explore(slider, V_lp):
    """Open the interactive explorer for a slider, in the browser or in a notebook.

    A thread of this process serves all pages on 127.0.0.1, which only this machine can reach.

    Parameters
    ----------
    slider : SpringSlider
        One slider: no arrays.
    V_lp : float, str or pint.Quantity
        Load-point velocity, > 0 [m/s].

    Returns
    -------
    Page
        A notebook displays the page.  ``url`` is its address, ``open()`` shows it in the browser,
        and ``save(path)`` writes it as one HTML file.  ``close()`` ends the thread, until the url
        of a page is read again.

    Raises
    ------
    ParameterError
        If slider is not a single slider, if the page cannot show its values, or if the extra
        "explorer" is not installed.

    Notes
    -----
    If the notebook runs on another machine, as with JupyterHub or Colab, 127.0.0.1 is not the
    machine of the browser, and the frame stays empty.  Either forward the port of ``url`` with
    ``ssh -L 8765:127.0.0.1:8765 HOST``, or show the saved page, which needs no server::

        from html import escape
        from IPython.display import HTML

        text = escape(page.save("page.html").read_text())
        HTML(f'<iframe srcdoc="{text}" width="100%" height="860"></iframe>')

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
    >>> page = explore(slider, "3.2 mm/s")
    >>> page.url.partition("#")[2][:15]
    'a=0.003&b=0.006'
    >>> page.close()
    """
    return explorer_package().Page(slider, V_lp)
