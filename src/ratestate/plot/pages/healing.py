"""Healing: the record with its holds, and healing and relaxation against hold time."""

import numpy as np

from ...dynamics.recipe import attribute_text
from ..curves import WHOLE, scatter
from ..labels import DASHED, GRAY, LAWS, prefixed
from ..layout import ABOVE, figure, letters, plain_ticks, styled

#: what is drawn against hold time -> the name of its axis
PANELS = {
    "delta_mu": r"Healing $\Delta\mu$",
    "delta_mu_c": r"Relaxation $\Delta\mu_c$",
}
#: rate of each, and its symbol
RATES = {"delta_mu": ("beta", r"\beta"), "delta_mu_c": ("beta_c", r"\beta_c")}
#: shade of a hold; of an evaluated one
SHADES = ("0.93", "#e4ecff")
MILLI = 1e3


@styled
def healing_page(result):
    """Page (Figure) of a result of `healing`."""
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
    """The record, its holds shaded, and the friction that is measured of each marked."""
    t = result["time"].values
    factor, unit = prefixed("s", float(t[-1] - t[0]))
    at = factor * (t - t[0])
    scatter(ax, at, result["friction"].values, WHOLE, "0.45", "_")
    start = factor * (result["hold_start"].values - t[0])
    lasts, is_found = factor * result["t_hold"].values, result["hold_status"].values == 0
    for left, width, known in zip(start, lasts, is_found, strict=True):
        ax.axvspan(left, left + width, color=SHADES[int(known)], lw=0.0, zorder=0)
    peaks = factor * (result["peak_time"].values - t[0])
    look = {"ls": "", "ms": 4.0, "mfc": "none", "zorder": 5}
    ax.plot(peaks, result["friction_peak"], "^", color="C3", label="peak", **look)
    ax.plot(start, result["friction_before"], "o", color="C0", label="steady before", **look)
    ax.plot(start + lasts, result["friction_min"], "v", color="C2", label="end of hold", **look)
    ax.plot(at, result["friction_steady"], color="C0", lw=1.0, zorder=4)
    ax.set(xlabel=f"Time since the record's start [{unit}]", ylabel=r"Friction $\tau/\sigma$")
    ax.margins(x=0.01)
    ax.legend(ncols=3, **ABOVE)


def _against_hold_time(result, name, ax):
    """Healing or relaxation with errors, the line through them with its band, and predictions."""
    t_hold = result["t_hold"].values
    values, errors = (MILLI * result[key].values for key in (name, f"{name}_error"))
    look = {"fmt": "o", "ms": 4.0, "color": "k", "capsize": 2.0, "lw": 0.9, "zorder": 4}
    ax.errorbar(t_hold, values, errors, label="measured", **look)
    rate, symbol = RATES[name]
    if np.isfinite(float(result[rate])):
        line_t = result["line_t_hold"].values
        line, error = (MILLI * result[f"line_{name}{end}"].values for end in ("", "_error"))
        slope, slope_error = (MILLI * float(result[rate + end]) for end in ("", "_error"))
        text = rf"${symbol}$ = {slope:.3g} $\pm$ {slope_error:.1g}"
        ax.plot(line_t, line, color=GRAY, ls=DASHED, lw=1.0, label=text, zorder=3)
        ax.fill_between(line_t, line - error, line + error, color=GRAY, alpha=0.3, lw=0.0)
    for law in result["law"].values.tolist() if "law" in result.dims else []:
        _predicted(result.sel(law=law), name, rate, ax, LAWS[law])
    ax.set_xscale("log")
    plain_ticks(ax.xaxis, t_hold)
    ax.set(xlabel="Hold time [s]", ylabel=f"{PANELS[name]} [$10^{{-3}}$]")
    ax.legend(loc="upper left", fontsize=7)


def _predicted(part, name, rate, ax, law):
    """What one law predicts at each hold, in order of hold time, with its error."""
    order = np.argsort(part["t_hold"].values, kind="stable")
    t = part["t_hold"].values[order]
    keys = (f"{name}_predicted", f"{name}_predicted_error")
    values, errors = (MILLI * part[key].values[order] for key in keys)
    slope = MILLI * float(part[f"{rate}_predicted"])
    ax.plot(t, values, marker=".", ms=4.0, lw=1.0, label=f"{law.name}: {slope:.3g}", **law.line)
    if np.isfinite(errors).any():
        ax.fill_between(t, values - errors, values + errors, color=law.color, alpha=0.15, lw=0.0)
