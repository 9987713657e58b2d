"""Runs beside each other: what each is called, and the line that it is drawn with."""

from typing import Any, NamedTuple

import xarray

from ..dynamics.results import parameter, slider_parameters
from ..engine.model import FINISHED
from ..errors import ParameterError
from ..model.conversion import in_si
from ..model.slider import OPTIONAL
from .axis import axis_of
from .labels import LAWS, value_text
from .layout import shades


class NamedRun(NamedTuple):
    """A run, its name for a legend, and the style of its lines."""

    run: xarray.Dataset
    name: str
    line: dict[str, Any]


def named_runs(runs):
    """list of `NamedRun`, in the order given.

    Names are the keys of a dict, values along a dimension, or what differs between the runs of a
    list.  Where laws differ, and nothing else needs a colour, lines are those of `LAWS`.

    ParameterError for what is no run or runs of `simulate`, none, and more than one dimension.
    """
    if isinstance(runs, list | tuple):
        names, parts = None, [*runs]
    elif isinstance(runs, dict):
        names, parts = [str(key) for key in runs], [*runs.values()]
    else:
        names, parts = _along_a_dimension(_checked(runs))
    if not parts:
        raise ParameterError("there are no runs to draw", "Give at least one result of simulate.")
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
    """Return a run with its time 0 at another time; the attribute ``t_zero`` keeps that.

    Parameters
    ----------
    run : xarray.Dataset
        From `simulate`.
    t_zero : float
        A time of the run [s].

    Returns
    -------
    xarray.Dataset
        The run, with ``time`` counted from there.
    """
    time = (run.time - t_zero).assign_attrs(run.time.attrs)
    return run.assign_coords(time=time).assign_attrs(t_zero=t_zero)


def common(runs, symbols):
    """Those of the symbols whose parameters all runs share, as a str like the argument."""
    each = {s: {parameter(run, s) for run in runs} for s in symbols.split()}
    return " ".join(symbol for symbol, values in each.items() if len(values) == 1)


def _checked(run):
    """The argument in SI; ParameterError if it is no motion in time."""
    if not isinstance(run, xarray.Dataset) or not {"time", "tau", "mu"} <= {*run.sizes, *run}:
        raise ParameterError(
            "a run is not a Dataset as simulate returns it, with its attributes",
            "Give such a result.",
        )
    return in_si(run)


def _sweep_dims(run):
    return [dim for dim in run.tau.dims if dim != "time"]


def _along_a_dimension(runs):
    """Names and cases of a sweep over one dimension; the run itself if it is one."""
    dims = _sweep_dims(runs)
    if not dims:
        return [""], [runs]
    if len(dims) > 1:
        raise ParameterError(
            (
                f"the runs have {len(dims)} dimensions ({', '.join(map(str, dims))}), but "
                "lines are drawn along one"
            ),
            "Pick values of the others with .isel.",
        )
    (dim,) = dims
    return axis_of(runs, dim).each(dim), [runs.isel({dim: i}) for i in range(runs.sizes[dim])]


def _with_own_time(run):
    """A run out of a sweep in which each has its own times, with these as its ``time``."""
    return run.assign_coords(time=run.t.variable).drop_vars("t") if "t" in run.coords else run


def _named(symbol, value):
    """A parameter as a legend tells it."""
    if symbol in ("law", "friction"):
        return f"{value} {symbol}"
    return value_text(symbol, value)


def _differences(runs):
    """What tells runs apart: law, parameters, last speed of the load point; or their numbers."""
    parts: list[list[str]] = [[] for _ in runs]
    each = [slider_parameters(run) for run in runs]
    shared = [symbol for symbol in each[0] if all(symbol in one for one in each)]
    shared = [symbol for symbol in shared if symbol not in ("law", *OPTIONAL)]
    for symbol in ("law", *shared, "friction", "damping", "alpha", "V_lp"):
        values = [
            float(run.V_load[-1]) if symbol == "V_lp" else parameter(run, symbol) for run in runs
        ]
        if len(set(values)) > 1:
            for part, value in zip(parts, values, strict=True):
                part.append(_named(symbol, value))
    names = [", ".join(part) for part in parts]
    return names if len(set(names)) == len(names) else [f"run {i + 1}" for i in range(len(names))]


def _styles(runs):
    """A line for each run: of its law where all differ in it, else a shade."""
    laws = [LAWS[parameter(run, "law")] for run in runs]
    if len(set(laws)) == len(laws):
        return [law.line for law in laws]
    dashes = [law.dashes for law in laws] if len(set(laws)) > 1 else ["-"] * len(laws)
    return [{"color": c, "ls": ls} for c, ls in zip(shades(len(runs)), dashes, strict=True)]
