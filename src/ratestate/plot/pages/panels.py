"""Panels of runs and cycles: speeds against time, and the phase plane."""

import numpy as np

from ...dynamics.recipe import MANY, recorded_loading
from ...dynamics.results import normal_stress
from ...dynamics.steady_sliding import steady_stress
from ..labels import GRAY, RED, STRESS, prefixed
from ..layout import ABOVE, is_wide, show_constant

THIN = {"lw": 0.8}
NARROW = {"handlelength": 1.3, "handletextpad": 0.4}


def speed(runs, ax):
    """Slip velocities and load-point velocities of `NamedRun` against time."""
    factor, unit = prefixed("s", max(float(one.run.time.max()) for one in runs))
    scale = _speed_axis(runs, ax)
    loads = {(t.tobytes(), V.tobytes()): (t, V) for t, V in (_load(one.run) for one in runs)}
    for i, (t, load) in enumerate(loads.values()):
        name = "_" if i else "load point"
        ax.plot(factor * t, scale * load, color=GRAY, lw=1.0, ls="--", label=name)
    for run, name, line in runs:
        ax.plot(factor * run.time, scale * run.V, label=name, **{"lw": 1.0} | line)
    ax.set(xlabel=f"Time [{unit}]")
    show_constant(ax)


def _speed_axis(runs, ax):
    """An axis for the speeds, logarithmic if that pays; the factor from SI to its unit."""
    V = np.concatenate([one.run.V.values for one in runs])
    factor, unit = prefixed("m/s", float(np.nanmax(V)))
    ax.set_ylabel(f"$V$ [{unit}]")
    if is_wide(V):
        ax.set_yscale("log")
    return factor


def _load(run):
    """Times and speeds of the load point, with its jumps if they are known; NaN at rest."""
    t, V = run.time.values, run.V_load.values
    loading = recorded_loading(run)
    if loading is not None and loading.V.ndim == 1 and loading.t.size <= MANY:
        starts = loading.t - run.attrs.get("t_zero", 0.0)
        ends = np.append(starts[1:], max(t[-1], starts[-1]))
        t = np.column_stack([starts, ends]).ravel()
        V = np.column_stack([loading.V, loading.V + loading.rate * (ends - starts)]).ravel()
        last = np.searchsorted(t, run.time.values[-1], side="right")
        t, V = t[: last + 1].clip(None, run.time.values[-1]), V[: last + 1]
    return t, np.where(V > 0.0, V, np.nan)


def plane(runs, ax, *, named=False):
    """Speed against stress, with all steady states and the one at the last load-point velocity.

    named : whether the legend has the runs
    """
    scale = _speed_axis(runs, ax)
    for run, name, line in runs:
        shown = name if named else f"_{name}"
        ax.plot(run.tau / normal_stress(run), scale * run.V, label=shown, **THIN | line)
    show_constant(ax)
    low, high = ax.get_xlim()
    speeds = np.concatenate([one.run.V.values for one in runs])
    forward = speeds[speeds > 0.0]  # steady sliding is
    V = np.geomspace(forward.min(), forward.max(), 50)
    steady, crosses = {}, set()
    for run, *_ in runs:
        stress = steady_stress(run, V)
        steady[tuple(stress)] = stress
        if (last := float(run.V_load[-1])) > 0.0:
            crosses.add((float(steady_stress(run, last)), scale * last))
    for i, stress in enumerate(steady.values()):
        name = "_" if i else "steady states"
        ax.plot(stress, scale * V, color=GRAY, lw=0.9, ls="--", label=name)
    if crosses:
        x, y = np.array(sorted(crosses)).T
        cross = {"color": RED, "ms": 6, "mew": 1.3, "zorder": 5}
        ax.plot(x, y, "x", label="steady at the last $V_{lp}$", **cross)
        low, high = min(low, *x), max(high, *x)
    margin = 0.05 * (high - low)
    ax.set(xlim=(low - margin, high + margin), xlabel=STRESS)
    ax.legend(**ABOVE, ncols=1, **NARROW, borderpad=0.1)
