"""Draw overview.png, the picture of the README: python docs/images/overview.py

A slider on a spring, and the three motions of those of Fig. 4 of Im, Marone & Elsworth (2019).
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray
from matplotlib.patches import Circle, Rectangle

import ratestate as rs
from ratestate.paper.parameters import FIG4

SOFT, STIFF = FIG4, FIG4.replace(K=1.5 * FIG4.K_c_qs)  # 0.8 and 1.5 K_c_qs
RED, BLUE, GRAY = "#d62728", "#1f4fd8", "0.45"
STYLE = {
    "font.size": 9,
    "axes.linewidth": 0.7,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "xtick.direction": "in",
    "ytick.direction": "in",
    "legend.frameon": False,
}


def main():
    with plt.rc_context(STYLE):
        fig = plt.figure(figsize=(7.6, 4.7), layout="constrained")
        top, bottom = fig.subfigures(2, 1, height_ratios=[1.3, 1], hspace=0.03)
        left, right = top.subplots(1, 2, width_ratios=[0.9, 1])
        draw_slider(left)
        draw_amplitudes(right)
        draw_motions(bottom.subplots(1, 3, sharey=True))
        fig.savefig(Path(__file__).with_suffix(".png"), dpi=200)


def draw_slider(ax):
    """The block, what presses and pulls it, and what resists."""
    ax.set(xlim=(-0.3, 10.2), ylim=(-1.9, 4.1), aspect="equal", anchor="N")
    ax.axis("off")
    ax.add_patch(Rectangle((-0.2, -0.55), 9.4, 0.55, fc="0.86", ec="none", hatch="////", lw=0))
    ax.plot([-0.2, 9.2], [0, 0], color="k", lw=1.2)
    ax.add_patch(Rectangle((0.9, 0.02), 3.0, 2.0, fc="#e8edfb", ec="k", lw=1.0))
    ax.text(2.4, 1.02, "mass $M$", ha="center", va="center")
    x = np.linspace(4.6, 7.4, 15)
    y = 1.02 + np.r_[0, 0.32 * (-1.0) ** np.arange(13), 0]
    ax.plot(np.r_[3.9, x, 8.2], np.r_[1.02, y, 1.02], color="k", lw=1.0)
    ax.add_patch(Circle((8.2, 1.02), 0.14, fc="k"))
    ax.text(6.0, 1.6, "stiffness $K$", ha="center", va="bottom")
    arrow = {"arrowstyle": "-|>", "lw": 1.3, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (10.1, 1.02), (8.4, 1.02), arrowprops=arrow | {"color": BLUE})
    ax.text(8.1, 0.6, "load point, speed $V_{lp}$", ha="center", va="top", color=BLUE)
    for x in (1.5, 2.4, 3.3):
        ax.annotate("", (x, 2.08), (x, 3.1), arrowprops=arrow | {"color": GRAY})
    ax.text(2.4, 3.2, "normal stress $\\sigma$", ha="center", va="bottom", color=GRAY)
    ax.annotate("", (0.9, -0.85), (3.9, -0.85), arrowprops=arrow | {"color": RED})
    ax.text(2.4, -1.05, "friction: $a,\\ b,\\ D_c$", ha="center", va="top", color=RED)
    ax.set_title("A slider on a spring")


def draw_amplitudes(ax):
    """Amplitude of the limit cycle against speed, for a soft and a stiff spring."""
    V_c = float(STIFF.V_c)
    speeds = np.unique(np.r_[np.geomspace(1e-5, 1.0, 61), V_c * (1 + np.geomspace(1e-5, 0.5, 20))])
    V = xarray.DataArray(speeds, dims="V_lp", coords={"V_lp": speeds})
    soft, stiff = (rs.limit_cycle(slider, V).amplitude for slider in (SOFT, STIFF))
    ax.semilogx(V, soft, color=RED, label="soft spring, $0.8\\ K_{c,qs}$")
    dashes = (0, (5, 1.6))
    ax.semilogx(V, stiff.fillna(0.0), color=BLUE, ls=dashes, label="stiff spring, $1.5\\ K_{c,qs}$")
    line = {"arrowstyle": "-", "lw": 0.7, "color": BLUE, "shrinkB": 0}
    place = {"xytext": (4.5e-3, 0.057), "ha": "center", "va": "bottom"}
    ax.annotate("critical\nvelocity $V_c$", (V_c, 0.0015), color=BLUE, arrowprops=line, **place)
    for letter, slider, speed, _ in MOTIONS:
        y = 0.0 if slider is STIFF else float(rs.limit_cycle(slider, speed).amplitude)
        ax.plot(speed, y, "o", ms=5, color="k", clip_on=False, zorder=3)
        at = (9, -4) if letter == "C" else (0, 6)
        ax.annotate(letter, (speed, y), at, textcoords="offset points", ha="center", weight="bold")
    ax.set(ylim=(0, 0.19), xlim=(1e-5, 1.0))
    ax.set_xlabel("speed of the load point $V_{lp}$ [m/s]")
    ax.set_title("How strongly it oscillates: amplitude of $\\tau/\\sigma$")
    ax.legend(loc="upper left", fontsize=8)


#: letter, slider, speed [m/s], title
MOTIONS = (
    ("A", SOFT, 1e-4, "stick-slip"),
    ("B", STIFF, 1e-3, "steady sliding"),
    ("C", SOFT, 0.5, "vibration"),
)


def draw_motions(axes):
    """Friction in each of the motions, about its mean."""
    for ax, (letter, slider, speed, title) in zip(axes, MOTIONS, strict=True):
        if slider is STIFF:
            t, tau = np.array([0.0, 7.0]), np.zeros(2)
        else:
            cycle = rs.orbit(slider, speed)
            period = float(cycle.time[-1])
            t = np.concatenate([cycle.time + i * period for i in range(3)])
            tau = np.tile(cycle.tau / slider.sigma, 3)
            tau = tau - (tau.max() + tau.min()) / 2
        scale, unit = (1.0, "s") if t[-1] > 0.1 else (1e3, "ms")
        ax.plot(t * scale, tau, color=BLUE if slider is STIFF else RED, lw=1.2)
        ax.set(xlim=(0, t[-1] * scale), xlabel=f"time [{unit}]")
        ax.set_title(f"$\\bf{{{letter}}}$  {title} at {1e3 * speed:g} mm/s")
    axes[0].set_ylabel("$\\tau/\\sigma$ about its mean")


if __name__ == "__main__":
    main()
