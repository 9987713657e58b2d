"""Compare runs: their names, lines, speeds against time, and the phase plane."""

from typing import Any, NamedTuple

import numpy as np
import xarray

from ..dynamics.recipe import LONGEST_COLUMN, recorded_loading
from ..dynamics.results import contact_area, normal_stress, parameter, slider_parameters
from ..dynamics.steady_sliding import steady_stress
from ..engine.model import FINISHED
from ..errors import ParameterError
from ..model.conversion import in_si
from ..model.slider_parameters import OPTIONAL
from .axis import axis_of
from .labels import GRAY, LAWS, RED, STRESS, label, prefixed, value_text
from .layout import ABOVE, is_wide, shades, show_constant

THIN = {"lw": 0.8}
NARROW = {"handlelength": 1.3, "handletextpad": 0.4}


class NamedRun(NamedTuple):
    """A run, its name for a legend, and the style of its lines."""

    run: xarray.Dataset
    name: str
    line: dict[str, Any]


def named_runs(runs):
    """list of `NamedRun`, in the order given.

    Names are the keys of a dict, values along a dimension, or what differs between the runs of a
    list.  Where laws differ, and nothing else needs a colour, lines are drawn as in `LAWS`.

    ParameterError for anything but runs of `simulate`, for none, and for more than one dimension.
    """
    if isinstance(runs, list | tuple):
        names, parts = None, [*runs]
    elif isinstance(runs, dict):
        names, parts = [str(key) for key in runs], [*runs.values()]
    else:
        names, parts = _cases_of_sweep(_checked(runs))
    if not parts:
        raise ParameterError("the list of runs is empty", "Give at least one result of simulate.")
    parts = [_with_own_time(_checked(run)) for run in parts]
    for run in parts:
        if dims := _sweep_dims(run):
            raise ParameterError(
                f"a run has the dimension {dims[0]!r}", "Pick one case with .isel."
            )
    if len(parts) == 1:
        return [NamedRun(parts[0], "", {})]
    names = [
        name if int(run.get("status", FINISHED)) == FINISHED else f"{name} (no answer)"
        for name, run in zip(names or _differences(parts), parts, strict=True)
    ]
    return [*map(NamedRun, parts, names, _styles(parts))]


def since(run, t_zero):
    """Return a run with time counted from `t_zero`, which becomes an attribute of the run.

    Times before `t_zero` become negative.

    Parameters
    ----------
    run : xarray.Dataset
        From `simulate`; anything else raises ParameterError.
    t_zero : float
        A time [s].

    Returns
    -------
    xarray.Dataset
        The run in SI, with ``time``, or ``t`` if each case has its own times, counted from
        `t_zero`.  The attribute ``t_zero`` adds up if the function is called again.
    """
    run = _checked(run)
    name = "t" if "t" in run.coords else "time"
    time = (run[name] - t_zero).assign_attrs(run[name].attrs)
    total = run.attrs.get("t_zero", 0.0) + t_zero
    return run.assign_coords({name: time}).assign_attrs(t_zero=total)


def common(runs, symbols):
    """Those of the symbols whose parameters all runs share, as a str like the argument."""
    values_of = {s: {parameter(run, s) for run in runs} for s in symbols.split()}
    return " ".join(symbol for symbol, values in values_of.items() if len(values) == 1)


def _checked(run):
    """Return the argument in SI; ParameterError if it is not a motion in time."""
    if not isinstance(run, xarray.Dataset) or not {"time", "tau", "mu"} <= {*run.sizes, *run}:
        raise ParameterError(
            "a run is not a Dataset with tau and mu along time",
            "Give a result of simulate, with its variables and attributes.",
        )
    return in_si(run)


def _sweep_dims(run):
    return [dim for dim in run.tau.dims if dim != "time"]


def _cases_of_sweep(runs):
    """Names and cases of a sweep over one dimension; the run itself if it is one."""
    dims = _sweep_dims(runs)
    if not dims:
        return [""], [runs]
    if len(dims) > 1:
        raise ParameterError(
            f"the runs have {len(dims)} dimensions ({', '.join(map(str, dims))}), but "
            "lines are drawn along one",
            "Pick values of the others with .isel.",
        )
    (dim,) = dims
    return axis_of(runs, dim).labels(dim), [runs.isel({dim: i}) for i in range(runs.sizes[dim])]


def _with_own_time(run):
    """A run out of a sweep in which each has its own times, with these as its ``time``."""
    return run.assign_coords(time=run.t.variable).drop_vars("t") if "t" in run.coords else run


def _value_name(symbol, value, run):
    if symbol in ("law", "friction_form"):
        return f"{value} {symbol}"
    return value_text(symbol, value, area=contact_area(run))


def _differences(runs):
    """What tells runs apart: law, parameters, last speed of the load point; or their numbers."""
    parts: list[list[str]] = [[] for _ in runs]
    parameters = [slider_parameters(run) for run in runs]
    shared = [symbol for symbol in parameters[0] if all(symbol in of_run for of_run in parameters)]
    shared = [symbol for symbol in shared if symbol not in ("law", *OPTIONAL)]
    for symbol in ("law", *shared, "friction_form", "damping", "alpha", "V_lp"):
        values = [
            float(run.V_load[-1]) if symbol == "V_lp" else parameter(run, symbol) for run in runs
        ]
        if len(set(values)) > 1:
            for part, value, run in zip(parts, values, runs, strict=True):
                part.append(_value_name(symbol, value, run))
    names = [", ".join(part) for part in parts]
    return names if len(set(names)) == len(names) else [f"run {i + 1}" for i in range(len(names))]


def _styles(runs):
    laws = [LAWS[parameter(run, "law")] for run in runs]
    if len(set(laws)) == len(laws):
        return [law.line for law in laws]
    dashes = [law.dashes for law in laws] if len(set(laws)) > 1 else ["-"] * len(laws)
    return [{"color": c, "ls": ls} for c, ls in zip(shades(len(runs)), dashes, strict=True)]


def speed(runs, ax):
    """Slip velocities and load-point velocities of `NamedRun` against time."""
    factor, unit = prefixed("s", max(float(named.run.time.max()) for named in runs))
    scale = _speed_axis(runs, ax)
    loads = {(t.tobytes(), V.tobytes()): (t, V) for t, V in (_load(named.run) for named in runs)}
    for i, (t, load) in enumerate(loads.values()):
        name = "_" if i else "load point"
        ax.plot(factor * t, scale * load, color=GRAY, lw=1.0, ls="--", label=name)
    for run, name, line in runs:
        ax.plot(factor * run.time, scale * run.V, label=name, **{"lw": 1.0} | line)
    ax.set(xlabel=f"Time [{unit}]")
    show_constant(ax)


def _speed_axis(runs, ax):
    """An axis for the speeds, logarithmic if that pays; the factor from SI to its unit.

    A logarithmic axis has the unit of the last load-point velocity.
    """
    V = np.concatenate([named.run.V.values for named in runs])
    typical = np.nanmax(V)
    if is_wide(V):
        ax.set_yscale("log")
        typical = max(float(named.run.V_load[-1]) for named in runs) or typical
    factor, unit = prefixed("m/s", float(typical))
    ax.set_ylabel(f"$V$ [{unit}]")
    return factor


def _load(run):
    """Times and speeds of the load point, with its jumps if they are known; NaN at rest."""
    t, V = run.time.values, run.V_load.values
    loading = recorded_loading(run)
    if loading is not None and loading.V.ndim == 1 and loading.t.size <= LONGEST_COLUMN:
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
    speeds = np.concatenate([case.run.V.values for case in runs])
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
        changes = any((run.V_load != run.V_load[-1]).any() for run, *_ in runs)
        name = f"steady at {'the last ' if changes else ''}{label('V_lp')}"
        ax.plot(x, y, "x", label=name, **cross)
        low, high = min(low, *x), max(high, *x)
    margin = 0.05 * (high - low)
    ax.set(xlim=(low - margin, high + margin), xlabel=STRESS)
    ax.legend(**ABOVE, ncols=1, **NARROW, borderpad=0.1)
