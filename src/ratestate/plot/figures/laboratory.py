"""Evaluations of records: the figure of healing, and the figure of a machine."""

import numpy as np

from ...dynamics.recipe import attribute_text
from ...model.quantities import power_of, with_error
from ...records.healing.healing import SCATTER
from ...records.machine.machine_stiffness import estimate, value_with_unit
from ..curves import ALL_ROWS, scatter
from ..labels import BLUE, DASHED, GRAY, LAWS, RED, prefixed
from ..layout import ABOVE, figure, letters, plain_ticks, styled

#: what is drawn against hold time -> the name of its axis, its rate, and the symbol of this
PANELS = {
    "delta_mu": (r"Healing $\Delta\mu$", "beta", r"\beta"),
    "delta_mu_c": (r"Relaxation $\Delta\mu_c$", "beta_c", r"\beta_c"),
}
PER_DECADE = r"$\cdot$10$^{-3}$ per decade"
#: shade and name of a hold, by whether it is evaluated
HOLDS = {True: ("#e4ecff", "hold"), False: ("0.9", "hold, not evaluated")}
MILLI = 1e3
#: slopes and ring-downs that are drawn at most; parts of its length that are shown beside each
MAX_PANELS, PART_BEFORE, PART_AFTER = 4, 0.2, 0.5
#: rows from one to the next of one fitted curve, at most
GAP = 2
#: dimension -> what is drawn along it, and the variable whose error decides how much each weighs
DRAWN = {"slope": ("slopes", "slope_K"), "ring_down": ("ring-downs", "ring_down_omega")}


@styled
def healing_figure(result):
    holds, found = result.sizes["hold"], int((result["hold_status"] == 0).sum())
    source = attribute_text(result, "source", "")
    title = f"Healing{f' in {source}' if source else ''}: {found} of {holds} holds evaluated"
    fig = figure(result, 5.0, symbols="", title=title)
    axes = fig.subplot_mosaic([["record"] * 2, [*PANELS]], height_ratios=[1.0, 1.25])
    _record(result, axes["record"])
    for name in PANELS:
        _against_hold_time(result, name, axes[name])
    letters(axes.values())
    return fig


def _record(result, ax):
    t = result["time"].values
    factor, unit = prefixed("s", float(t[-1] - t[0]))
    at = factor * (t - t[0])
    scatter(ax, at, result["friction"].values, ALL_ROWS, "0.45", "_")
    start = factor * (result["hold_start"].values - t[0])
    durations, is_found = factor * result["t_hold"].values, result["hold_status"].values == 0
    for known, (color, name) in HOLDS.items():
        at_kind = is_found == known
        for left, width in zip(start[at_kind], durations[at_kind], strict=True):
            ax.axvspan(left, left + width, color=color, lw=0.0, zorder=0, label=name)
            name = "_"
    peaks = factor * (result["peak_time"].values - t[0])
    look = {"ls": "", "ms": 4.0, "mfc": "none", "zorder": 5}
    ax.plot(peaks, result["friction_peak"], "^", color="C3", label="peak", **look)
    ax.plot(start, result["friction_before"], "o", color="C0", label="steady before", **look)
    ax.plot(start + durations, result["friction_min"], "v", color="C2", label="end of hold", **look)
    ax.plot(at, result["friction_steady"], color="C0", lw=1.0, zorder=4)
    ax.set(xlabel=f"Time since the record's start [{unit}]", ylabel=r"Friction $\tau/\sigma$")
    ax.margins(x=0.01)
    ax.legend(ncols=5, **ABOVE)


def _against_hold_time(result, name, ax):
    """Healing or relaxation with errors, the line through them with its band, and predictions."""
    t_hold = result["t_hold"].values
    values, errors = (MILLI * result[key].values for key in (name, f"{name}_error"))
    look = {"fmt": "o", "ms": 4.0, "color": "k", "capsize": 2.0, "lw": 0.9, "zorder": 4}
    ax.errorbar(t_hold, values, errors, label="measured", **look)
    axis_name, rate, symbol = PANELS[name]
    if np.isfinite(float(result[rate])):
        line_t = result["line_t_hold"].values
        line, error = (MILLI * result[f"line_{name}{end}"].values for end in ("", "_error"))
        slope, slope_error = (MILLI * float(result[rate + end]) for end in ("", "_error"))
        text = rf"${symbol}$ = ({_typeset(with_error(slope, slope_error))}){PER_DECADE}"
        if (scatter := float(result[f"{rate}_scatter"])) > SCATTER:
            text += f"\npoints scatter by {scatter:.2g} times their errors"
        ax.plot(line_t, line, color=GRAY, ls=DASHED, lw=1.0, label=text, zorder=3)
        ax.fill_between(line_t, line - error, line + error, color=GRAY, alpha=0.3, lw=0.0)
    for law in result["law"].values.tolist() if "law" in result.dims else []:
        _predicted(result.sel(law=law), name, rate, ax, LAWS[law])
    ax.set_xscale("log")
    plain_ticks(ax.xaxis, t_hold)
    ax.set(xlabel="Hold time [s]", ylabel=f"{axis_name} [$10^{{-3}}$]")
    ax.legend(loc="best", fontsize=7)


def _predicted(part, name, rate, ax, law):
    order = np.argsort(part["t_hold"].values, kind="stable")
    t = part["t_hold"].values[order]
    keys = (f"{name}_predicted", f"{name}_predicted_error")
    values, errors = (MILLI * part[key].values[order] for key in keys)
    slope = MILLI * float(part[f"{rate}_predicted"])
    text = f"{law.name}: {slope:.3g}{PER_DECADE}"
    ax.plot(t, values, marker=".", ms=4.0, lw=1.0, label=text, **law.line)
    if np.isfinite(errors).any():
        ax.fill_between(t, values - errors, values + errors, color=law.color, alpha=0.15, lw=0.0)


@styled
def machine_figure(result):
    source = attribute_text(result, "source", "")
    title = f"Machine{f' of {source}' if source else ''}: " + ", ".join(
        estimate(result, symbol) for symbol in ("K", "M", "damping")
    )
    chosen = {name: _heaviest(result, name) for name in DRAWN if result.sizes[name]}
    note = _count_text(result, chosen)
    fig = figure(result, 0.6 + 2.3 * len(chosen), symbols="", more=note, title=_typeset(title))
    panels, texts = [], []
    parts = np.ravel(fig.subfigures(len(chosen), 1))
    for part, (name, rows) in zip(parts, chosen.items(), strict=True):
        axes = part.subplots(1, rows.size, squeeze=False)[0]
        for i, ax in zip(rows, axes, strict=True):
            _draw_panel(result, name, i, ax)
            panels.append(ax)
            texts.append(_typeset(_panel_title(result, name, i)))
        axes[0].set_ylabel(r"Friction $\tau/\sigma$")
    letters(panels, *texts)
    return fig


def _heaviest(result, name):
    """Numbers of the slopes or ring-downs that weigh most, those that are used first."""
    _, variable = DRAWN[name]
    errors = result[f"{variable}_error"].values / result[variable].values
    is_out = ~result["slope_used"].values if name == "slope" else np.zeros(errors.size, bool)
    return np.sort(np.lexsort((errors, is_out))[:MAX_PANELS])


def _count_text(result, chosen):
    """What is drawn of more slopes or ring-downs, in words."""
    parts = [
        f"{rows.size} of {result.sizes[name]} {DRAWN[name][0]}"
        for name, rows in chosen.items()
        if rows.size < result.sizes[name]
    ]
    return f"Drawn are {' and '.join(parts)}, those that weigh most" if parts else ""


def _panel_title(result, name, i):
    """What stands above a panel; stiffnesses are in the unit that fits K."""
    if name == "slope":
        kind = str(result["slope_kind"].values[i]).replace("_", " ")
        value, error = (float(result[f"slope_K{end}"].values[i]) for end in ("", "_error"))
        K = float(result["K"])
        power = power_of("Pa/m", value if K != K else K)
        used = "" if result["slope_used"].values[i] else " (not used)"
        return f"{kind}{used}\n{value_with_unit(value, error, 'Pa/m', power)}"
    hertz, error = (
        float(result[f"ring_down_omega{end}"].values[i]) / (2.0 * np.pi) for end in ("", "_error")
    )
    return f"ring-down\n{value_with_unit(hertz, error, 'Hz')}"


def _typeset(text):
    """Text with a sign for +-, and raised powers."""
    return text.replace("+-", "\N{PLUS-MINUS SIGN}").replace("^2", "$^2$")


def _draw_panel(result, name, i, ax):
    """Draw the samples about one slope or ring-down, and its curve."""
    t, fitted = result["time"].values, result[f"{name}_friction"].values
    start = float(result[f"{name}_start"].values[i])
    known = np.flatnonzero(np.isfinite(fitted) & (t >= start))
    # (the next one's level before may follow)
    known = known[: np.append(np.flatnonzero(np.diff(known) > GAP) + 1, known.size)[0]]
    duration = float(t[known[-1]] - start)
    is_shown = (t > start - PART_BEFORE * duration) & (t < start + (1.0 + PART_AFTER) * duration)
    is_drawn = is_shown & np.isfinite(fitted) & (t <= t[known[-1]])
    factor, unit = prefixed("s", duration)
    look = {"ls": "", "marker": ".", "ms": 2.0, "mew": 0.0, "color": "0.55", "rasterized": True}
    ax.plot(factor * (t[is_shown] - start), result["friction"].values[is_shown], **look)
    color = RED if name == "slope" else BLUE
    ax.plot(factor * (t[is_drawn] - start), fitted[is_drawn], color=color, lw=1.2)
    ax.axvline(0.0, color=GRAY, lw=0.7, ls=":")
    ax.set_xlabel(f"Time [{unit}]")
