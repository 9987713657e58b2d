"""Fig. 4: limit cycles from stick-slip to quasi-harmonic oscillation."""

import numpy as np
import xarray

from .. import Loading, limit_cycle, logspace, plot, simulate, stability
from ..model.quantities import attrs
from ..plot.layout import figure, letters, styled
from .parameters import FIG4, FIG4_EXAMPLES, FIG4_K, FIG4_V_LP

PER_DECADE = 40
SHOWN = 2.5  # cycles of an example
NAMES = {"stick_slip": "stick-slip", "harmonic": "quasi-harmonic oscillation"}


def compute(law):
    """Compute limit cycles along ``K`` and ``V_lp``; two of them also as curves in time."""
    data = sweep(law, FIG4_V_LP)
    for name, V_lp in FIG4_EXAMPLES.items():
        run = example(FIG4.replace(law=law), V_lp)
        run = run.rename({n: f"{n}_{name}" for n in ("time", *run.data_vars)})
        data = data.merge(run).assign({f"V_lp_{name}": ((), V_lp, attrs("V_lp"))})
    return data


def sweep(law, between):
    """Compute limit cycles along ``K`` and ``V_lp`` between two speeds, eta, f_n and K_c_qs."""
    first, last = between
    V_lp = logspace("V_lp", first, last, round(PER_DECADE * np.log10(last / first)) + 1)
    slider = FIG4.replace(law=law, K=xarray.DataArray(FIG4_K, dims="K"))
    data = limit_cycle(slider, V_lp)
    theory = stability(slider, V_lp)
    return data.assign({name: theory[name] for name in ("eta", "f_n", "K_c_qs")})


def example(slider, V_lp):
    """Return tau and mu in the last cycles of a settled run, from time 0."""
    period = float(limit_cycle(slider, V_lp).period)
    t_end = 40.0 * period
    run = simulate(slider, Loading.constant(V_lp), t_end, V_start=0.1 * V_lp, rtol=1e-8)
    run = run[["tau", "mu"]].sel(time=slice(t_end - SHOWN * period, None))
    return run.assign_coords(time=run.time.copy(data=run.time - run.time[0]))


def steepest(run):
    """Return the run with time counted from where, in its middle half, tau falls fastest."""
    first, last = (float(run.time[i]) for i in (0, -1))
    margin = (last - first) / 4
    rate = run.tau.differentiate("time").sel(time=slice(first + margin, last - margin))
    return run.assign_coords(time=run.time - rate.time[int(np.argmin(rate.values))])


@styled
def draw(data):
    """Draw (a) amplitude and eta against V_lp, (b) stick-slip, (c) quasi-harmonic motion."""
    fig = figure(data, 6.2, "a b Dc sigma M")
    axes = fig.subplot_mosaic([["a", "a"], ["b", "c"]], height_ratios=[1.2, 1])
    for color, K in zip(("k", plot.GRAY), data.K.values, strict=True):
        share = K / float(data.K_c_qs)
        name = f"{plot.value_text('K', K, unit_of=1e9)} = {share:.2g} {plot.label('K_c_qs')}"
        plot.amplitudes(data.sel(K=K), axes["a"], color=color, label=name)
    axes["a"].set_ylim(0, 0.24)
    axes["a"].legend(loc="upper left", bbox_to_anchor=(0.2, 1.0))
    _coefficient(axes["a"].twinx(), data)
    texts = [""]
    for panel, (name, text) in zip("bc", NAMES.items(), strict=True):
        run = data[[f"tau_{name}", f"mu_{name}"]]
        run = run.rename({f"{symbol}_{name}": symbol for symbol in ("tau", "mu", "time")})
        plot.trace(run, axes[panel])
        V_lp = float(data[f"V_lp_{name}"])
        speed = plot.value_text("V_lp", V_lp, unit_of=10 * V_lp)  # 0.1 mm/s, not 100 um/s
        texts.append(f"{text}, {speed}")
        at = data.isel(K=0).sel(V_lp=V_lp, method="nearest")
        axes["a"].plot(at.V_lp, at.amplitude, "ko", ms=4)
        note = {"textcoords": "offset points", "ha": "center", "fontweight": "bold"}
        axes["a"].annotate(panel, (float(at.V_lp), float(at.amplitude)), (0, -12), **note)
        if name == "stick_slip":
            _slip_phase(axes[panel], run, 2.0 / float(data.f_n[0]))
    letters(axes.values(), *texts)
    axes["c"].legend(loc="upper right", ncols=2)
    low, high = axes["c"].get_ylim()
    axes["c"].set_ylim(low, high + 0.15 * (high - low))
    return fig


def _coefficient(ax, data):
    """Draw eta on an axis of its own, with eta = 1 marked."""
    ax.loglog(data.V_lp, data.eta, color=plot.BLUE, lw=1.2)
    V = float(np.exp(np.interp(0.0, np.log(data.eta), np.log(data.V_lp))))
    ax.plot(V, 1.0, "o", color=plot.BLUE, mfc="w", ms=5)
    ax.axvline(V, color=plot.BLUE, lw=0.7, ls=":")
    note = {"textcoords": "offset points", "ha": "right", "color": plot.BLUE}
    ax.annotate(rf"$\eta = 1$ at {1e3 * V:.1f} mm/s", (V, 1.0), (-6, 4), **note)
    ax.set(ylim=(1e-9, 1e6))
    ax.set_ylabel(r"Dynamic instability coefficient $\eta$", color=plot.BLUE)
    ax.tick_params(axis="y", colors=plot.BLUE)


def _slip_phase(ax, run, half):
    """Draw a drop of the stick-slip cycle in an inset above it."""
    low, high = ax.get_ylim()
    ticks = [tick for tick in ax.get_yticks() if low < tick < high]
    ax.set(ylim=(low, high + 0.95 * (high - low)), yticks=ticks[:: 1 + len(ticks) // 6])
    inset = ax.inset_axes((0.16, 0.66, 0.81, 0.31))
    plot.trace(steepest(run).sel(time=slice(-half, half)), inset)
    inset.set(ylabel="", xlabel="")
    at = {"transform": inset.transAxes, "ha": "right", "va": "top", "fontsize": 7.5}
    inset.text(0.97, 0.9, "slip phase,\ntime in ms", **at)
