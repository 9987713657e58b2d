"""A figure for each kind of result, with the quantities that matter most."""

import xarray

from ...errors import ParameterError
from ...model.conversion import in_si
from ..bifurcation import branch_figure
from ..layout import untitled
from .catalogues import events_figure
from .fits import fit_figure
from .laboratory import healing_figure, machine_figure
from .linear import response_figure, stability_figure
from .run import cycle_figure, run_figure, runs_figure
from .sweeps import MAX_LINES, sweep_figure

#: function -> figure of a single slider's result
OF_SLIDER = {
    "simulate": run_figure,
    "limit_cycle": cycle_figure,
    "stability": stability_figure,
    "frequency_response": response_figure,
    "continue_cycle": branch_figure,
}
#: function -> figure of a record's evaluation, which is never swept
OF_RECORD = {
    "fit": fit_figure,
    "events": events_figure,
    "healing": healing_figure,
    "machine_stiffness": machine_figure,
}
#: function whose figure shows no sweep -> what it shows
SINGLE = {"continue_cycle": "branch", "frequency_response": "slider's response"}
#: dimensions of results that are no axes of a sweep
OTHER_DIMS = ("time", "segment", "mode", "multiplier", "point", "frequency")


def figure(result, *, title=True):
    """Return a figure of a result, for a file or a notebook.

    Parameters
    ----------
    result : xarray.Dataset, or list or dict of these
        From `simulate`, `limit_cycle`, `orbit`, `stability`, `frequency_response`, `fit`,
        `continue_cycle`, `events`, `healing`, `machine_stiffness` or `sweep`.  One slider gives
        curves in time or along its branch.  A sweep along one axis gives lines.  A sweep along two
        axes gives maps, or lines if one axis has few values.  A part of its variables, such as
        ``result[["amplitude"]]``, gives fewer panels.

        Several runs of `simulate` are compared: a list or dict as for `plot.trace`, or a sweep
        along one axis that saved more than the ends of runs.  Several results of `events` are
        compared too, such as measured and simulated events.
    title : bool
        Whether to write a title and the parameters above the panels.

    Returns
    -------
    matplotlib.figure.Figure
        The figure, as `save` writes it.

    Raises
    ------
    ParameterError
        If the result is of another function, has lost its attributes, or has more than two axes.
    """
    fig = _figure(result)
    return fig if title else untitled(fig)


def _figure(result):
    if isinstance(result, list | tuple | dict):
        parts = result.values() if isinstance(result, dict) else result
        titles = {getattr(part, "attrs", {}).get("title") for part in parts}
        return events_figure(result) if "ratestate events" in titles else runs_figure(result)
    title = str(result.attrs.get("title", "")) if isinstance(result, xarray.Dataset) else ""
    function = title.removeprefix("ratestate ")
    if function in OF_RECORD:
        return OF_RECORD[function](in_si(result))
    if function not in OF_SLIDER:
        raise ParameterError(
            "figure() draws a Dataset that a function of ratestate returned, with its "
            "attributes, and this is not one",
            "Give such a result.",
        )
    result = in_si(result)
    axes = [dim for dim in result.sizes if dim not in OTHER_DIMS]
    if axes and function in SINGLE:
        raise ParameterError(
            f"a figure shows one {SINGLE[function]}", f"Pick one along {axes[0]!r} with .isel."
        )
    if len(axes) > 2:
        raise ParameterError(
            f"a figure shows a sweep over one or two axes, and this one has {len(axes)} "
            f"({', '.join(map(str, axes))})",
            "Pick values of the others with .sel.",
        )
    few = len(axes) == 1 and result.sizes[axes[0]] <= MAX_LINES
    if few and result.sizes.get("time", 1) > 1 and bool(result["V"].notnull().any()):
        return runs_figure(result)
    return sweep_figure(result, function, axes) if axes else OF_SLIDER[function](result)
