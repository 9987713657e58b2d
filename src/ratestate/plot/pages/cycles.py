"""The page of a fit of cycles: the record, its last cycles, the features, the estimates."""

import numpy as np

from ..curves import curves, normal_95, record_of
from ..labels import LAWS
from ..layout import letters
from .frame import finished, framed, legend

#: cycles seen from close by
LAST = 4
MARKERS = "os^D"
HEIGHTS = [1.5, 1.9]  # inches


def cycles_page(result):
    """Page (Figure) of a fit against cycles."""
    record = record_of(result, "time")
    laws, t = record.laws, record.t
    fig, (top, *below) = framed(result, laws, sum(HEIGHTS))
    axes = top.subplot_mosaic([["a", "a"], ["b", "c"]], height_ratios=HEIGHTS)
    curves(record, axes["a"])
    legend(axes["a"], laws, band=False)
    period = max(float(part["fitted"].sel(feature="period")[-1]) for part in laws.values())
    first = int(np.searchsorted(t, t[-1] - LAST * period))
    curves(record, axes["b"], slice(first, None))
    _features(axes["c"], laws)
    texts = ("the cycles fitted", f"the last {LAST}", "fitted less measured features")
    letters(axes.values(), *texts)
    finished(result, below, "d")
    return fig


def _features(ax, laws):
    """By how many standard errors the features of the fitted cycle are off."""
    names = next(iter(laws.values()))["feature"].values.tolist()
    at = np.arange(len(names))
    normal_95(ax)
    for i, (law, part) in enumerate(laws.items()):
        off = ((part["fitted"] - part["measured"]) / part["measured_error"]).where(part["used"])
        color = LAWS[law].color
        shift = 0.2 * (i - 0.5 * (len(laws) - 1))
        for j, row in enumerate(off.transpose("segment", "feature").values):
            style = {"color": color, "mfc": "w" if j else color, "ms": 4, "ls": ""}
            ax.plot(at + shift, row, MARKERS[j % len(MARKERS)], **style)
    ax.set_xticks(at, names)
    ax.tick_params(axis="x", length=0)
    ax.set(ylabel="over standard error")
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -3.0), max(high, 3.0))
