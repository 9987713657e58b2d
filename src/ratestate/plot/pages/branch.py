"""The page of a branch: its bifurcation diagram, extreme speeds, and multiplier."""

import numpy as np

from ...dynamics.attributes import branch_parameter
from ...dynamics.results import parameter
from ...model.quantities import QUANTITIES
from ..bifurcation import NARROW, STABLE, UNSTABLE, diagram
from ..labels import BLUE, GRAY, RED, label, prefixed
from ..laws import LAWS
from ..layout import figure, letter, styled

# Ratio of speeds from which a logarithmic axis pays.
WIDE = 10.0


@styled
def branch_page(data):
    """Page of a branch of limit cycles."""
    symbol = branch_parameter(data)
    law = LAWS[parameter(data, "law")]
    title = f"Limit cycles along {label(symbol)}, {law}"
    fig = figure(data.assign_attrs(title=title), 5.2, "a b Dc sigma M K")
    axes = fig.subplot_mosaic([["a", "a"], ["b", "c"]], height_ratios=[1.25, 1])
    factor, unit = prefixed(QUANTITIES[symbol].unit, float(data[symbol].max()))
    diagram(data, axes["a"], factor, unit)
    x, V_lp = factor * data[symbol].values, parameter(data, "V_lp")
    firm = np.append(data.stable.values.astype(bool)[1:], True)
    for name, color in (("V_max", RED), ("V_min", BLUE)):
        ratio = (data[name] / V_lp).values
        _line(axes["b"], x, ratio, firm, color, label(name))
    _line(axes["c"], x, np.abs(data.multipliers.values[:, 0]), firm, "k", "")
    axes["b"].set(ylabel=f"Speed over {label('V_lp')}")
    if float((data.V_max / data.V_min).max()) > WIDE:
        axes["b"].set_yscale("log")
    axes["c"].set(ylabel="Larger Floquet multiplier (size)")
    for ax in (axes["b"], axes["c"]):
        ax.axhline(1.0, color=GRAY, lw=0.7, zorder=0)
        ax.set_xlabel(label(symbol) + (f" [{unit}]" if unit else ""))
        if x.max() > NARROW * x.min():
            ax.set_xscale("log")
    axes["b"].legend()
    for name, text in zip(
        "abc",
        ("amplitude", "fastest and slowest slip", "decay factor per period"),
        strict=True,
    ):
        letter(axes[name], name, text)
    return fig


def _line(ax, x, y, firm, color, name):
    """A line, solid where the cycle is stable, else dashed."""
    whole = np.where(firm[:-1], 1.0, np.nan)
    for mask, look, text in (
        (whole, STABLE, name),
        (np.where(firm[:-1], np.nan, 1.0), UNSTABLE, ""),
    ):
        pieces = np.column_stack([x[:-1], x[1:], np.full(x.size - 1, np.nan)])
        values = np.column_stack([y[:-1] * mask, y[1:] * mask, np.full(x.size - 1, np.nan)])
        ax.plot(pieces.ravel(), values.ravel(), color=color, label=text or None, **look)
