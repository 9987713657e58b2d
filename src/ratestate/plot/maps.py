"""The atlas as maps: regimes, close-up of the transition, contours."""

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm
from matplotlib.patches import Patch

from ..dynamics.cycles.regimes import REGIMES
from ..errors import ParameterError
from .labels import RED, label

#: colours of the regimes, in the order of `REGIMES`
COLORS = ("w", "#9fd3b6", "#f7dcae", "#bdcdf0", "0.6")
STEADY = REGIMES.index("steady")
RATIO = rf"Stiffness $K$/{label('K_c_qs')}"
ETA = r"$\eta = M V_{lp}^2/(\sigma a D_c)$"
# Distance from K_c below which the close-up is linear in it.
LINEAR = 1e-4


def atlas(data, ax):
    """Draw regimes against K/K_c_qs and eta or V_lp, the curve K_c, and contours of V_max/V_lp.

    Parameters
    ----------
    data : xarray.Dataset
        From `ratestate.atlas`; anything else raises ParameterError.
    ax : matplotlib.axes.Axes
        Axes to draw into.

    Returns
    -------
    list of matplotlib.artist.Artist
        Entries of a legend: the regimes that occur, without steady sliding, which is blank, and the
        curve K_c for each type of the Hopf bifurcation that occurs.
    """
    _check(data, "regime", "K_over_K_c_qs")
    x, rows, _ = _contours(data, "V_max_over_V_lp", ax, 10.0 ** np.arange(1, 12), "0.35")
    ax.set_ylabel(ETA if rows.name == "eta" else label(rows.name))
    patches = _paint(ax, x, rows, data.regime)
    return [*patches, *_hopf_curve(ax, data.K_c_over_K_c_qs.values, data)]


def transition(data, ax):
    """Draw the regimes close to K_c, and the range in which a cycle coexists with steady sliding.

    Parameters
    ----------
    data : xarray.Dataset
        From `ratestate.atlas` with ``transition=True``; anything else raises ParameterError.
    ax : matplotlib.axes.Axes
        Axes to draw into.

    Returns
    -------
    list of matplotlib.artist.Artist
        Entries of a legend, one of each kind that was drawn.
    """
    _check(data, "regime_close", "K_over_K_c")
    ax.set_xscale("symlog", linthresh=LINEAR, linscale=0.4)
    ax.set(yscale="log", xlim=(float(data.K_over_K_c[0]) - 1.0, 0.1))
    ax.set_xticks([-0.1, -1e-3, 0.0, 1e-3, 1e-2])
    rows = _rows(data)
    ax.set(xlabel=f"$K$/{label('K_c')} $-$ 1", ylabel=label(rows.name))
    patches = _paint(ax, data.K_over_K_c - 1.0, rows, data.regime_close)
    width = (data.K_fold_over_K_c_qs / data.K_c_over_K_c_qs - 1.0).values
    strip = {"fc": "w", "ec": RED, "hatch": "////", "lw": 0.0, "where": width > 0}
    name = "cycle and steady sliding both stable"
    strip_area = ax.fill_betweenx(rows, 0.0, width, label=name, **strip)
    curve = _hopf_curve(ax, np.zeros(rows.size), data)
    return [*patches, *([strip_area] if (width > 0).any() else []), *curve]


def contours(data, name, ax, levels):
    """Draw a variable of the atlas in colours on a logarithmic scale, with contours.

    Parameters
    ----------
    data : xarray.Dataset
        From `ratestate.atlas`; anything else raises ParameterError.
    name : str
        Name of a variable along ``K_over_K_c_qs``, such as "slip_per_cycle"; any other raises
        ParameterError.  Cases of steady sliding stay blank.
    ax : matplotlib.axes.Axes
        Axes to draw into.
    levels : sequence of float
        Values of the contours, > 0 and increasing, two or more; else ParameterError.  The colours
        go from the first to the last.
    """
    _check(data, name, "K_over_K_c_qs")
    values = np.array(levels, float)
    if values.ndim != 1 or values.size < 2 or not (np.diff(values, prepend=0.0) > 0.0).all():
        wanted = "Give two values > 0 or more in increasing order, such as [1, 10]."
        raise ParameterError("cannot be contours", wanted, symbol="levels", value=repr(levels))
    x, rows, values = _contours(data, name, ax, levels, "w")
    style = {"cmap": "viridis", "shading": "nearest", "rasterized": True, "zorder": 0}
    ax.pcolormesh(x, rows, values, norm=LogNorm(levels[0], levels[-1]), **style)
    ax.plot(data.K_c_over_K_c_qs, rows, "k", lw=1.0)


def _check(data, name, dim):
    """Raise ParameterError unless a result of `atlas` has this variable along this dimension."""
    if name not in getattr(data, "data_vars", ()) or dim not in data[name].dims:
        how = " with transition=True" if dim == "K_over_K_c" else ""
        raise ParameterError(
            f"the result has no variable {name} along {dim}",
            f"Give a result of ratestate.atlas{how}.",
        )


def _rows(data):
    """The coordinate of the rows: eta, or V_lp for a law with a speed of its own."""
    return data[data.regime.dims[0]]


def _contours(data, name, ax, levels, color):
    """Draw labelled contours of a variable over the whole of the atlas; x, rows, and its values."""
    x, rows, values = data.K_over_K_c_qs, _rows(data), data[name].where(data.regime != STEADY)
    ax.set(xscale="log", yscale="log", xlabel=RATIO)
    ax.set(xlim=x.values[[0, -1]], ylim=rows.values[[0, -1]])  # labels need them beforehand
    lines = ax.contour(x, rows, values, levels=levels, colors=color, linewidths=0.5)
    places = [_middle(ax, path.vertices) for path in lines.get_paths() if len(path.vertices)]
    ax.clabel(lines, fmt=_round, fontsize=6.5, inline_spacing=2, manual=places)
    return x, rows, values


def _middle(ax, points):
    """The one of these points (n, 2) of a line that is nearest to half its length on paper."""
    placed = (ax.transScale + ax.transLimits).transform(points)
    lengths = np.append(0.0, np.cumsum(np.hypot(*np.diff(placed, axis=0).T)))
    return tuple(points[np.abs(lengths - 0.5 * lengths[-1]).argmin()])


def _round(value):
    """A value of one digit as text, in powers of ten if it is large."""
    power = round(np.log10(value))
    return f"{value:g}" if value < 1e3 else f"$10^{{{power}}}$"


def _paint(ax, x, rows, regimes):
    """Colour a map of regimes; for a legend, those that occur."""
    norm = BoundaryNorm(np.arange(-0.5, len(REGIMES)), len(REGIMES))
    style = {"shading": "nearest", "rasterized": True, "zorder": 0}
    ax.pcolormesh(x, rows, regimes, cmap=ListedColormap(COLORS), norm=norm, **style)
    codes = np.setdiff1d(regimes, STEADY)
    return [Patch(fc=COLORS[code], ec="0.5", lw=0.5, label=REGIMES[code]) for code in codes]


def _hopf_curve(ax, x, data):
    """Draw K_c at abscissae x by type of the bifurcation; the lines drawn."""
    lines = []
    kinds = (("supercritical", "softly", "k"), ("subcritical", "with a jump", RED))
    for kind, onset, color in kinds:
        is_kind = data.type.values == kind
        if is_kind.any():
            style = {"color": color, "lw": 1.6, "label": f"{label('K_c')}: {onset} ({kind})"}
            lines += ax.plot(np.where(is_kind, x, np.nan), _rows(data), zorder=3, **style)
    return lines
