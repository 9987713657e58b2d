"""What all pictures have in common: type, captions, panel letters, how they become files."""

from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from ..dynamics.results import parameter
from ..files import replace
from ..model.units import is_array
from .labels import value_text

DPI = 300

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


def figure(data, height, symbols, more=""):
    """An empty figure, 7.2 inches wide, under its title and a line of parameters, and more."""
    fig = Figure(figsize=(7.2, height), layout=ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.05))
    known = {symbol: parameter(data, symbol) for symbol in symbols.split()}
    listed = [value_text(symbol, x) for symbol, x in known.items() if not is_array(x)]
    second = ", ".join(listed) + more
    fig.suptitle(f"{data.attrs['title']}\n{second}", x=0.01, ha="left", fontsize=8)
    return fig


def letter(ax, letter, text=""):
    """Mark a panel with its letter in bold, and what it shows, above its upper left corner."""
    ax.set_title(rf"$\mathbf{{({letter})}}$ {text}", loc="left", fontsize=8, pad=4)


def save(fig, path):
    """Write a figure, by the ending of the name: .png (300 dpi) or .pdf, the same bytes each time.

    Whole or not at all; a file of that name is replaced.
    """
    path = Path(path)
    form = {"dpi": DPI} if path.suffix.lower() == ".png" else {"metadata": {"CreationDate": None}}
    return replace(path, lambda partial: fig.savefig(partial, **form))
