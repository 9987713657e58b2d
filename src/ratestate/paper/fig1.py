"""Fig. 1: friction after an e-fold velocity step of a rigidly driven slider, under both laws."""

import numpy as np
import xarray

from .. import Loading, plot, simulate
from ..plot.labels import LAWS as STYLES
from ..plot.labels import PREFIXES
from ..plot.layout import figure, styled
from .figures import LAWS
from .parameters import FIG1

MICRO = PREFIXES[-6]
BEFORE, AFTER = 2.0, 8.0  # slip shown, in Dc


def compute(_):
    """Compute friction against slip [m] since the step, along ``law`` and ``time``."""
    t_step = BEFORE * FIG1.Dc / FIG1.V0
    V = np.e * FIG1.V0
    # Both sides of the jump, then evenly spaced slip.
    after = t_step + np.linspace(0.0, AFTER, 401) * FIG1.Dc / V
    times = np.concatenate([[0.0, np.nextafter(t_step, 0.0)], after])
    loading = Loading.steps(FIG1.V0, (t_step, V))
    runs = [simulate(FIG1.replace(law=law), loading, times[-1], times=times) for law in LAWS]
    data = xarray.concat(runs, xarray.Variable("law", list(LAWS)), combine_attrs="override")
    data = data[["V", "V_load", "theta", "delta", "tau", "mu"]]
    slip = data.delta - data.delta.sel(time=t_step)
    data["slip"] = slip.assign_attrs(units="m", long_name="slip since the step")
    return data


@styled
def draw(data):
    """Draw friction against slip with a, b, a - b and Dc; the spring-slider in an inset."""
    a, b, Dc, mu0 = (plot.parameter(data, symbol) for symbol in ("a", "b", "Dc", "mu0"))
    rigid = r", $V = e\,V_0$, rigid drive ($K = \infty$, $M = 0$)"
    fig = figure(data, 3.9, "a b Dc V0", rigid)
    ax = fig.subplots()
    for law in LAWS:
        run, style = data.sel(law=law), STYLES[law]
        ax.plot(1e6 * run.slip, run.mu, **style.line, lw=1.5, label=style.name)
    low, high = -BEFORE * 1e6 * Dc, AFTER * 1e6 * Dc
    end, Dc_um = mu0 + a - b, 1e6 * Dc
    after_Dc = end + b * np.exp(-1.0)  # the slip law's; the aging law is slower in steps this large
    bottom = end - 0.45 * a
    dotted = {"color": plot.GRAY, "lw": 0.6, "ls": ":", "zorder": 0}
    ax.hlines([mu0, mu0 + a], low, high, **dotted)
    ax.vlines([0.0, Dc_um], bottom, [mu0, after_Dc], **dotted)
    _arrow(ax, (-5.0, mu0), (-5.0, mu0 + a), f"$a$ = {a:g}")
    _arrow(ax, (70.0, mu0 + a), (70.0, end), f"$b$ = {b:g}")
    _arrow(ax, (62.0, mu0), (62.0, end), f"$a - b = {a - b:g}$")
    _arrow(ax, (0.0, bottom), (Dc_um, bottom), plot.value_text("Dc", Dc))
    ax.plot(Dc_um, after_Dc, "o", ms=4, mfc="w", color="k", zorder=4)
    ax.text(Dc_um / 2, mu0 - 0.05 * a, "$b/e$ left", ha="center", va="top")
    for x, text in ((low / 2, "at $V_0$"), (40.0, "at $V = e\\,V_0$")):
        ax.text(x, mu0 + 1.12 * a, text, ha="center")
    ax.axvline(0.0, color=plot.GRAY, lw=0.6, zorder=0)
    ax.set(xlim=(low, high), ylim=(bottom - 0.2 * a, mu0 + 1.3 * a))
    ax.set(xlabel=f"Slip since the step [{MICRO}m]", ylabel=r"Friction $\mu$")
    ax.legend(loc="lower right")
    _sketch(ax.inset_axes((0.42, 0.53, 0.4, 0.28)))
    return fig


def _arrow(ax, start, end, text):
    """Draw a double arrow with its text to the left, or to the right if it is horizontal."""
    style = {"arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0, "lw": 0.9}
    ax.annotate("", start, end, arrowprops=style)
    if start[1] == end[1]:
        ax.text(end[0] + 1.5, end[1], text, va="center")
    else:
        ax.text(start[0] - 1.5, (start[1] + end[1]) / 2, text, ha="right", va="center")


def _sketch(ax):
    ax.set(xlim=(0, 10), ylim=(0, 4), aspect="equal")
    ax.axis("off")
    ax.plot([0.2, 9.8], [1, 1], "k", lw=1)
    for x in np.arange(0.4, 9.8, 0.5):
        ax.plot([x, x - 0.3], [1, 0.7], "k", lw=0.6)
    ax.fill([1, 4, 4, 1], [1, 1, 2.6, 2.6], fc="0.88", ec="k", lw=1)
    coil = np.linspace(0, 1, 9)
    height = 2.0 + 0.22 * np.array([0, 0, 1, -1, 1, -1, 1, 0, 0])
    ax.plot(4 + 3.6 * coil, height, "k", lw=1)
    ax.text(2.5, 1.8, "$M$", ha="center", va="center")
    ax.text(5.8, 2.35, "$K$", ha="center", va="bottom")
    arrow = {"arrowstyle": "-|>", "lw": 1, "color": "k", "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (9.4, 2.0), (7.6, 2.0), arrowprops=arrow)
    ax.text(8.5, 2.2, r"$\delta_{lp}$, $V_{lp}$", ha="center", va="bottom")
    ax.annotate("", (2.5, 2.6), (2.5, 3.7), arrowprops=arrow)
    ax.text(2.7, 3.2, r"$\sigma$", va="center")
    ax.annotate("", (4.9, 1.35), (4.1, 1.35), arrowprops=arrow)
    ax.text(5.0, 1.35, r"$\delta$", va="center")
    ax.annotate("", (1.0, 0.35), (4.0, 0.35), arrowprops=arrow)
    ax.text(4.2, 0.35, r"$\mu\,\sigma$", va="center")
