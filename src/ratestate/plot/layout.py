"""The common style of all figures: type, captions, axes, panel letters, how they are saved."""

from bisect import bisect_right
from itertools import repeat
from typing import Any

import numpy as np
from matplotlib import cbook, colormaps, rc_context
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.textpath import text_to_path
from matplotlib.ticker import (
    FormatStrFormatter,
    LogLocator,
    NullFormatter,
    NullLocator,
    ScalarFormatter,
)

from ..dynamics.results import contact_area, parameter, slider_parameters
from ..files import checked_path, replace
from ..files.place import PICTURES
from ..model.slider_parameters import PARAMETERS
from ..model.units import is_array
from .labels import value_text

DPI = 300
#: parameters in a caption
SLIDER = "a b Dc sigma M K"
#: a legend above the right end of its axes
ABOVE = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.1}
ABOVE |= {"fontsize": 7.5, "frameon": False}
#: ratio of smallest to largest value from which a logarithmic scale pays
WIDE = 10.0
#: decades up to which a logarithmic axis has 1, 2, 5, 10 ... as its ticks, in plain numbers
FEW_DECADES = 2.5
#: ticks in a decade, the most first
TICKS = ((1.0, 2.0, 5.0), (1.0, 3.0), (1.0,))
#: change over size up to which data are constant, but for rounding; the range then shown on
#: either side, over size
CONSTANT, AROUND = 1e-6, 0.05

#: what a legend says of cases whose motion leaves the domain of the friction law
OUTSIDE = "outside the friction law's domain"

STYLE: Any = {
    "font.size": 8.0,
    "axes.linewidth": 0.7,
    "axes.formatter.useoffset": False,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "pdf.fonttype": 42,  # text stays text for whoever edits the file
    "xtick.direction": "in",
    "ytick.direction": "in",
}
#: decorator of the functions that draw; it sets what all threads share: see `apply_style`
styled = rc_context(STYLE)


def apply_style(fig):
    """Give a figure the `STYLE`, after it is drawn: for threads beside which others draw too."""
    for ax in fig.axes:
        ax.tick_params(which="both", direction="in", labelsize=STYLE["font.size"])
        for spine in ax.spines.values():
            spine.set_linewidth(STYLE["axes.linewidth"])
        for axis in (ax.xaxis, ax.yaxis):
            axis.label.set_size(STYLE["font.size"])
            axis.offsetText.set_size(STYLE["font.size"])
            if isinstance(axis.get_major_formatter(), ScalarFormatter):
                axis.get_major_formatter().set_useOffset(STYLE["axes.formatter.useoffset"])


def figure(data, height, symbols=None, more="", title=None):
    """An empty figure, 7.2 inches wide, under its title and a line of parameters, and more.

    symbols : of the parameters, which `data` must record; those that are swept are left out; by
        default the slider's, b2 or damping too
    title : by default the title of `data`
    """
    if symbols is None:
        no_numbers = (*PARAMETERS, "law", "friction_form", "area")
        symbols = " ".join([SLIDER, *(s for s in slider_parameters(data) if s not in no_numbers)])
    values = {symbol: parameter(data, symbol) for symbol in symbols.split()}
    area = contact_area(data) if values else None  # results of records have no slider
    listed = [value_text(symbol, x, area=area) for symbol, x in values.items() if not is_array(x)]
    second = ", ".join(listed) + more
    return blank_figure(height, f"{title or data.attrs['title']}\n{second}")


def blank_figure(height, title):
    """An empty figure, 7.2 inches wide, under this title."""
    fig = Figure(figsize=(7.2, height), layout=ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.05))
    fig.suptitle(title, x=0.01, ha="left", fontsize=8)
    return fig


def untitled(fig):
    """Return a figure without its title and line of parameters."""
    fig.suptitle("").set_in_layout(False)
    return fig


def is_wide(values):
    """Whether the finite ones of an array are all > 0, and the largest over `WIDE` times the least.

    Then a logarithmic scale pays; it does not where none is finite.
    """
    finite = values[np.isfinite(values)]
    return bool(finite.size and finite.min() > 0.0 and finite.max() > WIDE * finite.min())


def show_constant(ax):
    """Give data that are constant, to `CONSTANT`, a range whose ticks are short numbers.

    On linear axes; what is drawn later may widen it.
    """
    ends = ax.dataLim.get_points()  # (2, 2): least and largest x and y
    for i, scale in enumerate((ax.get_xscale(), ax.get_yscale())):
        low, high = ends[:, i]
        size = max(abs(low), abs(high))
        if scale == "linear" and high - low <= CONSTANT * size < np.inf:
            enlarged = ends.copy()
            enlarged[:, i] = low - AROUND * size, high + AROUND * size
            ax.update_datalim(enlarged)
    ax.autoscale_view()


def mark_outside(ax, x, y, outside):
    """Underlay points whose motion leaves the domain of the friction law; the list of lines drawn.

    Empty if there are none.  x, y, outside : arrays of one shape
    """
    look = {"color": "#f4a6a6", "ms": 7, "mew": 0, "ls": "", "zorder": 1, "label": OUTSIDE}
    return ax.plot(x[outside], y[outside], "o", **look) if outside.any() else []


def plain_ticks(axis, values, most=11):
    """Give a logarithmic axis of few decades ticks that are plain numbers, at most about so many.

    values : those that the axis shows
    """
    decades = np.log10(np.max(values) / np.min(values))
    if decades < FEW_DECADES:
        fitting = [subs for subs in TICKS if decades * len(subs) <= most]
        axis.set_major_locator(LogLocator(subs=fitting[0]))
        axis.set_major_formatter(FormatStrFormatter("%g"))
        axis.set_minor_locator(NullLocator())
    axis.set_minor_formatter(NullFormatter())


def text_width(text, size):
    """Return the width of a text whose letters have this size [points]."""
    font, is_math = FontProperties(size=size), cbook.is_math_text(text)
    return text_to_path.get_text_width_height_descent(text, font, is_math)[0]


def wrapped(parts, width, size):
    """Texts one after another, in lines that are at most `width` wide if each text is [points]."""
    lines, rest = [], list(parts)
    while rest:
        counts = range(2, len(rest) + 1)
        n = 1 + bisect_right(counts, width, key=lambda k: text_width(" ".join(rest[:k]), size))
        lines.append(" ".join(rest[:n]))
        rest = rest[n:]
    return "\n".join(lines)


def shades(number):
    """Colours (number, 4) of so many lines, from dark to light."""
    return colormaps["viridis"](np.linspace(0.0, 0.85, number))


def letters(axes, *texts, first="a"):
    """Mark panels with their letters in bold, and what each shows, above its upper left corner."""
    for i, (ax, text) in enumerate(zip(axes, texts or repeat(""), strict=False)):
        mark = chr(ord(first) + i)
        ax.set_title(rf"$\mathbf{{({mark})}}$ {text}", loc="left", fontsize=8, pad=4)


def save(fig, path):
    """Write a figure to a file, with the same bytes each time; no partial files.

    Parameters
    ----------
    fig : matplotlib.figure.Figure
        Figure to write.  If it has no layout, such as ``layout="constrained"``, the file is as
        large as the figure with all its labels.
    path : str or Path
        File, whose name ends in .png (300 dpi) or .pdf.  An existing file is replaced.  For other
        formats use the figure's ``savefig``.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ParameterError
        If the name has another ending, or if the folder does not exist.
    OSError
        If the file cannot be written.  An existing file stays as it was.
    """
    path = checked_path(path, PICTURES)
    form: Any = (
        {"dpi": DPI} if path.suffix.lower() == ".png" else {"metadata": {"CreationDate": None}}
    )
    if fig.get_layout_engine() is None:
        form["bbox_inches"] = "tight"
    return replace(path, lambda partial: fig.savefig(partial, **form))
