"""Beyond the paper: all limit cycles of Fig. 2's slider, stable and unstable, for three springs."""

import numpy as np
import xarray

from .. import continue_cycle, plot
from ..model.quantities import attrs
from ..plot.layout import figure, letters, styled
from .parameters import FIG2

RATIOS = (1.01, 1.05, 1.5)  # K/K_c_qs
SPEEDS = (3.0, 0.3)  # V_lp/V_c: from beyond the Hopf point back to it, through a fold or not
COLORS = ("#1f4fd8", "#0b8457", "k")


def compute(law):
    """Compute the branches in V_lp along ``K`` and ``point``; shorter ones end in NaN."""
    branches = []
    for ratio in RATIOS:
        slider = FIG2.replace(law=law, K=ratio * FIG2.K_c_qs)
        branch = continue_cycle(slider, "V_lp", *(x * slider.V_c for x in SPEEDS))
        branches.append(branch.reset_coords("V_lp").assign_coords(point=branch.point))
    K = xarray.DataArray([ratio * FIG2.K_c_qs for ratio in RATIOS], dims="K", attrs=attrs("K"))
    data = xarray.concat(branches, K, join="outer", combine_attrs="override")
    data = data.drop_vars("point")
    data["special"] = data.special.fillna("").astype(str).assign_attrs(attrs("special"))
    data["V_c"] = FIG2.replace(K=data.K).V_c
    return data


@styled
def draw(data):
    """Draw bifurcation diagrams, and speeds and Floquet multiplier along all branches."""
    fig = figure(data, 5.4, "a b Dc sigma M")
    *tops, left, right = fig.subplot_mosaic("aabbcc;dddeee", height_ratios=(1.1, 1)).values()
    names = [rf"$K = {ratio:g}\,K_{{c,qs}}$" for ratio in RATIOS]
    for i, (ax, color, name) in enumerate(zip(tops, COLORS, names, strict=True)):
        branch = data.isel(K=i).dropna("point", subset=["V_lp"])
        V_c = float(data.V_c[i])
        plot.branch(branch.assign_coords(V_lp=branch.V_lp), ax, color=color)
        ax.get_legend().remove()
        ax.plot([0.6 * V_c, float(branch.V_lp.min())], [0.0, 0.0], "k", lw=1.6)
        ax.set(xscale="linear", xlim=(0.6 * V_c, 1.6 * V_c), ylim=(-0.0005, 0.021))
        ax.ticklabel_format(axis="x", style="sci", scilimits=(-3, -3))
        ax.set_xlabel("$V_{lp}$ [m/s]")
        ax.axvline(V_c, color=plot.GRAY, lw=0.6, ls=":", zorder=0)
        _draw_branch(branch, V_c, left, right, color, name)
    for ax in tops[1:]:
        ax.set(ylabel="", yticklabels=[])
    handles = [h for h in tops[0].get_legend_handles_labels()[0] if h.get_label() != "start"]
    tops[2].legend(handles=handles, loc="upper left", fontsize=6.5)
    left.set(yscale="log", ylabel=r"$V_{max}$, $V_{min}$ over $V_{lp}$", ylim=(5e-3, 50))
    right.set(ylabel="Larger Floquet multiplier", ylim=(None, 1.04))
    for ax in (left, right):
        ax.axhline(1.0, color=plot.GRAY, lw=0.7, zorder=0)
        ax.set(xlabel="$V_{lp}/V_c$", xlim=(0.6, 2.0))
    right.legend()
    letters([*tops, left, right], *names, "fastest and slowest slip", "decay factor per period")
    return fig


def _draw_branch(branch, V_c, left, right, color, label):
    """Draw extreme speeds and the larger multiplier, solid where the cycle is stable."""
    stable = branch.stable.astype(bool) | (branch.special != "")
    for part, dashes, name in ((stable, "-", label), (~stable, (0, (3, 1.5)), None)):
        shown = branch.where(part)
        for speed in (shown.V_max, shown.V_min):
            left.plot(shown.V_lp / V_c, speed / shown.V_lp, color=color, lw=1.0, ls=dashes)
        first = np.abs(shown.multipliers.isel(multiplier=0))
        right.plot(shown.V_lp / V_c, first, color=color, lw=1.0, ls=dashes, label=name)
