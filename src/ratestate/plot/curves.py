"""The panels of a fit: a record under its fitted curves, and what these leave of it."""

from typing import NamedTuple

import numpy as np

from ..dynamics.attributes import loading_record
from ..errors import ParameterError
from ..model.quantities import QUANTITIES
from ..records.fitting.by_law import results_by_law
from .labels import GRAY, prefixed
from .laws import COLORS, DASHES

#: samples of which all are drawn; of more, the least and the largest in as many bins
MOST = 40_000
#: standard deviations on either side within which 95 % of normal values are
NORMAL_95 = 1.96
NAMES = {"delta_lp": "Load-point displacement", "time": "Time"}
#: Loadings of more segments than these are no steps that could be marked.
MARKED = 40
#: parts of the height and width that names of speeds, and a letter of them, take
ROOM, LETTER = 0.14, 0.011


class Axis(NamedTuple):
    """The abscissa of a fit, from the record's first sample on, in a unit that fits it."""

    name: str  # "delta_lp" or "time"
    values: np.ndarray  # (m,) in that unit
    unit: str
    factor: float  # from SI
    t: np.ndarray  # (m,) [s], from the first sample on

    @property
    def text(self):
        return f"{NAMES[self.name]} since the record's start [{self.unit}]"

    @property
    def brief(self):
        return f"{NAMES[self.name]} [{self.unit}]"

    def at(self, t):
        """Where a time [s] since the first sample lies."""
        return np.interp(t, self.t, self.values)


def axis_of(result, x=None):
    """`Axis` of a result of `fit`: "delta_lp", "time", or by default what suits its loading."""
    if x is not None and x not in NAMES:
        raise ParameterError(f"x = {x!r} is unknown; choose 'delta_lp' or 'time'")
    x = x or ("time" if any(V == 0.0 for _, V in segments(result)) else "delta_lp")
    t = result["time"].values - result["time"].values[0]
    values = t if x == "time" else result["delta_lp"].values
    values = values.reshape(-1, t.size)[0]  # (all laws have the same)
    factor, unit = prefixed(QUANTITIES[x].unit, float(np.abs(values).max()))
    return Axis(x, factor * values, unit, factor, t)


def segments(result):
    """Starts [s], from the first sample on, and speeds [m/s] of the load point; none of a wave."""
    loading = loading_record(result)
    if len(loading.get("V", ())) > MARKED or any(loading.get("rate", ())):
        return []
    return list(zip(loading.get("t", ()), loading.get("V", ()), strict=True))


def curves(result, ax, axis, rows=slice(None), *, close=False):
    """Draw the record, the fitted curve of each law, and where 95 % of samples are predicted.

    Parameters
    ----------
    result : Dataset
    ax : matplotlib.axes.Axes
    axis : Axis
    rows : slice, which samples
    close : bool
        Whether single samples are to be seen.
    """
    shown = axis.values[rows]
    friction = result["friction"].values.reshape(-1, axis.t.size)[0, rows]
    _scatter(ax, shown, friction, close, "0.55", "recorded")
    ends = [friction.min(), friction.max()]
    for law, part in results_by_law(result).items():
        if "band" in part:
            low, high = part["band"].transpose("side", "time").values[:, rows]
            ax.fill_between(shown, low, high, color=COLORS[law], alpha=0.14, lw=0.0, zorder=2)
        fitted = part["friction_fit"].values[rows]
        look = {"color": COLORS[law], "lw": 1.1, "ls": DASHES[law], "zorder": 4}
        ax.plot(shown, fitted, label=f"{law} law", **look)
        ends += [fitted.min(), fitted.max()]
    margin = 0.05 * (max(ends) - min(ends))
    # a band may be wider than all there is to see
    ax.set(ylim=(min(ends) - margin, max(ends) + margin), xlim=shown[[0, -1]])
    ax.set(xlabel=axis.brief if close else axis.text, ylabel=r"Friction $\tau/\sigma$")


def residuals(part, ax, axis, law, rows=slice(None), *, close=False):
    """Draw recorded less fitted friction, and the 95 % of the noise's level."""
    level = 1e3 * NORMAL_95 * float(np.hypot(part["noise_white"], part["noise_red"]))
    left = 1e3 * part["residual"].values
    _scatter(ax, axis.values[rows], left[rows], close, COLORS[law], None)
    for height, look in ((0.0, "-"), (level, (0, (4, 3))), (-level, (0, (4, 3)))):
        ax.axhline(height, color="k", lw=0.6, ls=look, zorder=3)
    most = 1.08 * float(np.abs(left).max())
    ax.set(xlabel=axis.brief if close else axis.text, ylim=(-most, most))
    ax.set_ylabel("Residual\n" + r"[$10^{-3}$]")
    ax.set_xlim(*axis.values[rows][[0, -1]])


def marks(result, ax, axis, *, named=False):
    """Mark where the load point changes its speed; with the speeds, where there is room."""
    found = segments(result)
    for start, _ in found[1:]:
        ax.axvline(axis.at(start), color=GRAY, lw=0.7, ls=":", zorder=0)
    if not named or len(found) < 2:
        return
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + ROOM * (high - low))
    at = {"xy": (0, 0.97), "xycoords": ax.get_xaxis_transform(), "textcoords": "offset points"}
    ends = [start for start, _ in found[1:]] + [axis.t[-1]]
    for i in range(1, len(found)):
        text = change(result, i)
        left, right = axis.at(found[i][0]), axis.at(ends[i])
        if right - left > LETTER * len(text) * axis.values[-1]:
            at |= {"xy": (left, 0.97), "xytext": (3, 0), "va": "top"}
            ax.annotate(text, **at, fontsize=7, color="0.3")


def change(result, i, *, whole=False):
    """What the load point does at the start of segment i, as text; the whole tells of holds."""
    found = segments(result)
    before, V = found[i - 1][1], found[i][1]
    if V == 0.0:
        return f"hold {_duration(result, i)}"
    factor, unit = prefixed("m/s", max(before, V))
    new = f"\N{RIGHTWARDS ARROW} {factor * V:.3g} {unit}"
    if before:
        return f"{factor * before:.3g} {new}"
    return f"hold {_duration(result, i - 1)} {new}" if whole else new


def _duration(result, i):
    """How long a segment lasts, as text."""
    starts = [start for start, _ in segments(result)]
    time = result["time"].values
    end = starts[i + 1] if i + 1 < len(starts) else time[-1] - time[0]
    factor, unit = prefixed("s", end - starts[i])
    return f"{factor * (end - starts[i]):.4g} {unit}"


def _scatter(ax, x, y, close, color, label):
    """Draw noisy values: single samples where they can be told apart, else a thin line."""
    style = {"color": color, "label": label, "rasterized": True, "zorder": 1}
    if close:
        ax.plot(x, y, ".", ms=2.2, mew=0.0, **style)
    else:
        ax.plot(*_envelope(x, y), lw=0.4, alpha=0.8, **style)


def _envelope(x, y):
    """The same samples, or of many the least and the largest of each few: noise stays as wide."""
    if x.size <= MOST:
        return x, y
    each = -(-x.size // (MOST // 2))
    starts = np.arange(0, x.size, each)
    low, high = np.minimum.reduceat(y, starts), np.maximum.reduceat(y, starts)
    return np.repeat(x[starts], 2), np.column_stack([low, high]).ravel()
