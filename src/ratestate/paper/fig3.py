"""Fig. 3: stable and unstable sliding over mass and loading velocity."""

import numpy as np
from matplotlib.colors import LogNorm

from .. import Loading, limit_cycle, logspace, plot, simulate, stability
from ..model.quantities import attrs
from ..plot.layout import figure, styled
from .parameters import FIG2, FIG2_DURATION, FIG2_START, FIG3_M, FIG3_V_LP

T_STEP = 0.1  # s
# Of tau/sigma: a tenth of the smallest limit cycle here, and far above what still decays at 10 s.
UNSTABLE = 1e-4


def compute(law):
    """Compute amplitudes 10 s after the step, and of limit cycles, along ``M`` and ``V_lp``."""
    slider = FIG2.replace(law=law, M=logspace("M", *FIG3_M))
    V_lp = logspace("V_lp", *FIG3_V_LP)
    loading = Loading.steps(FIG2_START, (T_STEP, V_lp))
    run = simulate(slider, loading, t_end=T_STEP + FIG2_DURATION)
    cycle = limit_cycle(slider, V_lp)
    theory = stability(slider, V_lp)
    data = run[["amplitude", "frequency", "status"]]
    data["unstable"] = (data.amplitude > UNSTABLE).assign_attrs(
        units="1", long_name=f"oscillates at 10 s: amplitude above {UNSTABLE:g}"
    )
    converged = cycle[["amplitude", "frequency", "status"]]
    data = data.merge(converged.rename({name: f"cycle_{name}" for name in converged}))
    data["V_c"], data["stable"] = theory.V_c, theory.stable
    data["V_start"] = ((), FIG2_START, attrs("V_start"))
    return data


@styled
def draw(data):
    """Draw empty circles for stable sliding, filled ones by amplitude otherwise; V_c(M)."""
    start = plot.value_text("V", float(data.V_start), unit_of=1e-3)
    fig = figure(data, 4.7, "a b Dc sigma K", f", stepped from {start}")
    ax = fig.subplots()
    cases = data[["amplitude", "unstable"]].stack(case=["M", "V_lp"])
    unstable = cases.unstable.values.astype(bool)
    empty, filled = cases.isel(case=~unstable), cases.isel(case=unstable)
    ax.scatter(empty.M, empty.V_lp, s=18, fc="w", ec="k", lw=0.7, label="stable")
    size = 18 + 180 * np.sqrt(filled.amplitude)
    look = {"norm": LogNorm(1e-3, 1.0), "cmap": "viridis_r", "ec": "k", "lw": 0.5}
    dots = ax.scatter(filled.M, filled.V_lp, size, filled.amplitude, label="unstable", **look)
    line = data.V_c.sortby("M")
    ax.plot(line.M, line, "--", color=plot.RED, lw=1.3, zorder=0, label="$V_c(M)$, eq. 10")
    ax.set(xscale="log", yscale="log", xlabel=r"Mass per area $M$ [kg/m$^2$]")
    ax.set(ylabel="Loading velocity $V_{lp}$ [m/s]", xlim=(70, 1.4e5), ylim=(1.1e-4, 0.15))
    fig.colorbar(dots, ax=ax, label=plot.AMPLITUDE, pad=0.02)
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 0.99), ncols=3)
    return fig
