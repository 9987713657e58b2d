"""The page of a run: stress, friction and speed against time, and the phase plane."""

import numpy as np

from ...dynamics.attributes import loading_record
from ...dynamics.results import parameter
from ...friction.laws import mu_ss
from ..labels import BLUE, GRAY, RED, STRESS, prefixed, value_text
from ..laws import LAWS
from ..layout import figure, letter, styled
from ..runs import trace

# Ratio of speeds from which a logarithmic axis pays.
WIDE = 10.0
# Cycles of a run from which lines run together, and how many are shown on their own.
MANY, FEW = 25, 5
SLIDER = "a b Dc sigma M K"


@styled
def run_page(run):
    """Page of one slider's run."""
    law = LAWS[parameter(run, "law")]
    end = value_text("t", float(run.time[-1])).rpartition("= ")[2]
    return motion(run, f"Run of {end}, {law}")


def motion(run, title, more=""):
    """The three panels of a run, under a title and a line of parameters, and more."""
    fig = figure(run.assign_attrs(title=title), 4.4, SLIDER, more)
    cycles = int(run.cycles)
    panels = [["a", "c"], ["b", "d"]] if cycles > MANY else [["a", "c"], ["b", "c"]]
    axes = fig.subplot_mosaic(panels, width_ratios=[1.5, 1])
    axes["a"].sharex(axes["b"])
    trace(run, axes["a"])
    axes["a"].set(xlabel="")
    axes["a"].tick_params(labelbottom=False)
    axes["a"].legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1)
    _speed(run, axes["b"])
    _plane(run, axes["c"])
    texts = {"a": "stress", "b": "speed", "c": "phase plane"}
    if cycles > MANY:
        last = run.time.values[-1] - FEW / float(run.frequency)
        trace(run.isel(time=run.time.values >= last), axes["d"])
        texts["d"] = f"the last {FEW} of {cycles} cycles"
    for name, text in texts.items():
        letter(axes[name], name, text)
    return fig


def _speed(run, ax):
    """Slip velocity and load-point velocity against time, on a logarithmic axis if it pays."""
    factor, unit = prefixed("s", float(run.time.max()))
    scale, speed = prefixed("m/s", float(run.V.max()))
    t, load = _load(run)
    ax.plot(factor * t, scale * load, color=GRAY, lw=1.0, ls="--", label="load point")
    ax.plot(factor * run.time, scale * run.V, color=BLUE, lw=1.0, label="slider")
    _logarithmic(ax, run.V)
    ax.set(xlabel=f"Time [{unit}]", ylabel=f"$V$ [{speed}]")
    ax.legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1)


def _load(run):
    """Times and speeds of the load point, with its jumps where they are recorded; NaN at rest."""
    t, V = run.time.values, run.V_load.values
    record = loading_record(run)
    if "V" in record:
        starts, speeds, rates = (np.array(record[name]) for name in ("t", "V", "rate"))
        ends = np.append(starts[1:], max(t[-1], starts[-1]))
        t = np.column_stack([starts, ends]).ravel()
        V = np.column_stack([speeds, speeds + rates * (ends - starts)]).ravel()
        last = np.searchsorted(t, run.time.values[-1], side="right")
        t, V = t[: last + 1].clip(None, run.time.values[-1]), V[: last + 1]
    return t, np.where(V > 0.0, V, np.nan)


def _plane(run, ax):
    """Speed against stress, with all steady states and the one at the last load-point velocity."""
    scale, speed = prefixed("m/s", float(run.V.max()))
    a, b, mu0, V0, sigma = (parameter(run, symbol) for symbol in ("a", "b", "mu0", "V0", "sigma"))
    ax.plot(run.tau / sigma, scale * run.V, color=BLUE, lw=0.8)
    low, high = ax.get_xlim()
    V = np.geomspace(float(run.V.min()), float(run.V.max()), 50)
    steady = mu_ss(V, a=a, b=b, mu0=mu0, V0=V0)
    ax.plot(steady, scale * V, color=GRAY, lw=0.9, ls="--", label="steady states")
    if (last := float(run.V_load[-1])) > 0.0:
        point = float(mu_ss(last, a=a, b=b, mu0=mu0, V0=V0))
        ax.plot(
            point,
            scale * last,
            "x",
            color=RED,
            ms=6,
            mew=1.3,
            zorder=5,
            label="steady at the last $V_{lp}$",
        )
        low, high = min(low, point), max(high, point)
    margin = 0.05 * (high - low)
    ax.set(xlim=(low - margin, high + margin), xlabel=STRESS, ylabel=f"$V$ [{speed}]")
    _logarithmic(ax, run.V)
    place = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.1}
    ax.legend(**place, ncols=1, handlelength=1.3, handletextpad=0.4, borderpad=0.1)


def _logarithmic(ax, V):
    if float(V.max()) > WIDE * float(V.min()):
        ax.set_yscale("log")
