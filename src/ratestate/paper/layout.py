"""What all figures of the paper have in common: type, captions, panel letters, provenance."""

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from .. import plot

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

LAWS = {"slip": "slip (Ruina) law", "aging": "aging (Dieterich) law"}


def titled(data, title, law=None):
    """The Dataset of a figure with its title and source added to the provenance it carries."""
    text = f"{title}; {LAWS[law] if law else 'both evolution laws'}"
    source = "Im, Marone & Elsworth (2019), doi:10.1016/j.jmps.2018.08.026"
    return data.assign_attrs(title=text, references=source)


def figure(data, height, symbols, more=""):
    """An empty figure, 7.2 inches wide, under its title and a line of parameters, and more."""
    fig = Figure(figsize=(7.2, height), layout=ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.05))
    known = [plot.value_text(symbol, plot.parameter(data, symbol)) for symbol in symbols.split()]
    second = ", ".join(known) + more
    fig.suptitle(f"{data.attrs['title']}\n{second}", x=0.01, ha="left", fontsize=8)
    return fig


def letter(ax, letter, text=""):
    """Mark a panel with its letter in bold, and what it shows, above its upper left corner."""
    ax.set_title(rf"$\mathbf{{({letter})}}$ {text}", loc="left", fontsize=8, pad=4)


def steepest(run):
    """The run with time counted from where, in its middle half, tau falls fastest."""
    first, last = (float(run.time[i]) for i in (0, -1))
    margin = (last - first) / 4
    rate = run.tau.differentiate("time").sel(time=slice(first + margin, last - margin))
    return run.assign_coords(time=run.time - rate.time[int(np.argmin(rate.values))])
