"""Fig. 2: velocity steps below and above the critical velocity."""

import numpy as np
import xarray

from .. import Loading, plot, simulate, stability
from ..model.quantities import attrs
from ..plot.layout import figure, letters, styled
from .parameters import FIG2, FIG2_DURATION, FIG2_SPEEDS, FIG2_START

T_STEP = 0.1  # s
COLORS = ["k", plot.RED, plot.BLUE]


def compute(law):
    """Compute the runs, along ``V_lp`` and ``time`` (0 at the step), and their K_c."""
    slider = FIG2.replace(law=law)
    V_lp = xarray.DataArray(FIG2_SPEEDS, dims="V_lp")
    # The first drop needs 0.1 ms; the oscillation of 50 Hz that follows has 40 points a cycle.
    before = np.linspace(0.0, 0.6, 6001)
    after = np.linspace(0.6, T_STEP + FIG2_DURATION, 19001)[1:]
    times = np.concatenate([before, after])
    loading = Loading.steps(FIG2_START, (T_STEP, V_lp))
    run = simulate(slider, loading, times[-1], times=times, rtol=1e-8)
    data = run[["V", "V_load", "tau", "mu", "amplitude", "frequency", "V_max", "V_min", "status"]]
    data = data.assign_coords(time=data.time.copy(data=data.time - T_STEP))
    data["K_c"] = stability(slider, data.V_lp).K_c
    data["K_c_start"] = stability(slider, FIG2_START).K_c.drop_vars("V_lp")
    data["V_start"] = ((), FIG2_START, attrs("V_start"))
    return data


@styled
def draw(data):
    """Draw (a) tau/sigma against time, a close-up and the phase plane; (b) K_c and K."""
    start = plot.value_text("V", float(data.V_start), unit_of=1e-3)
    fig = figure(data, 6.2, "a b Dc sigma M K", f", stepped from {start}")
    top, bottom = fig.subplots(2, 1, height_ratios=[3.3, 1], sharex=True)
    sigma = plot.parameter(data, "sigma")
    runs = [(data.isel(V_lp=i), color) for i, color in enumerate(COLORS)]
    for run, color in runs:
        name = plot.value_text("V_lp", float(run.V_lp), unit_of=1e-3)
        top.plot(run.time, run.tau / sigma, color=color, lw=0.9, label=name)
    top.set(xlim=(-0.05, 1.0), ylim=(0.485, 0.577), ylabel=plot.STRESS)
    top.set_yticks([0.53, 0.54, 0.55, 0.56, 0.57])
    top.legend(loc="upper right", ncols=3)
    top.tick_params(labelbottom=True)
    _draw_last_cycles(top.inset_axes((0.09, 0.11, 0.25, 0.34)), runs, sigma)
    _phases(top.inset_axes((0.43, 0.11, 0.23, 0.34)), runs, "whole 10 s", 1.0)
    inset = top.inset_axes((0.745, 0.11, 0.235, 0.34))
    _phases(inset, runs, "about the steady points", 0.5)
    V, steady = run.V_lp.item(), float(run.tau[-400:].mean()) / sigma
    half = 1.1 * float(run.amplitude)
    inset.set(xlim=(steady - half, steady + half), ylim=(1e3 * 0.7 * V, 1e3 * 1.35 * V))
    _stiffness(bottom, runs, plot.parameter(data, "K"))
    letters([top, bottom])
    return fig


def _draw_last_cycles(ax, runs, sigma):
    for run, color in runs:
        end = run.sel(time=slice(9.9, None))
        ax.plot(end.time, end.tau / sigma, color=color, lw=0.9)
    middle, half = float(end.tau.mean()) / sigma, 0.9 * float(end.amplitude)
    ax.set(xlim=(9.9, 10.0), ylim=(middle - half, middle + half))
    ax.set(xticks=[9.9, 9.95, 10.0], xlabel="Time since the step [s]", ylabel=plot.STRESS)


def _phases(ax, runs, title, alpha):
    """Draw the two steps near V_c over all 10 s, and their steady points."""
    for run, color in runs[1:]:
        plot.phase(run.sel(time=slice(0.0, None)), ax, color=color, lw=0.3, alpha=alpha)
    plot.phase(run.sel(time=slice(9.97, None)), ax, color="navy", lw=1.3)
    ax.set_title(title, fontsize=7.5, pad=3)


def _stiffness(ax, runs, K):
    for (run, color), va in zip(runs, ("bottom", "top", "bottom"), strict=True):
        steps = np.array([run.K_c_start, run.K_c_start, run.K_c, run.K_c]) / 1e6
        ax.plot([-0.1, 0, 0, 10], steps, color=color, lw=1.2)
        text = plot.value_text("K_c", float(run.K_c))
        shift = 8 if va == "bottom" else -8
        ax.text(0.99, steps[-1] + shift, text, color=color, va=va, ha="right")
    ax.plot([-0.1, 10], [K / 1e6] * 2, "k--", lw=1.0)
    ax.text(0.02, K / 1e6 - 25, plot.value_text("K", K), va="top")
    ax.set(ylim=(540, 1000), xlabel="Time since the step [s]", ylabel="$K_c$ [MPa/m]")
