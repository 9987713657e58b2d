"""The figure of a sweep: lines over one axis, maps over two, or a line for each of a few values."""

import numpy as np
from matplotlib.colors import LogNorm, Normalize, SymLogNorm

from ...dynamics.results import contact_area, parameter
from ...engine.model import FINISHED, STEADY_SLIDING
from ...errors import ParameterError
from ..axis import axis_of
from ..labels import AMPLITUDE, BLUE, GRAY, LAWS, RED, fitting_unit, in_unit, label, value_text
from ..layout import (
    figure,
    is_wide,
    letters,
    mark_outside,
    plain_ticks,
    shades,
    show_constant,
    styled,
)
from .regions import divide

#: variable -> what an axis is called
WORDS = {
    "amplitude": AMPLITUDE,
    "frequency": f"Frequency {label('frequency')}",
    "V_max": f"{label('V_max')} and {label('V_min')}",
    "K_c": f"Critical stiffness {label('K_c')}",
    "growth_rate": f"Growth rate {label('growth_rate')}",
    "omega": f"Angular frequency {label('omega')}",
}
#: function -> what its sweep is called, and the variables shown
SHOWN = {
    "limit_cycle": ("Limit cycles", ("amplitude", "frequency", "V_max")),
    "simulate": ("Runs", ("amplitude", "frequency", "V_max")),
    "stability": ("Steady sliding", ("K_c", "growth_rate", "omega")),
}
# Values of an axis up to which each has a line of its own: a map would fill what is between them.
MAX_LINES = 5


@styled
def sweep_figure(result, function, dims):
    """Draw the figure of a sweep of a function of `SHOWN` over one or two dimensions."""
    cases, shown = SHOWN[function]
    if not (present := [name for name in shown if name in result]):
        raise ParameterError(
            f"the result has none of the variables that its figure shows ({', '.join(shown)})",
            "Give at least one of them.",
        )
    names = [name for name in present if set(dims) & set(result[name].dims)] or present
    dims_text = " and ".join(label(str(dim)) for dim in dims)
    title = f"{cases} over {dims_text}, {LAWS[parameter(result, 'law')].name}"
    along = max(dims, key=lambda dim: result.sizes[dim])
    across = next((dim for dim in dims if dim != along), None)
    if across is None or result.sizes[across] <= MAX_LINES:
        fig = figure(result, 2.0 + 1.5 * len(names), title=title)
        axes = fig.subplots(len(names), 1, sharex=True, squeeze=False).ravel()
        for ax, name in zip(axes, names, strict=True):
            marks = _lines(ax, result, name, along, across)
        if marks:
            fig.legend(handles=marks, loc="upper right")
        axis_of(result, along).format_axis(axes[-1].xaxis)
    else:
        fig = figure(result, 3.2, title=title)
        axes = fig.subplots(1, len(names), sharex=True, sharey=True, squeeze=False).ravel()
        for ax, name in zip(axes, names, strict=True):
            _map(fig, ax, result, name, dims)
        across, along = (axis_of(result, dim) for dim in dims)
        across.format_axis(axes[0].yaxis)
        divide(fig, axes, result, dims, along, across, _is_outside(result, dims))
    letters(axes)
    return fig


def _values(result, name, dims):
    """A variable in these dimensions, without the zeros of cases that have no cycle."""
    values = result[name].variable.set_dims({dim: result.sizes[dim] for dim in dims})
    values = values.transpose(*dims).values
    known = np.isfinite(values) & (values > 0.0 if name in ("amplitude", "frequency") else True)
    return np.where(known, values, np.nan)


def _codes(result, name, dims):
    """Codes of the cases in these dimensions; 0 of a result without them."""
    if name not in result:
        return np.zeros([result.sizes[dim] for dim in dims])
    return result[name].transpose(*dims).values


def _failed(result, dims):
    return ~np.isin(_codes(result, "status", dims), (FINISHED, STEADY_SLIDING))


def _is_outside(result, dims):
    return _codes(result, "outside_domain", dims) > 0


def _write_if_empty(ax, values):
    """Write that there is no cycle if there is nothing to show; return whether."""
    if is_empty := not np.isfinite(values).any():
        at = {"transform": ax.transAxes, "ha": "center", "va": "center"}
        ax.text(0.5, 0.5, "no cycle in any case", **at)
    return is_empty


def _lines(ax, result, name, along, across):
    """A variable against an axis, in a colour for each value of another; V_min is dashed.

    Returns the marks of cases outside the friction law's domain, a list of lines.
    """
    x = axis_of(result, along).values
    dims = [along] if across is None else [across, along]
    pair = [name, "V_min"] if name == "V_max" and "V_min" in result else [name]
    found = np.array([np.atleast_2d(_values(result, variable, dims)) for variable in pair])
    factor, unit = fitting_unit(name, found, contact_area(result))
    scaled = factor * found
    _write_if_empty(ax, scaled)
    names = [None] if across is None else axis_of(result, across).labels(across)
    colors = ["k"] if across is None else shades(len(names))
    for variable, rows, look in zip(pair, scaled, ("o-", "o--"), strict=False):
        for values, text, color in zip(rows, names, colors, strict=True):
            if text is None:
                color, text = ("k", BLUE)[variable == "V_min"], label(variable)
            elif variable == "V_min":
                text = None
            ax.plot(x, values, look, color=color, ms=2.5, lw=1.0, label=text)
    if across is not None and len(pair) > 1:
        ax.plot([], [], "--", color=GRAY, lw=1.0, label=label("V_min"))
    if name == "K_c" and np.ndim(K := parameter(result, "K")) == 0:
        of_slider = {"color": GRAY, "lw": 0.9, "ls": "--", "label": f"{label('K')} of the slider"}
        ax.axhline(factor * K, **of_slider)
    if along == "V_lp" and "V_c" in result and axis_of(result, along).names is None:
        _mark_critical(ax, np.atleast_1d(_values(result, "V_c", dims[:-1])), x, result, colors)
    if len(ax.get_legend_handles_labels()[1]) > 1:
        ax.legend()
    outside = np.broadcast_to(_is_outside(result, dims), scaled.shape)
    marks = mark_outside(ax, np.broadcast_to(x, scaled.shape), scaled, outside)
    show_constant(ax)
    if is_wide(found):
        ax.set_yscale("log")
        plain_ticks(ax.yaxis, scaled[np.isfinite(scaled)])
    elif (np.nan_to_num(scaled) < 0.0).any():
        ax.axhline(0.0, color=GRAY, lw=0.7, zorder=0)
    elif np.nanmin(scaled, initial=np.inf) < 0.5 * (top := np.nanmax(scaled, initial=0.0)):
        ax.set_ylim(0.0, 1.05 * top)
    ax.set_ylabel(in_unit(WORDS[name].replace(" of ", " of\n"), unit))
    failed = np.atleast_2d(_failed(result, dims))
    for column in np.flatnonzero(failed.all(axis=0)):
        ax.axvline(x[column], color=RED, lw=0.8, alpha=0.5, zorder=0)
    for row, column in np.argwhere(failed & ~failed.all(axis=0)):
        at = {"transform": ax.get_xaxis_transform(), "clip_on": False}
        ax.plot(x[column], 0.02 * (row + 1), "x", color=colors[row], ms=3.5, mew=0.9, **at)
    return marks


def _mark_critical(ax, speeds, x, result, colors):
    factor = float(x[0] / result["V_lp"].values[0])
    for V_c, color in zip(speeds, colors, strict=True):
        if x.min() < factor * V_c < x.max():
            look = {"color": GRAY if len(colors) == 1 else color, "lw": 0.9, "ls": ":"}
            shown = "" if ax.get_subplotspec().is_first_row() else "_"
            ax.axvline(factor * V_c, label=shown + value_text("V_c", V_c), **look)


def _map(fig, ax, result, name, dims):
    """A variable in colours; gray where a case has no answer, white where it has no cycle."""
    x_axis, y_axis = (axis_of(result, dim) for dim in reversed(dims))
    values = _values(result, name, dims)
    factor, unit = fitting_unit(name, values, contact_area(result))
    values = factor * values
    x_axis.format_axis(ax.xaxis)
    if not _write_if_empty(ax, values):
        style, ticks = _colors(values)
        colored = ax.pcolormesh(x_axis.edges, y_axis.edges, values, rasterized=True, **style)
        text = in_unit(label(name) if name == "V_max" else WORDS[name], unit)
        bar = fig.colorbar(colored, ax=ax, location="top", label=text, ticks=ticks)
        if isinstance(colored.norm, LogNorm):
            plain_ticks(bar.ax.xaxis, values[np.isfinite(values)], most=6)
    if (failed := _failed(result, dims)).any():
        gray = np.where(failed, 1.0, np.nan)
        style = {"cmap": "gray", "vmin": 0.0, "vmax": 2.0, "rasterized": True}
        ax.pcolormesh(x_axis.edges, y_axis.edges, gray, **style)
    ax.set(xlim=sorted(x_axis.edges[[0, -1]]), ylim=sorted(y_axis.edges[[0, -1]]))


def _colors(values):
    """Colour map and scale of values, and the ticks of a scale of both signs."""
    low, high = np.nanmin(values), np.nanmax(values)
    if low >= 0.0:
        scale = LogNorm if is_wide(values) else Normalize
        return {"cmap": "viridis", "norm": scale(low, high)}, None
    largest = max(high, -low)
    decade = 10.0 ** np.floor(np.log10(largest))
    norm = SymLogNorm(1e-3 * decade, vmin=-largest, vmax=largest)
    return {"cmap": "RdBu_r", "norm": norm}, [-decade, -0.01 * decade, 0.0, 0.01 * decade, decade]
