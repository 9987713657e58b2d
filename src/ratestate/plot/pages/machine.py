"""Stiffness and inertia of a machine: the slopes and the ring-downs with their fits."""

import numpy as np

from ...dynamics import attributes
from ...records.machine.text import estimate
from ..labels import BLUE, GRAY, RED, prefixed
from ..layout import figure, letters, styled

#: slopes and ring-downs that are drawn at most; part of its length that is shown beside each
MOST, BESIDE = 4, 0.5


@styled
def machine_page(result):
    """Page (Figure) of a result of `machine_stiffness`."""
    source = attributes.text(result, "source", "")
    title = f"Machine{f' of {source}' if source else ''}: " + ", ".join(
        estimate(result, symbol) for symbol in ("K", "M", "damping")
    )
    title = title.replace("+-", "\N{PLUS-MINUS SIGN}").replace("^2", "$^2$")
    rows = [n for n in ("slope", "ring_down") if result.sizes[n]]
    fig = figure(result, 0.6 + 2.3 * len(rows), symbols="", title=title)
    panels, texts = [], []
    for part, name in zip(np.ravel(fig.subfigures(len(rows), 1)), rows, strict=True):
        number = min(result.sizes[name], MOST)
        axes = part.subplots(1, number, squeeze=False)[0]
        for i, ax in enumerate(axes):
            _one(result, name, i, ax)
            panels.append(ax)
            texts.append(_what(result, name, i))
        axes[0].set_ylabel(r"Friction $\tau/\sigma$")
    letters(panels, *texts)
    return fig


def _what(result, name, i):
    """What stands above a panel."""
    if name == "slope":
        kind = str(result["slope_kind"].values[i]).replace("_", " ")
        return f"{kind}: {result['slope_K'].values[i] / 1e9:.3g} GPa/m"
    hertz = result["ring_down_omega"].values[i] / (2.0 * np.pi)
    return f"ring-down: {hertz:.4g} Hz"


def _one(result, name, i, ax):
    """Draw the samples about one slope or ring-down, and its curve."""
    t, fitted = result["time"].values, result[f"{name}_friction"].values
    start = float(result[f"{name}_start"].values[i])
    later = result[f"{name}_start"].values
    ends = later[later > start]
    known = np.flatnonzero(np.isfinite(fitted) & (t >= start))
    known = known[t[known] < ends.min()] if ends.size else known
    lasts = float(t[known[-1]] - start)
    shown = (t > start - 0.2 * lasts) & (t < start + (1.0 + BESIDE) * lasts)
    factor, unit = prefixed("s", lasts)
    look = {"ls": "", "marker": ".", "ms": 2.0, "mew": 0.0, "color": "0.55", "rasterized": True}
    ax.plot(factor * (t[shown] - start), result["friction"].values[shown], **look)
    color = RED if name == "slope" else BLUE
    ax.plot(factor * (t[known] - start), fitted[known], color=color, lw=1.2)
    ax.axvline(0.0, color=GRAY, lw=0.7, ls=":")
    ax.set_xlabel(f"Time [{unit}]")
