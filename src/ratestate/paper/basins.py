"""Beyond the paper: which disturbances stable sliding (K > K_c) survives."""

import numpy as np
import xarray

from .. import Loading, continue_cycle, logspace, plot, simulate
from ..dynamics.basin import escape
from ..friction.quasi_static import runaway_step, runaway_step_lower_bound, runaway_step_upper_bound
from ..model.quantities import attrs
from ..plot.layout import figure, letters, styled
from .parameters import FIG2

# With inertia, aging law: a spring barely stiffer than K_c, between the fold and V_c.
RATIO = 1.01  # K/K_c_qs
SPEEDS = (0.74, 0.995, 24)  # V_lp/V_c: first, last, number
EXAMPLE = 0.9  # V_lp/V_c of the runs shown
EDGE_DISTANCE = 0.05  # by which their steps miss the edge of the basin
CYCLES = 500.0
# Without inertia, slip law: stiffness over K_c_qs, at a speed from which light is far.
STIFFNESS = (1.0001, 10.0, 25)
SLOW = 1e-12  # m/s


def compute(law):
    """Compute branch, edges and two runs (aging law); edges without mass (slip law)."""
    aging = FIG2.replace(law="aging", K=RATIO * FIG2.K_c_qs)
    V_c = float(aging.V_c)
    branch = continue_cycle(aging, "V_lp", 3.0 * V_c, 1e-2 * V_c)
    V_lp = xarray.DataArray(V_c * np.linspace(*SPEEDS), dims="V_lp", attrs=attrs("V_lp"))
    edge = escape(aging, V_lp.assign_coords(V_lp=V_lp))
    runs, before = _two_runs(aging, EXAMPLE * V_c)
    slip = FIG2.replace(M=0.0, K=FIG2.K_c_qs * logspace("K", *STIFFNESS).rename("ratio"))
    K = slip.K.values
    known = {symbol: getattr(FIG2, symbol) for symbol in ("a", "b", "Dc", "sigma")}
    step = attrs("step_up")
    data = xarray.Dataset(
        {
            "branch_V_lp": ("point", branch.V_lp.values, attrs("V_lp")),
            "branch_amplitude": branch.amplitude,
            "branch_stable": branch.stable,
            "branch_special": branch.special,
            "step_up": edge.step_up,
            "kick_up": edge.kick_up,
            "run_tau": runs.tau,
            "run_V_before": before.assign_attrs(attrs("V_start")),
            "threshold": ("ratio", escape(slip, SLOW).step_up.values, step),
            "threshold_lower": ("ratio", runaway_step_lower_bound(K=K, **known), step),
            "threshold_upper": ("ratio", runaway_step_upper_bound(K=K, **known), step),
            "threshold_at_K_c_qs": ((), runaway_step(a=FIG2.a, b=FIG2.b), step),
        },
        {
            "V_c": ((), V_c, attrs("V_c")),
            "ratio": ("ratio", K / FIG2.K_c_qs, {"units": "1", "long_name": "K/K_c_qs"}),
        },
        edge.attrs,
    )
    return data


def _two_runs(slider, V_lp):
    """Run steps to V_lp on either side of the edge of its basin; return also the earlier speeds."""
    edge = escape(slider, V_lp)
    side = xarray.DataArray([1.0 - EDGE_DISTANCE, 1.0 + EDGE_DISTANCE], dims="side")
    before = V_lp / (1.0 + (float(edge.step_up) - 1.0) * side)
    period = float(edge.unstable_period)
    start, times = 2.0 * period, np.linspace(-2.0, CYCLES, 12000) * period
    loading = Loading.steps(before, (start, V_lp))
    runs = simulate(slider, loading, times[-1] + start, times=times + start)
    since_step = (runs.time - start).assign_attrs(attrs("time"))
    return runs.assign_coords(time=since_step), before


@styled
def draw(data):
    """Draw coexistence, two steps on either side of the edge, and both edges."""
    fig = figure(data, 5.6, "a b Dc sigma M")
    axes = fig.subplots(2, 2).ravel()
    V_c = float(data.V_c)
    _coexistence(data, axes[0], V_c)
    _two_steps(data, axes[1], V_c)
    _draw_edge(data, axes[2], V_c)
    _threshold(data, axes[3])
    aging = rf"$K = {RATIO:g}\,K_{{c,qs}}$", f"steps to {EXAMPLE:g} $V_c$", "edge of the basin"
    letters(axes, *(f"aging law, {text}" for text in aging), "slip law without mass ($M = 0$)")
    return fig


def _coexistence(data, ax, V_c):
    V, amplitude = data.branch_V_lp / V_c, data.branch_amplitude
    stable, at_fold = data.branch_stable.astype(bool), data.branch_special == "fold"
    fold = float(V[at_fold][0])
    ax.axvspan(fold, 1.0, color="#fdf0d5", lw=0)
    for drawn, style, label in ((stable, "k", "stable cycle"), (~stable, "k--", "unstable cycle")):
        drawn = drawn | at_fold  # (there rounding tells one from the other)
        ax.plot(V.where(drawn), amplitude.where(drawn), style, lw=1.2, label=label)
    ax.plot([0.5, 1.0], [0.0, 0.0], color=plot.BLUE, lw=2.0, label="stable sliding", clip_on=False)
    ax.plot([1.0, 1.5], [0.0, 0.0], color=plot.BLUE, lw=2.0, ls=":", clip_on=False)
    ax.set(xlim=(0.5, 1.5), ylim=(0.0, 0.022), xlabel=r"$V_{lp}/V_c$", ylabel=plot.AMPLITUDE)
    ax.legend(loc="lower right")


def _two_steps(data, ax, V_c):
    sigma = plot.parameter(data, "sigma")
    for side, color, text in ((1, "0.75", "does not come back"), (0, plot.BLUE, "comes back")):
        ratio = EXAMPLE * V_c / float(data.run_V_before[side])
        stress, name = data.run_tau[side] / sigma, f"step by {ratio:.2f} {text}"
        ax.plot(data.time, stress, color=color, lw=0.6, label=name)
    ax.set(xlabel="Time after the step [s]", ylabel=plot.STRESS)
    ax.set_ylim(0.5495, 0.5765)
    ax.legend(loc="upper left")


def _draw_edge(data, ax, V_c):
    """Draw the smallest step and kick that leave the basin."""
    kick = data.kick_up / (plot.parameter(data, "a") * plot.parameter(data, "sigma"))
    look = {"color": plot.RED, "ls": "--", "lw": 1.2}
    ax.plot(data.V_lp / V_c, data.step_up, "k", lw=1.2, label=r"step, $V_{lp}/V$")
    ax.plot(data.V_lp / V_c, kick, label=r"kick, $\Delta\tau/a\sigma$", **look)
    ax.set(xlabel=r"$V_{lp}/V_c$", ylabel="Smallest that does not come back", ylim=(0.0, None))
    ax.legend()


def _threshold(data, ax):
    """Draw the step beyond which sliding without mass runs away, between its bounds."""
    bounds = {"color": "0.88", "label": "closed-form bounds"}
    exact = {"color": plot.RED, "ms": 4, "label": "$b/(b-a)$, exact"}
    ax.fill_between(data.ratio, data.threshold_lower, data.threshold_upper, **bounds)
    ax.plot(data.ratio, data.threshold, "k", lw=1.2, label="runs away beyond")
    ax.plot(1.0, data.threshold_at_K_c_qs, "o", **exact)
    ax.set(xscale="log", yscale="log", xlabel="$K/K_{c,qs}$", ylabel=r"Step $V_{lp}/V$")
    ax.legend(loc="upper left")
