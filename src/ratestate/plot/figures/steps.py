"""The figure of fits of all steps and holds: each with its curves, and all estimates in order."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation

from ...dynamics.recipe import attribute_text
from ...model.quantities import QUANTITIES
from ...records.fitting.by_law import law_names, results_by_law
from ...records.fitting.steps import FITTED, STICK_SLIP
from ...report.steps import change_text
from ..labels import ABSCISSAE, GRAY, LAWS, in_unit, label, prefixed, scaled
from ..layout import figure, letters, plain_ticks

#: panels in a row; steps that are shown: of more, some all along the record
COLUMNS, MOST = 5, 40
#: heights [inches] of a step and of the estimates, and of titles and labels
STEP, ESTIMATE, TITLE, LABELS = 1.4, 1.75, 0.5, 0.35
#: least height of all steps together [inches]
LEAST = 2.2
#: heights of a step's curves and of their residuals
CURVES, RESIDUALS = 3.0, 1.0
#: width of a law's line, and of one below those of other laws, which are dashed: all are visible
LINE, BELOW = 0.8, 1.5
#: estimates that are drawn along the experiment, where they were made
DRAWN = ("a_minus_b", "Dc")
#: ratio of speeds up to which all steps are at one speed
ONE_SPEED = 1.01
#: the label of the axis along which estimates are drawn
AXES = {
    "V_after": f"{label('V_lp')} after the step",
    "t_hold": "Hold time",
    "step": "Number of the step",
    "step_delta_lp": ABSCISSAE["delta_lp"],
}
#: how far the markers of one law are beside those of another [inches]
MARKER_SHIFT = 0.035
#: the line of a record
RECORDED = {"color": "0.6", "rasterized": True}
#: kind of step -> marker of its estimate, by whether the speed rises
MARKERS = {("step", True): "^", ("step", False): "v", ("hold", False): "o"}


def steps_figure(result):
    """Draw the figure of fits of steps: a panel for each, and a - b and Dc along the experiment."""
    laws = results_by_law(result)
    n = result.sizes["step"]
    shown = np.linspace(0, n - 1, min(n, MOST)).astype(int)
    rows = -(-shown.size // COLUMNS)
    columns = -(-shown.size // rows)
    along = (_varied(result), "step_delta_lp")
    of_any = result["parameter"].values if n > 1 else ()
    drawn = [symbol for symbol in DRAWN if symbol in of_any]
    heights = [max(rows * STEP, LEAST) + LABELS, *([ESTIMATE] * len(drawn))]
    fig = figure(result, sum(heights) + TITLE, "M V0", title=_title(result, laws, shown.size))
    parts = fig.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    grid = parts[0].add_gridspec(rows, columns)
    for cell, i in zip(grid, shown, strict=False):
        pair = cell.subgridspec(2, 1, hspace=0.0, height_ratios=(CURVES, RESIDUALS))
        axes = pair.subplots(sharex=True)
        _step(result.isel(step=i), {law: part.isel(step=i) for law, part in laws.items()}, axes)
    _legend(result if drawn else None, parts[0], laws)
    if drawn:
        parts[0].suptitle(r"$\mathbf{(a)}$ steps and holds", x=0.01, ha="left", fontsize=8)
    parts[0].supylabel("Friction, change and residuals in $10^{-3}$", fontsize=8)
    for part, symbol in zip(parts[1:], drawn, strict=True):
        axes = part.subplots(1, len(along), sharey=True)
        for ax, name in zip(axes, along, strict=True):
            _draw_estimates(laws, symbol, name, ax)
        axes[0].set_ylabel(in_unit(label(symbol), _scale(laws, symbol)[1]))
        letters(axes, first="bd"[drawn.index(symbol)])
    return fig


def _varied(result):
    """Return what differs between the steps: the speed after them, hold time, or their number."""
    V = result["V_after"]
    if V.max() > ONE_SPEED * V.min():
        return "V_after"
    return "t_hold" if (result["kind"] == "hold").all() else "step"


def _title(result, laws, shown):
    source, n = attribute_text(result, "source", ""), result.sizes["step"]
    counts = "1 step" if n == 1 else f"{n} steps and holds"
    title = f"Fits of {counts}{f' of {source}' if source else ''}, {law_names(tuple(laws))}"
    return title if shown == n else f"{title} ({shown} of them shown)"


def _step(step, laws, axes):
    """A step's record about its start under the fitted curves, and below it the residuals."""
    x, text = _abscissa(step)
    ax, below = axes
    level = float(np.nanmedian(step["friction"]))
    ax.plot(x, 1e3 * (step["friction"] - level), lw=0.4, **RECORDED)
    fitted = {law: part["friction_fit"] for law, part in laws.items() if part["status"] == FITTED}
    looks = _lines(laws)
    for law, curve in fitted.items():
        ax.plot(x, 1e3 * (curve - level), **looks[law])
        below.plot(x, 1e3 * (step["friction"] - curve), lw=0.4, color=LAWS[law].color)
    is_stick_slip = any(part["status"] == STICK_SLIP for part in laws.values())
    why = "" if fitted else " stick-slip" if is_stick_slip else " failed"
    head = f"step {int(step['step'])}: {_change_label(step)}{why}"
    ax.set_title(head, fontsize=6, pad=2, color="k" if fitted else "#c00000")
    for panel, ticks in ((ax, 4), (below, 2)):
        panel.axvline(0.0, color=GRAY, lw=0.6, ls=":", zorder=0)
        panel.tick_params(labelsize=6, pad=1.5)
        panel.xaxis.set_major_locator(MaxNLocator(4))
        panel.yaxis.set_major_locator(MaxNLocator(ticks))
        panel.margins(x=0.0)
    ax.tick_params(labelbottom=False)
    below.set_xlabel(text, fontsize=6, labelpad=0.5)


def _lines(laws):
    widths = [BELOW if len(laws) > 1 else LINE, *([LINE] * len(laws))]
    return {law: LAWS[law].line | {"lw": lw} for law, lw in zip(laws, widths, strict=False)}


def _abscissa(step):
    """Displacement since the step, or time at a hold and where none was recorded; its label."""
    is_hold = step["kind"] == "hold" or not np.isfinite(step["step_delta_lp"])
    name, origin = ("time", "step_t") if is_hold else ("delta_lp", "step_delta_lp")
    values = (step[name] - step[origin]).values
    factor, unit = prefixed(QUANTITIES[name].unit, float(np.nanmax(np.abs(values))))
    return factor * values, in_unit("Time" if is_hold else "Displacement", unit)


def _change_label(step):
    """What changes at a step, in few letters."""
    text, *_ = change_text(step).partition(",")
    text = text.replace("->", "\N{RIGHTWARDS ARROW}").replace("sigma", label("sigma"))
    return text.replace(" u", " \N{GREEK SMALL LETTER MU}")


def _legend(result, part, laws):
    """What the lines of the steps are, and the markers of a result's estimates, if it is given."""
    looks = ({"lw": LINE, **RECORDED}, *_lines(laws).values())
    handles = [Line2D([], [], **look) for look in looks]
    names = ["recorded", *(f"{law} law" for law in laws)]
    for (kind, upwards), marker in MARKERS.items():
        if result is not None and _is_kind(result, kind, upwards).any():
            handles.append(Line2D([], [], marker=marker, color="0.3", ms=3.5, ls=""))
            names.append("hold" if kind == "hold" else f"step {'up' if upwards else 'down'}")
    look = {"handlelength": 1.8, "columnspacing": 0.9, "handletextpad": 0.4, "fontsize": 7}
    part.legend(handles, names, loc="outside upper right", ncols=len(names), **look)


def _is_kind(result, kind, upwards):
    """(n,) which steps are of this kind, to a higher speed or not."""
    rises = result["V_after"] > result["V_before"] if kind == "step" else False
    return ((result["kind"] == kind) & (upwards == rises)).values


def _scale(laws, symbol):
    sizes = [np.nanmax(np.abs(part[symbol].values)) for part in laws.values()]
    return scaled(symbol, float(np.nanmax(sizes)))


def _draw_estimates(laws, symbol, along, ax):
    """An estimate of each step, with its 68 % interval, against speed or displacement."""
    factor, _ = _scale(laws, symbol)
    x = next(iter(laws.values()))[along].values
    unit = QUANTITIES[along].unit if along in QUANTITIES else "1"
    to_unit, unit = prefixed(unit, float(np.nanmax(np.abs(x))))
    for i, (law, part) in enumerate(laws.items()):
        fit = part.sel(parameter=symbol)
        shift = ScaledTranslation(i * MARKER_SHIFT, 0.0, ax.figure.dpi_scale_trans)
        value = fit[symbol].values
        low, high = np.abs(fit["interval"].isel(level=0).transpose("side", "step").values - value)
        for (kind, upwards), marker in MARKERS.items():
            at = _is_kind(fit, kind, upwards) & np.isfinite(value)
            errors = np.where(np.isfinite([low, high]), [low, high], 0.0)[:, at]
            look = {"ms": 3.5, "lw": 0.8, "color": LAWS[law].color}
            bars = ax.errorbar(
                to_unit * x[at], factor * value[at], factor * errors, fmt=marker, **look
            )
            # only now, for the limits are those of what is drawn in data coordinates
            for artist in bars.get_children():
                artist.set_transform(artist.get_transform() + shift)
    if along in ("V_after", "t_hold"):
        ax.set_xscale("log")
        plain_ticks(ax.xaxis, to_unit * x)
    ax.set_xlabel(in_unit(AXES[along], unit))
    if symbol == "a_minus_b":
        ax.axhline(0.0, color=GRAY, lw=0.6, zorder=0)
