"""The bifurcation diagram of a branch of limit cycles."""

import numpy as np

from ..dynamics.attributes import branch_parameter
from ..dynamics.results import parameter
from ..errors import ParameterError
from ..friction.stability import K_c
from ..model.quantities import QUANTITIES
from .labels import AMPLITUDE, BLUE, GRAY, RED
from .labels import label as symbol_text

STABLE, UNSTABLE = {"ls": "-", "lw": 1.6}, {"ls": (0, (4, 2)), "lw": 1.1}
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
    """Draw the amplitude of limit cycles along a branch, and the steady sliding beside them.

    Solid where stable and dashed where not, with the special points; steady sliding is at 0.

    Parameters
    ----------
    data : xarray.Dataset
        From `continue_cycle`.
    ax : matplotlib.axes.Axes, optional
        By default those of a new figure of pyplot's.  Several branches may share one.
    color, label : str
        Of the cycles, in the legend with whether they are stable.

    Returns
    -------
    matplotlib.axes.Axes
    """
    if not {"parameter", "rtol"} <= set(getattr(data, "attrs", ())):
        raise ParameterError("branch wants the Dataset that continue_cycle gives")
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.subplots()[1]
    return diagram(data, ax, 1.0, QUANTITIES[branch_parameter(data)].unit, color, label)


def diagram(data, ax, factor, unit, color=BLUE, label="cycle"):
    """Draw a `branch` over the parameter times a factor, which is in this unit."""
    symbol = branch_parameter(data)
    x, amplitude, special = (data[name].values for name in (symbol, "amplitude", "special"))
    at = np.geomspace(x.min() / 1.05, x.max() * 1.05, 2001)
    stable = _steady_is_stable(data, symbol, at)
    x, at = factor * x, factor * at
    _pieces(ax, at, np.zeros_like(at), stable[:-1], color="k", label="steady sliding")
    # Where a multiplier is on the unit circle, rounding would tell stable from unstable.
    turning = np.isin(special, ["hopf", "fold", "period_doubling", "torus"])
    firm = data.stable.values.astype(bool) | turning
    _pieces(ax, x, amplitude, firm[:-1] & firm[1:], color=color, label=label)
    for kind, (name, marker, face) in MARKS.items():
        if (here := special == kind).any():
            style = {"mfc": face, "mec": "k", "mew": 0.8, "ms": 4.5, "zorder": 5}
            ax.plot(x[here], amplitude[here], marker, ls="", label=_once(ax, name), **style)
    name = f"{QUANTITIES[symbol].long_name.capitalize()} {symbol_text(symbol)}"
    ax.set(xlabel=name + ("" if unit in ("", "1") else f" [{unit}]"), ylabel=AMPLITUDE)
    if x.max() > NARROW * x.min():
        ax.set_xscale("log")
    ax.legend()
    return ax


def _pieces(ax, x, y, stable, *, color, label):
    """Draw a line of n points, solid in those of its n - 1 pieces that are stable, else dashed."""
    cuts = np.flatnonzero(np.diff(stable.astype(int))) + 1
    for first, last in zip([0, *cuts], [*cuts, len(stable)], strict=True):
        firm = bool(stable[first])
        name = _once(ax, f"{label}, {'stable' if firm else 'unstable'}")
        look = STABLE if firm else UNSTABLE
        ax.plot(x[first : last + 1], y[first : last + 1], color=color, label=name, **look)


def _once(ax, name):
    """The name for a legend, hidden from it where it stands there already."""
    return f"_{name}" if name in ax.get_legend_handles_labels()[1] else name


def _steady_is_stable(data, symbol, at):
    """Whether steady sliding is stable where the parameter that changes has these values."""
    symbols = ("a", "b", "Dc", "sigma", "M", "K", "V_lp")
    values = {s: parameter(data, s) for s in symbols if s != symbol} | {symbol: at}
    K, V_lp = values.pop("K"), values.pop("V_lp")
    return np.broadcast_to(K_c(V_lp, **values) < K, at.shape)
