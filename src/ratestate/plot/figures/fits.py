"""Figures of fits: record and curves, residuals, close-ups; also fits of cycles."""

import numpy as np

from ...errors import ParameterError
from ...model.conversion import in_si
from ...records.fitting.by_law import checked_by_law, has_steps, law_of, value_of
from ..curves import ALL_ROWS, SINCE_START, curves, marks, normal_95, record_of, residuals
from ..labels import LAWS
from ..layout import letters, styled
from .fit_parts import finished, legend, titled_figure
from .steps import steps_figure

#: close-ups: how many at most, the fewest samples, what is before a step over what is after it
MAX_CLOSE_UPS, FEWEST, PART_BEFORE = 3, 12, 0.3
#: what is after it: over the longest Dc, and over the displacement that loads the spring by the
#: direct effect
AFTER, LOADING = 6.0, 2.0
#: speed of slip after a hold over that of the load point, for want of a better one
QUIET = 1e-4
#: part of the record from which on a close-up shows nothing new
MAX_PART = 0.7
#: heights [inches] of a record and of residuals
RECORD, RESIDUAL = 2.0, 0.62
#: cycles seen from close by
LAST = 4
MARKERS = "os^D"
HEIGHTS = [1.5, 1.9]  # inches


@styled
def fit(result, ax=None, *, x=None):
    """Draw a fit: the record, and the fitted curves with a 95 % band.

    Without `ax` it is a whole figure, which also has the residuals, close-ups of the first steps,
    and a table of the estimates.  Axes that are given get their labels and a legend.  Friction is a
    pure number, and the abscissa has a unit that fits, such as mm.  Under several laws only the law
    with the smallest residuals has a band.

    Parameters
    ----------
    result : xarray.Dataset
        From `ratestate.fit`, under one law or several.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into, but not for a fit with ``per_step``.  In a figure with
        ``layout="constrained"`` its labels have room.
    x : {"delta_lp", "time"}, optional
        Abscissa: load-point displacement [m] or time [s], counted from the first sample of the
        record.  The default is displacement, or time if the load point rests.  A fit of cycles has
        the time only.

    Returns
    -------
    matplotlib.figure.Figure
        A new figure, or the figure of the axes.

    Raises
    ------
    ParameterError
        If it is not a result of `ratestate.fit`, has lost its attributes, or cannot be drawn so.
    """
    if has_steps(result):
        if ax is not None:
            raise ParameterError(
                "fits of steps fill a whole figure", "Leave ax out, or pick one with .isel."
            )
        return fit_figure(in_si(result))
    checked_by_law(result, "plot.fit")
    result = in_si(result)
    if ax is None:
        return fit_figure(result, x)
    record = record_of(result, x)
    curves(record, ax)
    marks(record, ax)
    legend(ax, record.laws, narrow=True)
    ax.set_xlabel(ax.get_xlabel().replace(SINCE_START, ""))  # axes of a paper are narrow
    return ax.figure


@styled
def fit_figure(result, x=None):
    """Draw the figure of a fit; x as of `fit`, without effect on a fit of cycles."""
    if has_steps(result):
        return steps_figure(result)
    if result.attrs.get("against") == "cycles":
        return cycles_figure(result)
    record = record_of(result, x)
    laws, close = [*record.laws], _close_ups(record)
    rows, heights = _mosaic_rows(laws, [*close])
    fig, (top, *below) = titled_figure(result, laws, sum(heights))
    ratios = [1.25, 1.0] if len(close) == 1 else None
    axes = top.subplot_mosaic(rows, height_ratios=heights, width_ratios=ratios)
    views = {"record": ALL_ROWS} | close
    for name, samples in views.items():
        curves(record, axes[name], samples)
        marks(record, axes[name], named=name == "record")
        column = [axes[name]]
        for law in laws:
            if (panel := axes.get(f"{law} {name}")) is not None:
                residuals(record, law, panel, samples)
                marks(record, panel)
                column.append(panel)
        _share(column, named=name == "record" or len(column) == 1)
    legend(axes["record"], record.laws, narrow=len(close) == 1)
    for law in laws:
        panel = axes[f"{law} record"]
        at = {"transform": panel.transAxes, "va": "top", "fontsize": 7, "color": LAWS[law].color}
        box = {"fc": "w", "ec": "none", "pad": 0.5, "alpha": 0.8}
        text = f"{law} law, r.m.s. {1e3 * float(record.laws[law]['rms']):.2g}"
        panel.text(0.01, 0.93, text, fontweight="bold", bbox=box, **at)
    texts = ["", *(name.rpartition(" (")[0] for name in close)]
    letters([axes[name] for name in views], *texts)
    finished(result, below, "abcde"[len(views)])
    return fig


def _mosaic_rows(laws, close):
    """Names of the panels as a mosaic (record, LAW record for residuals, close-ups); heights."""
    rows = [["record"], *([f"{law} record"] for law in laws)]
    heights = [RECORD] + [RESIDUAL] * len(laws)
    if len(close) == 1:  # it stands beside the record
        rows = [[*row, row[0].replace("record", close[0])] for row in rows]
    elif close:
        rows = [row * len(close) for row in rows] + [close]
        heights.append(RECORD)
    return rows, heights


def _close_ups(record):
    """Change of speed in words -> samples about it, of the first steps and slides after holds."""
    views = {}
    for i, change in enumerate(record.changes, start=1):
        if change.V == 0.0:
            continue
        reach = max(_length_of_step(part, change) for part in record.laws.values())
        start = record.at(change.start)
        high = record.at(min(change.end, change.start + reach / change.V))
        low = max(record.at(change.previous), start - PART_BEFORE * (high - start))
        rows = slice(*np.searchsorted(record.values, (low, high)))
        if rows.stop - rows.start >= FEWEST and high - low < MAX_PART * record.values[-1]:
            views[f"{change.text(with_duration=True)} ({i})"] = rows
    return dict(list(views.items())[:MAX_CLOSE_UPS])


def _length_of_step(part, change):
    """Displacement [m] in which a step is over: the spring loads, and the state evolves."""
    a, K, sigma = (value_of(part, symbol) for symbol in ("a", "K", "sigma"))
    longest = max(value_of(part, symbol) for symbol in law_of(part).lengths)
    before = change.V_before or QUIET * change.V
    return AFTER * longest + LOADING * a * sigma / K * abs(np.log(change.V / before))


def _share(column, *, named):
    """Share the abscissa of panels under each other; the ordinates are named, or those beside."""
    for panel in column[:-1]:
        panel.sharex(column[-1])
        panel.tick_params(labelbottom=False)
        panel.set_xlabel("")
    if not named:
        for panel in column:
            panel.set_ylabel("")


def cycles_figure(result):
    record = record_of(result, "time")
    laws, t = record.laws, record.t
    fig, (top, *below) = titled_figure(result, laws, sum(HEIGHTS))
    axes = top.subplot_mosaic([["a", "a"], ["b", "c"]], height_ratios=HEIGHTS)
    curves(record, axes["a"])
    legend(axes["a"], laws)
    period = max(float(part["fitted"].sel(feature="period")[-1]) for part in laws.values())
    first = int(np.searchsorted(t, t[-1] - LAST * period))
    curves(record, axes["b"], slice(first, None))
    _features(axes["c"], laws)
    texts = ("the cycles fitted", f"the last {LAST}", "fitted less measured features")
    letters(axes.values(), *texts)
    finished(result, below, "d")
    return fig


def _features(ax, laws):
    names = next(iter(laws.values()))["feature"].values.tolist()
    at = np.arange(len(names))
    normal_95(ax)
    for i, (law, part) in enumerate(laws.items()):
        error = ((part["fitted"] - part["measured"]) / part["measured_error"]).where(part["used"])
        color = LAWS[law].color
        shift = 0.2 * (i - 0.5 * (len(laws) - 1))
        for j, row in enumerate(error.transpose("segment", "feature").values):
            style = {"color": color, "mfc": "w" if j else color, "ms": 4, "ls": ""}
            ax.plot(at + shift, row, MARKERS[j % len(MARKERS)], **style)
    ax.set_xticks(at, names)
    ax.tick_params(axis="x", length=0)
    ax.set(ylabel="over standard error")
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -3.0), max(high, 3.0))
