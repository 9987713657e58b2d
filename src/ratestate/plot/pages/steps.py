"""Fits of all steps and holds: each with its curves, and the estimates along the experiment."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation

from ...dynamics import attributes
from ...model.quantities import QUANTITIES, readable
from ...records.fitting.steps.result import FAILED
from ...records.fitting.steps.table import results_by_law_of_steps
from ...records.fitting.table import law_names
from ..labels import ABSCISSAE, GRAY, LAWS, in_unit, label, prefixed, scaled
from ..layout import figure, letters, plain_ticks

#: panels in a row; steps that are shown: of more, some all along the record
COLUMNS, MOST = 5, 40
#: heights [inches] of a step and of the estimates, and of titles and labels
STEP, ESTIMATE, TITLE, LABELS = 1.05, 1.75, 0.5, 0.35
#: least height of all steps together [inches]
LEAST = 1.8
#: estimates that are drawn along the experiment, where they were made
DRAWN = ("a_minus_b", "Dc")
#: against what
ALONG = ("V_after", "step_delta_lp")
#: how far the markers of one law are beside those of another [inches]
BESIDE = 0.035
#: kind of step -> marker of its estimate, by whether the speed rises
MARKERS = {("step", True): "^", ("step", False): "v", ("hold", False): "o"}


def steps_page(result):
    """Page (Figure) of fits of steps: a panel for each, and a - b and Dc along the experiment."""
    laws = results_by_law_of_steps(result)
    shown = np.unique(np.linspace(0, result.sizes["step"] - 1, MOST).astype(int))
    shown = shown if result.sizes["step"] > MOST else np.arange(result.sizes["step"])
    columns = min(shown.size, COLUMNS)
    rows = -(-shown.size // columns)
    of_any = result["parameter"].values if result.sizes["step"] > 1 else ()
    drawn = [symbol for symbol in DRAWN if symbol in of_any]
    heights = [max(rows * STEP, LEAST) + LABELS, *([ESTIMATE] * len(drawn))]
    fig = figure(result, sum(heights) + TITLE, "M V0", title=_title(result, laws, shown.size))
    parts = fig.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    panels = parts[0].subplots(rows, columns, squeeze=False).ravel()
    for ax, i in zip(panels, shown, strict=False):
        _step(result.isel(step=i), {law: part.isel(step=i) for law, part in laws.items()}, ax)
    for ax in panels[shown.size :]:
        ax.set_axis_off()
    _legend(panels[0].lines[0], parts[0], laws)
    parts[0].supylabel("Friction, change in $10^{-3}$", fontsize=8)
    for part, symbol in zip(parts[1:], drawn, strict=True):
        axes = part.subplots(1, len(ALONG), sharey=True)
        for ax, along in zip(axes, ALONG, strict=True):
            _along(laws, symbol, along, ax)
        axes[0].set_ylabel(in_unit(label(symbol), _scale(laws, symbol)[1]))
        letters(axes, first="abcd"[2 * drawn.index(symbol)])
    return fig


def _title(result, laws, shown):
    """What was fitted."""
    source, n = attributes.text(result, "source", ""), result.sizes["step"]
    what = "1 step" if n == 1 else f"{n} steps and holds"
    of = f"Fits of {what}{f' of {source}' if source else ''}, {law_names(tuple(laws))}"
    return of if shown == n else f"{of} ({shown} of them shown)"


def _step(step, laws, ax):
    """A step's record about its start, under the fitted curves."""
    x, unit = _abscissa(step)
    level = float(np.nanmedian(step["friction"]))
    ax.plot(x, 1e3 * (step["friction"] - level), color="0.6", lw=0.4, rasterized=True)
    for law, part in laws.items():
        if part["status"] != FAILED:
            ax.plot(x, 1e3 * (part["friction_fit"] - level), lw=0.9, **LAWS[law].line)
    ax.axvline(0.0, color=GRAY, lw=0.6, ls=":", zorder=0)
    failed = all(part["status"] == FAILED for part in laws.values())
    head = f"{int(step['step'])}  {_head(step)}{' failed' if failed else ''}"
    ax.set_title(head, fontsize=6, pad=2, color="#c00000" if failed else "k")
    ax.tick_params(labelsize=6, pad=1.5)
    ax.xaxis.set_major_locator(MaxNLocator(4))
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.set_xlabel(f"[{unit}]", fontsize=6, labelpad=0.5)
    ax.margins(x=0.0)


def _abscissa(step):
    """Displacement, or time at a hold and where none was recorded, since the step; its unit."""
    is_hold = step["kind"] == "hold" or not np.isfinite(step["step_delta_lp"])
    name, origin = ("time", "step_t") if is_hold else ("delta_lp", "step_delta_lp")
    values = (step[name] - step[origin]).values
    factor, unit = prefixed(QUANTITIES[name].unit, float(np.nanmax(np.abs(values))))
    return factor * values, unit


def _head(step):
    """What the load point does, or the normal stress."""
    if step["kind"] == "hold":
        return f"hold {readable('t', float(step['t_hold']), 3)}"
    if step["kind"] == "normal stress":
        return "normal stress"
    before, after = (float(step[name]) for name in ("V_before", "V_after"))
    factor, unit = prefixed("m/s", max(before, after))
    return f"{factor * before:.3g} \N{RIGHTWARDS ARROW} {factor * after:.3g} {unit}"


def _legend(recorded, part, laws):
    """What the lines of the steps and the markers are, above all panels."""
    handles = [recorded, *(Line2D([], [], **LAWS[law].line) for law in laws)]
    names = ["recorded", *(f"{law} law" for law in laws)]
    for (kind, up), marker in MARKERS.items():
        handles.append(Line2D([], [], marker=marker, color="0.3", ms=3.5, ls=""))
        names.append("hold" if kind == "hold" else f"step {'up' if up else 'down'}")
    look = {"handlelength": 1.6, "columnspacing": 0.9, "handletextpad": 0.4, "fontsize": 7}
    part.legend(handles, names, loc="outside upper right", ncols=len(names), **look)


def _scale(laws, symbol):
    """What values of an estimate are multiplied by, and its unit."""
    sizes = [np.nanmax(np.abs(part[symbol].values)) for part in laws.values()]
    return scaled(symbol, float(np.nanmax(sizes)))


def _along(laws, symbol, along, ax):
    """An estimate of each step, with its 68 % interval, against speed or displacement."""
    factor, _ = _scale(laws, symbol)
    x = next(iter(laws.values()))[along].values
    to_unit, unit = prefixed(QUANTITIES[along].unit, float(np.nanmax(np.abs(x))))
    for i, (law, part) in enumerate(laws.items()):
        own = part.sel(parameter=symbol)
        beside = ScaledTranslation(i * BESIDE, 0.0, ax.figure.dpi_scale_trans)
        value = own[symbol].values
        low, high = np.abs(own["interval"].isel(level=0).transpose("side", "step").values - value)
        for (kind, up), marker in MARKERS.items():
            rises = own["V_after"] > own["V_before"] if kind == "step" else False
            at = ((own["kind"] == kind) & (up == rises)).values & np.isfinite(value)
            errors = np.where(np.isfinite([low, high]), [low, high], 0.0)[:, at]
            ax.errorbar(
                to_unit * x[at],
                factor * value[at],
                factor * errors,
                fmt=marker,
                ms=3.5,
                lw=0.8,
                color=LAWS[law].color,
                transform=ax.transData + beside,
            )
    if along == "V_after" and np.ptp(x) > 0.0:
        ax.set_xscale("log")
        plain_ticks(ax.xaxis, to_unit * x)
    what = ABSCISSAE["delta_lp"] if along == "step_delta_lp" else label("V_lp") + " after the step"
    ax.set_xlabel(in_unit(what, unit))
    if symbol == "a_minus_b":
        ax.axhline(0.0, color=GRAY, lw=0.6, zorder=0)
