"""A page for each kind of result: what a person wants to see of it at once.

===================== ====================================================
``run``               a run and a limit cycle: stress, speed, phase plane
``stability``         K_c at all speeds, and the least stable mode
``sweep``, ``axis``   lines or maps of a sweep; scale and unit of its axes
``fit``               the function `fit`; which close-ups a page has
``cycles``, ``frame`` a fit of cycles; what pages of fits share
===================== ====================================================
"""

import xarray

from ...errors import ParameterError
from ...model.conversion import in_si
from ..bifurcation import branch_page
from .fit import fit_page
from .run import cycle_page, run_page
from .stability import stability_page
from .sweep import sweep_page

#: function -> page of a single slider's result
SINGLE = {
    "simulate": run_page,
    "limit_cycle": cycle_page,
    "stability": stability_page,
    "continue_cycle": branch_page,
    "fit": fit_page,
}
#: dimensions of results that are no axes of a sweep
OWN = ("time", "segment", "mode", "multiplier", "point")


def page(result):
    """A figure of a result, for a file or a notebook.

    Parameters
    ----------
    result : xarray.Dataset
        From `simulate`, `limit_cycle`, `stability`, `continue_cycle`, `fit` or `sweep`: of one
        slider, or over one axis (lines) or two (maps; lines too where one of them has a few
        values only).

    Returns
    -------
    matplotlib.figure.Figure
        The page, as `save` writes it.

    Raises
    ------
    ParameterError
        No such result, or one that has lost its attributes; more than two axes.
    """
    title = str(result.attrs.get("title", "")) if isinstance(result, xarray.Dataset) else ""
    function = title.removeprefix("ratestate ")
    if function not in SINGLE:
        raise ParameterError(
            "page wants a Dataset as a function of ratestate gives it, with its attributes"
        )
    result = in_si(result)
    axes = [] if function == "fit" else [dim for dim in result.sizes if dim not in OWN]
    if axes and function == "continue_cycle":
        raise ParameterError(f"a page shows one branch; pick one along {axes[0]!r} with .isel")
    if len(axes) > 2:
        raise ParameterError(
            f"a page shows a sweep over one or two axes, and this one has {len(axes)} "
            f"({', '.join(map(str, axes))}); pick values of the others with .sel"
        )
    return sweep_page(result, function, axes) if axes else SINGLE[function](result)
