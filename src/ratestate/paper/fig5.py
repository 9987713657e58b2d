"""Fig. 5: amplitude of limit cycles against their frequency, and the natural frequency."""

from .. import plot
from ..plot.layout import figure, styled
from .fig4 import sweep
from .parameters import FIG4_V_LP, FIG5_V_LP


def compute(law):
    """Compute the limit cycles of Fig. 4 and ten times faster ones."""
    return sweep(law, FIG5_V_LP)


@styled
def draw(data):
    """Draw amplitude against frequency and f_n; the inset adds the larger loading rates."""
    first, last = plot.value_text("V_lp", float(data.V_lp[0])), float(data.V_lp[-1])
    speeds = f", {first} to {FIG4_V_LP[1]:g} m/s, inset to {last:g} m/s"
    fig = figure(data, 4.2, "a b Dc sigma M", speeds)
    ax = fig.subplots()
    inset = ax.inset_axes((0.3, 0.47, 0.42, 0.5))
    slow = data.sel(V_lp=slice(None, FIG4_V_LP[1] * (1 + 1e-9)))
    for color, K in zip(("k", plot.GRAY), data.K.values, strict=True):
        name = plot.value_text("K", K, unit_of=1e9)
        plot.amplitudes(slow.sel(K=K), ax, "frequency", color=color, label=name)
        plot.amplitudes(data.sel(K=K), inset, "frequency", color=color)
        end = slow.sel(K=K).isel(V_lp=-1)
        inset.plot(end.frequency, end.amplitude, "o", ms=4, mfc="w", color=color)
        f_n = float(data.f_n.sel(K=K))
        for axes in (ax, inset):
            axes.axvline(f_n, color=plot.RED, lw=0.8, zorder=0)
        text = {"color": plot.RED, "rotation": 90, "va": "top"}
        inset.text(f_n + 2, 1.5, f"$f_n$ = {f_n:.0f} Hz", **text)
        note = {"textcoords": "offset points", "xytext": (-5, 0), "ha": "right"}
        inset.annotate("1 m/s", (end.frequency.item(), end.amplitude.item()), color=color, **note)
    ax.text(530, 0.19, "$f_n$", color=plot.RED, va="top")
    ax.set(ylim=(0, 0.2), xlim=(0.01, 1000))
    ax.legend(loc="lower left")
    inset.set(xscale="linear", yscale="log", xlim=(250, 530), ylim=(0.012, 2))
    return fig
