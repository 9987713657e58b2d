"""
Neglecting inertia biases a, b, Dc and K
========================================

Velocity steps of a slider with mass, fitted without it. Left, each estimate divided by the true
value, with its 95 % interval, against ``eta`` at the faster speed. Fits with ``M = 0`` are biased,
and their intervals do not show it. Gray bands are the intervals of fits with the mass. They are
hardly wider than the line at 1. Right, one record with both fits. The fit without mass looks
nearly as good.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import ratestate as rs
from ratestate import plot

rng = np.random.default_rng(3)
rig = rs.SpringSlider(a=0.01, b=0.012, Dc="10 um", sigma="10 MPa", K="20 GPa/m", V0="1 mm/s")
step = rs.Loading.steps("1 mm/s", (0.1, "10 mm/s"))
t = np.concatenate([np.linspace(0.0, 0.1, 300, endpoint=False), np.linspace(0.1, 0.13, 1200)])
noise = 2e-4 * rng.normal(size=t.size)
mass_of_1 = 1.0 / rig.replace(M=1.0).eta("10 mm/s")  # kg/m^2, with which eta is 1


def fits(slider):
    """The fits of a slider's record, with its mass and without."""
    run = rs.simulate(slider, step, t[-1], times=t)
    record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    return rs.fit(record, slider), rs.fit(record, slider.replace(M=0.0))


warnings.simplefilter("ignore", rs.FitWarning)  # of fits with M = 0
fig, axes = plt.subplot_mosaic(
    [["a", "b", "record"], ["Dc", "K", "residual"]], figsize=(7.2, 3.9), width_ratios=[1, 1, 1.7]
)
names = {"a": "$a$", "b": "$b$", "Dc": "$D_c$", "K": "$K$"}
etas = np.geomspace(1e-3, 4.0, 7)
for law, color, mark in (("slip", plot.RED, "o"), ("aging", plot.BLUE, "s")):
    truth = rig.replace(law=law)
    estimates = [fits(truth.replace(M=eta * mass_of_1)) for eta in etas]
    for name in names:
        true = getattr(truth, name)
        with_M, without = (
            np.array([one.interval.sel(parameter=name, level=0.95) for one in kind]).T / true
            for kind in zip(*estimates, strict=True)
        )
        middle = np.array([float(one[name]) / true for _, one in estimates])
        axes[name].fill_between(etas, *with_M, color="0.5", alpha=0.4, lw=0)
        reach = np.abs(without - middle)
        style = {"fmt": f"{mark}-", "ms": 2.5, "lw": 0.8, "color": color, "label": f"{law} law"}
        axes[name].errorbar(etas, middle, reach, **style)
for name, symbol in names.items():
    ax = axes[name]
    ax.axhline(1.0, color="k", lw=0.6, zorder=0)
    ax.set(xscale="log", yscale="log", ylim=(0.6, 3.4), title=f"{symbol}, fitted over true")
    ax.set_yticks([0.7, 1.0, 2.0, 3.0], ["0.7", "1", "2", "3"])
    ax.yaxis.set_minor_formatter("")
    ax.set(xlabel=r"$\eta$") if name in ("Dc", "K") else ax.tick_params(labelbottom=False)
axes["a"].legend(loc="upper left")

truth = rig.replace(law="aging", M=0.15 * mass_of_1)
x = 1e4 * (t - 0.1)  # um, at 10 mm/s
shown = (x > -10) & (x < 110)
for result, color, words in zip(fits(truth), ("k", plot.RED), ("with $M$", "$M = 0$"), strict=True):
    error = 1e3 * float(result.standard_error.sel(parameter="a"))
    said = rf"{words}: $10^3\,a$ = {1e3 * float(result.a):.2f} $\pm$ {error:.2f}"
    if color == "k":
        axes["record"].plot(x[shown], result.friction[shown], ".", ms=2, mew=0, color="0.6")
    axes["record"].plot(x[shown], result.friction_fit[shown], color=color, lw=1, label=said)
    axes["residual"].plot(x[shown], 1e3 * result.residual[shown], ".", ms=3, mew=0, color=color)
axes["record"].set(ylabel=r"Friction $\tau/\sigma$", title=r"Aging law, $\eta = 0.15$, $a = 0.010$")
axes["record"].tick_params(labelbottom=False)
axes["record"].legend(loc="upper right", handlelength=1.0)
axes["residual"].set(ylabel="Residual [$10^{-3}$]", xlabel=r"Load-point displacement [$\mu$m]")
plt.show()
