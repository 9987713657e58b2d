"""The page of a fit: record and curves, residuals, the steps from close by, the estimates."""

import numpy as np

from ...records.fitting.by_law import results_by_law, value_of
from ..curves import axis_of, change, curves, marks, residuals, segments
from ..laws import COLORS
from ..layout import letter, styled
from .cycles import cycles_page
from .frame import finished, framed, legend

#: close-ups: how many at most, the fewest samples, what is before a step over what is after it
MOST, FEWEST, BEFORE = 3, 12, 0.3
#: what is after it: over Dc, and over the displacement that loads the spring by the direct effect
AFTER, LOADING = 6.0, 2.0
#: speed of slip after a hold over that of the load point, for want of a better one
QUIET = 1e-4
#: part of the record from which on a close-up shows nothing new
WHOLE = 0.7
#: heights [inches] of a record and of residuals
RECORD, RESIDUAL = 2.0, 0.62


@styled
def fit_page(result, x=None):
    """Page of a fit; x, of one against time or displacement, as `plot.fit` has it."""
    if result.attrs.get("against") == "cycles":
        return cycles_page(result)
    axis, laws = axis_of(result, x), results_by_law(result)
    close = _close_ups(result, axis, laws)
    rows, heights = _rows(laws, [*close])
    fig, (top, *below) = framed(result, laws, sum(heights))
    ratios = [1.25, 1.0] if len(close) == 1 else None
    axes = top.subplot_mosaic(rows, height_ratios=heights, width_ratios=ratios)
    views = {"record": slice(None)} | close
    for name, samples in views.items():
        curves(result, axes[name], axis, samples, close=name != "record")
        marks(result, axes[name], axis, named=name == "record")
    legend(axes["record"], laws)
    for law, part in laws.items():
        for name, samples in views.items():
            if (panel := axes.get(f"{law} {name}")) is not None:
                residuals(part, panel, axis, law, samples, close=name != "record")
                marks(result, panel, axis)
    _dress(axes, laws, views)
    finished(result, below, "abcdefghij"[len(views) :])
    return fig


def _rows(laws, close):
    """Names of the panels as a mosaic (record, LAW record for residuals, close-ups); heights."""
    rows = [["record"], *([f"{law} record"] for law in laws)]
    heights = [RECORD] + [RESIDUAL] * len(laws)
    if len(close) == 1:  # it stands beside the record
        rows = [[*row, row[0].replace("record", close[0])] for row in rows]
    elif close:
        rows = [row * len(close) for row in rows] + [close]
        heights.append(RECORD)
    return rows, heights


def _close_ups(result, axis, laws):
    """Change of speed in words -> samples about it, of the first steps and slides after holds."""
    found = segments(result)
    starts = [t for t, _ in found] + [axis.t[-1]]
    views = {}
    for i in range(1, len(found)):
        (_, before), (start, V), end = found[i - 1], found[i], starts[i + 1]
        if V == 0.0:
            continue
        reach = max(_reach(part, before or QUIET * V, V) for part in laws.values())
        here, high = axis.at(start), axis.at(min(end, start + reach / V))
        low = max(axis.at(starts[i - 1]), here - BEFORE * (high - here))
        rows = slice(*np.searchsorted(axis.values, (low, high)))
        if rows.stop - rows.start >= FEWEST and high - low < WHOLE * axis.values[-1]:
            views[f"{change(result, i, whole=True)} ({i})"] = rows
    return dict(list(views.items())[:MOST])


def _reach(part, before, V):
    """Displacement [m] in which a step is over: the spring loads, and the state evolves."""
    a, Dc, K, sigma = (value_of(part, symbol) for symbol in ("a", "Dc", "K", "sigma"))
    return AFTER * Dc + LOADING * a * sigma / K * abs(np.log(V / before))


def _dress(axes, laws, views):
    """Share the axes that lie under each other, and say what each is."""
    for name in views:
        below = [axes[f"{law} {name}"] for law in laws if f"{law} {name}" in axes]
        for panel in [axes[name], *below][:-1]:
            panel.sharex(below[-1])
            panel.tick_params(labelbottom=False)
            panel.set_xlabel("")
        if name != "record" and below:
            for panel in (axes[name], *below):
                panel.set_ylabel("")
    for law in laws:
        panel = axes[f"{law} record"]
        at = {"transform": panel.transAxes, "va": "top", "fontsize": 7, "color": COLORS[law]}
        box = {"fc": "w", "ec": "none", "pad": 0.5, "alpha": 0.8}
        panel.text(0.01, 0.93, f"{law} law", fontweight="bold", bbox=box, **at)
    for mark, name in zip("abcd", views, strict=False):
        text = "" if name == "record" else name.rpartition(" (")[0]
        letter(axes[name], mark, text)
