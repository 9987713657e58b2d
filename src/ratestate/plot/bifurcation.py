"""The bifurcation diagram of a branch of limit cycles, and its figure."""

import numpy as np

from ..dynamics.continuation.bifurcations import stable_pieces
from ..dynamics.results import branch_parameter, contact_area, law_of_result, parameter
from ..errors import ParameterError
from ..friction.linear_stability import is_stable
from ..model.conversion import in_si
from ..model.quantities import QUANTITIES
from .labels import AMPLITUDE, BLUE, DASHED, GRAY, LAWS, RED, fitting_unit, in_unit, name_and_symbol
from .labels import label as symbol_text
from .layout import figure, is_wide, letters, mark_outside, styled

STABLE, UNSTABLE = {"ls": "-", "lw": 1.6}, {"ls": DASHED, "lw": 1.1}
# Ratio of the parameter's ends up to which a logarithmic axis would have no room for its ticks.
NARROW = 3.0
#: special point -> name, marker, face colour
MARKS = {
    "hopf": ("Hopf", "o", RED),
    "fold": ("fold of cycles", "^", "w"),
    "period_doubling": ("period doubling", "s", "w"),
    "torus": ("torus", "D", "w"),
    "start": ("start", ">", GRAY),
    "stop": ("stop", "|", GRAY),
}


def branch(data, ax=None, *, color=BLUE, label="cycle"):
    """Draw the amplitude of limit cycles along a branch, and steady sliding as amplitude 0.

    Stable motions are solid lines, unstable motions dashed.  Special points are marked.  The
    abscissa is the parameter in SI; it is logarithmic if the parameter changes more than threefold.

    Parameters
    ----------
    data : xarray.Dataset
        From `continue_cycle`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into, by default the axes of a new pyplot figure.  Several branches may share
        axes.
    color, label : str
        Colour and name of the cycles.  The legend adds whether they are stable.

    Returns
    -------
    matplotlib.axes.Axes
        The axes with the diagram.

    Raises
    ------
    ParameterError
        If it is not a result of `continue_cycle`, or the branch has only one point.
    """
    if not hasattr(data, "attrs"):
        raise ParameterError(
            "branch draws the Dataset of continue_cycle, and this is not one",
            "Give the result of continue_cycle.",
        )
    data = in_si(data)
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.subplots()[1]
    unit = QUANTITIES[branch_parameter(data)].unit
    return _diagram(data, ax, 1.0, "" if unit == "1" else unit, color, label)


@styled
def branch_figure(data):
    """Draw the figure of a branch of limit cycles; ParameterError if it has one point."""
    symbol = branch_parameter(data)
    title = f"Limit cycles along {symbol_text(symbol)}, {LAWS[parameter(data, 'law')].name}"
    fig = figure(data, 5.2, title=title)
    axes = fig.subplot_mosaic([["a", "a"], ["b", "c"]], height_ratios=[1.25, 1])
    area = contact_area(data)
    factor, unit = fitting_unit(symbol, data[symbol], area)
    _diagram(data, axes["a"], factor, unit, area=area)
    x, V_lp = factor * data[symbol].values, parameter(data, "V_lp")
    stable = stable_pieces(data.special.values, data.stable.values)
    for name, color in (("V_max", RED), ("V_min", BLUE)):
        _pieces(axes["b"], x, (data[name] / V_lp).values, stable, color, 2 * [symbol_text(name)])
    _pieces(axes["c"], x, np.abs(data.multipliers.values[:, 0]), stable, "k")
    axes["b"].set(ylabel=f"Speed over {symbol_text('V_lp')}")
    if is_wide((data[["V_max", "V_min"]].to_array() / V_lp).values):
        axes["b"].set_yscale("log")
    axes["c"].set(ylabel="Floquet multiplier (size)")
    for ax in (axes["b"], axes["c"]):
        ax.axhline(1.0, color=GRAY, lw=0.7, zorder=0)
        _abscissa(ax, x, symbol_text(symbol), unit)
    axes["b"].legend()
    letters(axes.values(), "amplitude", "fastest and slowest slip", "decay factor per period")
    return fig


def _diagram(data, ax, factor, unit, color=BLUE, label="cycle", area=None):
    """Draw a `branch` over the parameter times a factor, which is in this unit."""
    if data.sizes["point"] < 2:
        raise ParameterError(
            f"the branch has {data.sizes['point']} points, too few to draw",
            "Give 2 points or more.",
        )
    symbol = branch_parameter(data)
    x, amplitude, special = (data[name].values for name in (symbol, "amplitude", "special"))
    at = np.geomspace(x.min() / 1.05, x.max() * 1.05, 2001)
    stable = _steady_is_stable(data, symbol, at)[:-1]
    x, at = factor * x, factor * at
    _pieces(ax, at, np.zeros_like(at), stable, "k", _by_stability("steady sliding"))
    stable = stable_pieces(special, data.stable.values)
    _pieces(ax, x, amplitude, stable, color, _by_stability(label))
    if "outside_domain" in data:
        mark_outside(ax, x, amplitude, (data.outside_domain.values > 0) & (amplitude > 0.0))
    for kind, (name, marker, face) in MARKS.items():
        if (rows := special == kind).any():
            style = {"mfc": face, "mec": "k", "mew": 0.8, "ms": 4.5, "zorder": 5}
            ax.plot(x[rows], amplitude[rows], marker, ls="", label=_new_label(ax, name), **style)
    _abscissa(ax, x, name_and_symbol(symbol, area), unit)
    ax.set_ylabel(AMPLITUDE)
    ax.legend()
    return ax


def _abscissa(ax, x, text, unit):
    """Label the parameter's axis, which is logarithmic if that pays."""
    ax.set_xlabel(in_unit(text, unit))
    if x.max() > NARROW * x.min():
        ax.set_xscale("log")


def _by_stability(name):
    """What a legend says of the unstable and of the stable pieces of a line."""
    return f"{name}, unstable", f"{name}, stable"


def _pieces(ax, x, y, stable, color, names=("", "")):
    """Draw a line of n points, whose n - 1 pieces are solid if stable, else dashed."""
    cuts = np.flatnonzero(np.diff(stable.astype(int))) + 1
    for first, last in zip([0, *cuts], [*cuts, len(stable)], strict=True):
        look = STABLE if stable[first] else UNSTABLE
        name = _new_label(ax, names[int(stable[first])])
        ax.plot(x[first : last + 1], y[first : last + 1], color=color, label=name, **look)


def _new_label(ax, name):
    """The name for a legend, hidden from it where it stands there already."""
    return f"_{name}" if name in ax.get_legend_handles_labels()[1] else name


def _steady_is_stable(data, symbol, at):
    law = law_of_result(data)
    symbols = ("sigma", "M", "K", "V_lp", *law.symbols)
    values = {s: parameter(data, s) for s in symbols if s != symbol} | {symbol: at}
    values = {s: np.broadcast_to(value, at.shape) for s, value in values.items()}
    return is_stable(law, values.pop("V_lp"), **values)
