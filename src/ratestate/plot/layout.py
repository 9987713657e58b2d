"""What all pictures have in common: type, captions, panel letters, how they become files."""

from itertools import repeat
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from ..dynamics.results import parameter
from ..files import replace
from ..model.units import is_array
from .labels import value_text

DPI = 300
#: parameters in a caption
SLIDER = "a b Dc sigma M K"
#: a legend above the right end of its axes
ABOVE = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.1}
#: ratio of smallest to largest value from which a logarithmic scale pays
WIDE = 10.0

#: decorator of the functions that draw
styled = rc_context(
    {
        "font.size": 8.0,
        "axes.linewidth": 0.7,
        "axes.formatter.useoffset": False,
        "legend.fontsize": 7.5,
        "legend.frameon": False,
        "pdf.fonttype": 42,  # text stays text for whoever edits the file
        "xtick.direction": "in",
        "ytick.direction": "in",
    }
)


def figure(data, height, symbols=SLIDER, more="", title=None):
    """An empty figure, 7.2 inches wide, under its title and a line of parameters, and more.

    symbols : of the parameters, which `data` must record; those that are swept are left out
    title : by default that of `data`
    """
    fig = Figure(figsize=(7.2, height), layout=ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.05))
    values = {symbol: parameter(data, symbol) for symbol in symbols.split()}
    listed = [value_text(symbol, x) for symbol, x in values.items() if not is_array(x)]
    second = ", ".join(listed) + more
    fig.suptitle(f"{title or data.attrs['title']}\n{second}", x=0.01, ha="left", fontsize=8)
    return fig


def is_wide(values):
    """Whether the finite ones of an array are all > 0, and the largest over `WIDE` times the least.

    Then a logarithmic scale pays; it does not where none is finite.
    """
    finite = values[np.isfinite(values)]
    return bool(finite.size and finite.min() > 0.0 and finite.max() > WIDE * finite.min())


def letters(axes, *texts, first="a"):
    """Mark panels with their letters in bold, and what each shows, above its upper left corner."""
    for i, (ax, text) in enumerate(zip(axes, texts or repeat(""), strict=False)):
        mark = chr(ord(first) + i)
        ax.set_title(rf"$\mathbf{{({mark})}}$ {text}", loc="left", fontsize=8, pad=4)


def save(fig, path):
    """Write a figure to a file, whole or not at all, with the same bytes each time.

    Parameters
    ----------
    fig : matplotlib.figure.Figure
        Figure to write.
    path : str or Path
        File, whose name ends in .png (300 dpi) or .pdf; one of that name is replaced.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    OSError
        It cannot be written there; what was there before is as it was.
    """
    path = Path(path)
    form = {"dpi": DPI} if path.suffix.lower() == ".png" else {"metadata": {"CreationDate": None}}
    return replace(path, lambda partial: fig.savefig(partial, **form))
