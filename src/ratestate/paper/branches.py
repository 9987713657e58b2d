"""Beyond the paper: all limit cycles of Fig. 2's slider, stable and unstable, for three springs."""

import numpy as np
import xarray

from .. import plot
from ..branch import continue_cycle
from ..quantities import attrs
from .layout import figure, letter, styled, titled
from .parameters import FIG2

RATIOS = (1.01, 1.1, 1.5)  # K/K_c_qs
V_LP = (0.3, 1e-5)  # m/s: from inertia-dominated vibration down to the Hopf point
COLORS = ("#1f4fd8", "#0b8457", "k")


def compute(law):
    """The branches in V_lp, dimensions ``K`` and ``point``; shorter ones end in NaN."""
    branches = []
    for ratio in RATIOS:
        slider = FIG2.replace(law=law, K=ratio * FIG2.K_c_qs)
        branch = continue_cycle(slider, "V_lp", *V_LP)
        branches.append(branch.reset_coords("V_lp").assign_coords(point=branch.point))
    K = xarray.DataArray([ratio * FIG2.K_c_qs for ratio in RATIOS], dims="K", attrs=attrs("K"))
    data = xarray.concat(branches, K, join="outer", combine_attrs="override")
    data["special"] = data.special.where(data.special.notnull(), "").astype(str)
    return titled(data, "Limit cycles of the slider of Fig. 2, stable and unstable", law)


@styled
def draw(data):
    """Amplitude, speeds and Floquet multiplier along each branch; dashes where it is unstable."""
    fig = figure(data, 6.2, "a b Dc sigma M")
    grid = fig.add_gridspec(2, 2, height_ratios=(1.25, 1))
    top, left, right = fig.add_subplot(grid[0, :]), *(fig.add_subplot(grid[1, i]) for i in (0, 1))
    for i, (ratio, color) in enumerate(zip(RATIOS, COLORS, strict=True)):
        branch = data.isel(K=i).dropna("point", subset=["V_lp"])
        plot.branch(branch, top, color=color, label=rf"$K = {ratio:g}\,K_{{c,qs}}$")
        stable = branch.stable.astype(bool).values
        for part, dashes in ((stable, "-"), (~stable, (0, (3, 1.5)))):
            shown = branch.where(xarray.DataArray(part, dims="point"))
            left.plot(shown.V_lp, shown.V_max / shown.V_lp, color=color, lw=1.0, ls=dashes)
            left.plot(shown.V_lp, shown.V_min / shown.V_lp, color=color, lw=1.0, ls=dashes)
            first = np.abs(shown.multipliers.isel(multiplier=0))
            right.plot(shown.V_lp, first, color=color, lw=1.0, ls=dashes)
    left.axhline(1.0, color=plot.GRAY, lw=0.7, zorder=0)
    right.axhline(1.0, color=plot.GRAY, lw=0.7, zorder=0)
    left.set(xscale="log", yscale="log", ylabel=r"$V_{max}$, $V_{min}$ over $V_{lp}$")
    right.set(xscale="log", ylabel="Larger Floquet multiplier")
    for ax in (left, right):
        ax.set_xlabel("Loading velocity $V_{lp}$ [m/s]")
    letter(top, "a", "solid: stable, dashed: unstable")
    letter(left, "b", "fastest and slowest slip")
    letter(right, "c", "what a period leaves of a disturbance")
    return fig
