"""Beyond the paper: the atlas, with the sliders of the paper's figures on it."""

import numpy as np

from .. import plot
from ..dynamics.atlas import atlas
from ..plot.labels import LAWS
from ..plot.layout import figure, letters, styled
from .figures import write
from .parameters import FIG2, FIG2_SPEEDS, FIG4, FIG4_K, FIG4_V_LP, FIG6, FIG6_SPEEDS

#: variable -> what it is, and its contours
MAPS = {
    "amplitude_over_a": (r"amplitude of $\tau/\sigma$ over $a$", (3, 10, 30, 100, 1e3, 1e4)),
    "slip_per_cycle": ("slip per cycle over $D_c$", (10, 30, 100, 300, 1e3, 1e4)),
    "V_max_over_V_lp": (r"$V_{max}/V_{lp}$", (2, 10, 100, 1e4, 1e6, 1e8, 1e10)),
}


def make(law, out, *, b_over_a=2.0, n=200, **parameters):
    """Compute, draw and `write` the atlas for one law; return the paths.

    n : points along either axis
    parameters : parameters of the law, and M, as in `ratestate.atlas`
    """
    data = atlas(b_over_a, law, n=n, **parameters)
    return write(data, draw(data), out, f"atlas_{law}")


@styled
def draw(data):
    """Draw (a) regimes, (b) close to K_c, (c-e) amplitude, slip per cycle, largest velocity."""
    title = f"Limit cycles of a spring-slider, {LAWS[data.attrs['law']].name}"
    by_eta = "eta" in data.dims  # else a law with a speed of its own
    step_text = "two decades up" if by_eta else "one decade up"
    note = (
        f"$b/a$ = {float(data.b_over_a):g}.  A machine, rig or fault is a point; "
        f"ten times its speed is {step_text}."
    )
    fig = figure(data, 8.2, "", note, title)
    axes = fig.subplot_mosaic([["main"] * 3, [*MAPS]], height_ratios=(1.75, 1))
    main = axes.pop("main")
    artists = plot.atlas(data, main)
    sliders = [_name_regimes(main)] if by_eta else []
    close_up = main.inset_axes((0.555, 0.11, 0.43, 0.42))
    artists += plot.transition(data, close_up)
    close_up.set(ylim=(1e-9, 1e2) if by_eta else main.get_ylim())
    letters([main, close_up], "regimes, and contours of $V_{max}/V_{lp}$", "close to $K_c$")
    legend = {artist.get_label(): artist for artist in [*artists, *sliders]}
    box = {"frameon": True, "framealpha": 1.0, "edgecolor": "0.7"}
    main.legend(handles=[*legend.values()], loc="lower left", fontsize=6.5, **box)
    for name, ax in axes.items():
        plot.contours(data, name, ax, MAPS[name][1])
    letters(axes.values(), *(text for text, _ in MAPS.values()), first="c")
    axes["amplitude_over_a"].set_ylabel(r"$\eta$" if by_eta else main.get_ylabel())
    return fig


def _name_regimes(ax):
    """Label the regimes and speeds, and draw the paper's sliders; return a line for a legend."""
    speed = ax.secondary_yaxis("right", functions=(np.sqrt, np.square))
    speed.set_ylabel(r"$V_{lp}$ over that at which $\eta = 1$")
    for x, y, text in (
        *((0.03, 1e-3, "stick-slip"), (6.0, 1e2, "quasi-harmonic vibration")),
        (30.0, 1e-1, "steady sliding"),
    ):
        ax.text(x, y, text, ha="center", fontsize=9, style="italic")
    return _references(ax)


def _references(ax):
    """Draw the sliders of Figs 2, 4 and 6 over their speeds; return a line for a legend."""
    for slider, K, speeds, name, shift in (
        (FIG2, FIG2.K, FIG2_SPEEDS, "Fig. 2", (5, -3)),
        (FIG4, FIG4_K[0], FIG4_V_LP, "", (0, 0)),
        (FIG4, FIG4_K[1], FIG4_V_LP, "Fig. 4", (-27, -3)),
        (FIG6, FIG6.K, FIG6_SPEEDS, "Fig. 6", (5, -3)),
    ):
        eta = np.array([slider.eta(V) for V in speeds])
        ratio = np.full(len(eta), K / slider.K_c_qs)
        (line,) = ax.plot(ratio, eta, "o-", color="k", ms=3, lw=0.9, zorder=4)
        ax.annotate(name, (ratio[0], eta[0]), shift, textcoords="offset points", fontsize=7)
    line.set_label("the paper's sliders ($b/a$ = 2; Fig. 4: 1.6)")
    return line
