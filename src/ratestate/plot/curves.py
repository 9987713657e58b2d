"""The panels of a fit: a record under its fitted curves, and what these leave of it."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..dynamics.attributes import loading_record
from ..errors import ParameterError
from ..model.quantities import QUANTITIES
from ..records.fitting.by_law import results_by_law
from .labels import COLORS, DASHES, GRAY, prefixed

#: samples of which all are drawn; of more, the least and the largest in as many bins
MOST = 40_000
#: standard deviations on either side within which 95 % of normal values are
NORMAL_95 = 1.96
NAMES = {"delta_lp": "Load-point displacement", "time": "Time"}
#: Loadings of more segments than these are no steps that could be marked.
MARKED = 40
#: parts of the height and width that names of speeds, and a letter of them, take
ROOM, LETTER = 0.14, 0.011
#: the samples of a record that is drawn whole; of others single samples are to be seen
WHOLE = slice(None)


class Axis(NamedTuple):
    """The abscissa of a fit, from the record's first sample on, in a unit that fits it."""

    name: str  # "delta_lp" or "time"
    values: np.ndarray  # (m,) in that unit
    unit: str
    t: np.ndarray  # (m,) [s], from the first sample on

    def at(self, t):
        """Where a time [s] since the first sample lies."""
        return np.interp(t, self.t, self.values)

    def dress(self, ax, rows):
        """Give these samples' panel its label and limits."""
        since = " since the record's start" if rows == WHOLE else ""
        ax.set(xlabel=f"{NAMES[self.name]}{since} [{self.unit}]", xlim=self.values[rows][[0, -1]])


def axis_of(result, x=None):
    """`Axis` of a result of `fit`: "delta_lp", "time", or by default what suits its loading."""
    if x is not None and x not in NAMES:
        raise ParameterError(f"x = {x!r} is unknown; choose 'delta_lp' or 'time'")
    x = x or ("time" if any(V == 0.0 for _, V in _segments(result)) else "delta_lp")
    t = result["time"].values - result["time"].values[0]
    values = t if x == "time" else result["delta_lp"].values
    values = values.reshape(-1, t.size)[0]  # (all laws have the same)
    factor, unit = prefixed(QUANTITIES[x].unit, float(np.abs(values).max()))
    return Axis(x, factor * values, unit, t)


class Change(NamedTuple):
    """A change of the load point's speed; times [s] are from the record's first sample on."""

    previous: float  # start of the speed before
    start: float
    end: float
    V_before: float  # [m/s]
    V: float

    def text(self, *, whole=False):
        """What the load point does; the whole tells of holds."""
        if self.V == 0.0:
            return f"hold {_duration(self.end - self.start)}"
        factor, unit = prefixed("m/s", max(self.V_before, self.V))
        new = f"\N{RIGHTWARDS ARROW} {factor * self.V:.3g} {unit}"
        if self.V_before:
            return f"{factor * self.V_before:.3g} {new}"
        return f"hold {_duration(self.start - self.previous)} {new}" if whole else new


def changes(result):
    """List of the `Change`s of a record."""
    segments, time = _segments(result), result["time"].values
    ends = [start for start, _ in segments[2:]] + [time[-1] - time[0]]
    return [
        Change(previous, start, end, V_before, V)
        for ((previous, V_before), (start, V)), end in zip(pairwise(segments), ends, strict=False)
    ]


def _segments(result):
    """Starts [s], from the first sample on, and speeds [m/s] of the load point; none of a wave."""
    loading = loading_record(result)
    if len(loading.get("V", ())) > MARKED or any(loading.get("rate", ())):
        return []
    return list(zip(loading.get("t", ()), loading.get("V", ()), strict=True))


def _duration(t):
    """A time [s] as text."""
    factor, unit = prefixed("s", t)
    return f"{factor * t:.4g} {unit}"


def curves(result, ax, axis, rows=WHOLE):
    """Draw the record, the fitted curve of each law, and where 95 % of samples are predicted."""
    shown = axis.values[rows]
    friction = result["friction"].values.reshape(-1, axis.t.size)[0, rows]
    _scatter(ax, shown, friction, rows, "0.55", "recorded")
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
    ax.set(ylim=(min(ends) - margin, max(ends) + margin), ylabel=r"Friction $\tau/\sigma$")
    axis.dress(ax, rows)


def residuals(part, ax, axis, law, rows=WHOLE):
    """Draw recorded less fitted friction, and the 95 % of the noise's level."""
    level = float(np.hypot(part["noise_white"], part["noise_red"]))
    left = 1e3 * part["residual"].values
    _scatter(ax, axis.values[rows], left[rows], rows, COLORS[law], None)
    normal_95(ax, 1e3 * level, zorder=3)
    most = 1.08 * float(np.abs(left).max())
    ax.set(ylim=(-most, most), ylabel="Residual\n" + r"[$10^{-3}$]")
    axis.dress(ax, rows)


def normal_95(ax, level=1.0, **style):
    """Draw 0, and the lines between which 95 % of normal values with this deviation are."""
    for height, look in ((0.0, "-"), (NORMAL_95, (0, (4, 3))), (-NORMAL_95, (0, (4, 3)))):
        ax.axhline(height * level, color="k", lw=0.6, ls=look, **style)


def marks(result, ax, axis, *, named=False):
    """Mark where the load point changes its speed; with the speeds, where there is room."""
    found = changes(result)
    for change in found:
        ax.axvline(axis.at(change.start), color=GRAY, lw=0.7, ls=":", zorder=0)
    if not (named and found):
        return
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + ROOM * (high - low))
    at = {"xycoords": ax.get_xaxis_transform(), "textcoords": "offset points", "va": "top"}
    for change in found:
        text, left = change.text(), axis.at(change.start)
        if axis.at(change.end) - left > LETTER * len(text) * axis.values[-1]:
            ax.annotate(text, (left, 0.97), (3, 0), fontsize=7, color="0.3", **at)


def _scatter(ax, x, y, rows, color, label):
    """Draw noisy values: single samples where they can be told apart, else a thin line."""
    style = {"color": color, "label": label, "rasterized": True, "zorder": 1}
    if rows == WHOLE:
        ax.plot(*_envelope(x, y), lw=0.4, alpha=0.8, **style)
    else:
        ax.plot(x, y, ".", ms=2.2, mew=0.0, **style)


def _envelope(x, y):
    """The same samples, or of many the least and the largest of each few: noise stays as wide."""
    if x.size <= MOST:
        return x, y
    each = -(-x.size // (MOST // 2))
    starts = np.arange(0, x.size, each)
    low, high = np.minimum.reduceat(y, starts), np.maximum.reduceat(y, starts)
    return np.repeat(x[starts], 2), np.column_stack([low, high]).ravel()
