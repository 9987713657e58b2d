"""Boundaries on the maps of a sweep: V_c as a line, and the names of regimes."""

from typing import Any

import numpy as np
import scipy
import xarray
from contourpy import contour_generator
from matplotlib.collections import LineCollection
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import withStroke

from ...dynamics.cycles.regimes import STEADY, UNKNOWN, classify
from ...dynamics.results import parameter
from ...friction.closed_forms import K_c
from ...model.units import is_array
from ..labels import label
from ..layout import OUTSIDE

#: makes lines and text readable on any colour
HALO = [withStroke(linewidth=1.8, foreground="w")]
#: look of the cells outside the friction law's domain
HATCHED: Any = {"hatch": "/////", "fc": "none", "ec": "k", "lw": 0.0, "hatch_linewidth": 0.4}
#: codes of the path round a cell
CELL = [Path.MOVETO, *3 * [Path.LINETO], Path.CLOSEPOLY]
# Parts of a map's height that a line of text takes, and of its width that a letter takes.
HEIGHT, LETTER = 0.07, 0.027
# Points of a finer grid between two cases, along either axis.
FINER_POINTS = 8
# How to continue values linearly beyond the ends of an array.
ODD: Any = {"mode": "reflect", "reflect_type": "odd"}


def divide(fig, axes, result, dims, x_axis, y_axis, outside):
    """Draw V_c into the maps of a sweep, hatch some cases, and write what each region is.

    Regions are regimes of limit cycles, or where steady sliding is stable; runs have none.  One
    that has no room for its name has none, and axes of unordered values have no V_c.

    dims : of the result, vertical and horizontal; across, along : their `SweepAxis`
    outside : of each case, whether its motion leaves the domain of the friction law
    """
    marks, texts = [], []
    if outside.any():
        for ax in axes:
            ax.add_patch(PathPatch(_cells(x_axis, y_axis, outside), **HATCHED))
        marks, texts = [Patch(**HATCHED)], [OUTSIDE]
    lines = []
    for x, y in _critical(result, dict(zip(dims, (y_axis, x_axis), strict=True))):
        for ax in axes:
            lines += ax.plot(x, y, color="k", lw=1.1, path_effects=HALO)
    if lines:
        text = label("V_c") if "V_lp" in dims else f"{label('K')} = {label('K_c')}"
        marks, texts = [lines[0], *marks], [f"{text}: edge of stable sliding", *texts]
    if marks:
        fig.legend(marks, texts, loc="upper right")
    if "inertia" in result:
        names = classify(result).regime.transpose(*dims).values
        _separate(axes[0], x_axis, y_axis, np.where(names == STEADY, UNKNOWN, names))
        _write_names(axes[0], x_axis, y_axis, names)
    elif "stable" in result:
        stable = result["stable"].variable.set_dims({dim: result.sizes[dim] for dim in dims})
        names = np.where(stable.transpose(*dims).values, "stable", "unstable")
        _write_names(axes[0], x_axis, y_axis, names)


def _critical(result, axes):
    """Lines (x, y) on which K = K_c; axes : vertical and horizontal dimension -> `SweepAxis`."""
    if any(axis.names or axis.values.size < 2 for axis in axes.values()):
        return
    V = result.V_load.isel(time=-1) if "V_load" in result else parameter(result, "V_lp")
    values = {symbol: parameter(result, symbol) for symbol in ("a", "b", "Dc", "sigma", "M", "K")}
    finer = {symbol: _refined(value, axes) for symbol, value in values.items()}
    K = finer.pop("K")
    # K and the axes' other parameters may each vary along one dimension only
    ones = np.ones([_numbers(axis).size for axis in axes.values()])
    frame = xarray.DataArray(ones, dims=[*axes])
    ratio = (K_c(_refined(V, axes), **finer) / K * frame).transpose(*axes).values
    (y_numbers, y_axis), (x_numbers, x_axis) = ((_numbers(axis), axis) for axis in axes.values())
    lines: Any = contour_generator(x_numbers, y_numbers, np.ma.masked_invalid(ratio)).lines(1.0)
    for path in lines:
        yield _positions(x_axis, path[:, 0]), _positions(y_axis, path[:, 1])


def _numbers(axis):
    """(n,) points all over an axis, as numbers of cases, between which they may lie."""
    cases = axis.values.size
    return np.linspace(-0.5, cases - 0.5, FINER_POINTS * cases + 1)


def _interpolated(values, numbers):
    """Values (n,) of cases 0, 1 ... at other numbers, up to one beyond them, linearly."""
    return np.interp(numbers, np.arange(-1.0, len(values) + 1), np.pad(values, 1, **ODD))


def _positions(axis, numbers):
    """Where on an axis such numbers are."""
    return axis.at(_interpolated(axis.even, numbers))


def _refined(value, axes):
    """A parameter between the cases: on the scale of each of the axes along which it varies."""
    if not is_array(value):
        return value
    found = value.values
    for dim, axis in axes.items():
        if dim in value.dims:
            scale, inverse = (np.log, np.exp) if axis.logarithmic else (np.array, np.array)
            with np.errstate(divide="ignore", invalid="ignore"):
                at = value.dims.index(dim), scale(found), _numbers(axis)
                found = inverse(np.apply_along_axis(_interpolated, *at))
    return xarray.DataArray(found, dims=value.dims)


def _cells(x_axis, y_axis, cases):
    x, y = x_axis.edges, y_axis.edges
    cells = [
        Path([(x[j], y[i]), (x[j + 1], y[i]), (x[j + 1], y[i + 1]), (x[j], y[i + 1]), (0, 0)], CELL)
        for i, j in np.argwhere(cases)
    ]
    return Path.make_compound_path(*cells)


def _separate(ax, x_axis, y_axis, names):
    """Draw lines along the edges of cells of different names, but of `UNKNOWN`."""
    x, y = x_axis.edges, y_axis.edges
    known = names != UNKNOWN
    is_edge_beside = (names[:, 1:] != names[:, :-1]) & known[:, 1:] & known[:, :-1]
    is_edge_above = (names[1:] != names[:-1]) & known[1:] & known[:-1]
    lines = [[(x[j + 1], y[i]), (x[j + 1], y[i + 1])] for i, j in np.argwhere(is_edge_beside)]
    lines += [[(x[j], y[i + 1]), (x[j + 1], y[i + 1])] for i, j in np.argwhere(is_edge_above)]
    if lines:
        ax.add_collection(LineCollection(lines, colors="w", linewidths=0.9))


def _write_names(ax, x_axis, y_axis, names):
    """Write the name of each region, on a line or two, where it has most room."""
    finer = np.repeat(np.repeat(names, FINER_POINTS, axis=0), FINER_POINTS, axis=1)
    for name in np.setdiff1d(names, UNKNOWN):
        split = " " if " " in name else "-"
        texts = name, name.replace(split, split.strip() + "\n", 1)
        room, row, column, text = max(_most_room(finer == name, text) for text in texts)
        if room > 0.5:
            at = {"ha": "center", "va": "center", "fontsize": 7, "path_effects": HALO}
            ax.text(_positions(x_axis, column), _positions(y_axis, row), text, **at)


def _most_room(inside, text):
    """How far from any edge a text can be, over its size; row and column of the case; the text."""
    lines = text.split("\n")
    size = np.array([HEIGHT * len(lines), LETTER * max(map(len, lines))])
    distances = scipy.ndimage.distance_transform_edt(
        np.pad(inside, 1), sampling=1.0 / (inside.shape * size)
    )
    room = distances[1:-1, 1:-1]
    row, column = np.unravel_index(room.argmax(), room.shape)
    return room[row, column], *((np.array([row, column]) + 0.5) / FINER_POINTS - 0.5), text
