"""The panels of a fit: a record with its fitted curves, and the residuals."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..dynamics.recipe import recorded_loading
from ..errors import ParameterError
from ..model.names import one_of
from ..model.quantities import QUANTITIES
from ..records.fitting.by_law import results_by_law
from .labels import ABSCISSAE, GRAY, LAWS, prefixed, with_unit

#: samples of which all are drawn; of more, the least and the largest in as many bins
MAX_SAMPLES = 40_000
#: standard deviations on either side within which 95 % of normal values are
NORMAL_95 = 1.96
#: Loadings of more segments than these are no steps that could be marked.
MARKED = 40
#: parts of the height and width that names of speeds, and a letter of them, take
ROOM, LETTER = 0.14, 0.011
#: origin of the abscissa of a whole record
SINCE_START = " since the record's start"
#: the samples of a record that is drawn whole; of others single samples are to be seen
ALL_ROWS = slice(None)


class Change(NamedTuple):
    """A change of the load point's speed; times [s] are from the record's first sample on."""

    previous: float  # start of the speed before
    start: float
    end: float
    V_before: float  # [m/s]
    V: float

    def text(self, *, with_duration=False):
        """What the load point does: "hold 100 s", or both speeds with an arrow between them.

        After a hold only the new one; `with_duration` puts the hold before it.
        """
        if self.V == 0.0:
            return f"hold {with_unit('t', self.end - self.start)}"
        factor, unit = prefixed("m/s", max(self.V_before, self.V))
        new = f"\N{RIGHTWARDS ARROW} {factor * self.V:.3g} {unit}"
        if self.V_before:
            return f"{factor * self.V_before:.3g} {new}"
        return f"hold {with_unit('t', self.start - self.previous)} {new}" if with_duration else new


class FittedRecord(NamedTuple):
    """A fitted record against time or displacement, in a unit that fits it."""

    x: str  # "delta_lp" or "time"
    values: np.ndarray  # (m,) of it, from the first sample on, in that unit
    unit: str
    t: np.ndarray  # (m,) [s], from the first sample on
    friction: np.ndarray  # (m,)
    changes: list[Change]
    laws: dict  # law -> its part of the result

    def at(self, t):
        """Abscissa, in `unit`, of times [s] since the first sample; the ends beyond them."""
        return np.interp(t, self.t, self.values)

    def format_panel(self, ax, rows):
        """Give these samples' panel its label and limits."""
        origin_text = SINCE_START if rows == ALL_ROWS else ""
        ax.set(xlabel=f"{ABSCISSAE[self.x]}{origin_text} [{self.unit}]")
        ax.set(xlim=self.values[rows][[0, -1]])


def record_of(result, x=None):
    """`FittedRecord` of a result of `fit` (not checked) against x; ParameterError for another x.

    By default displacement, but time where the load point rests, and of cycles, of which nothing
    else is kept.  Under a wave, or more than `MARKED` segments, there are no `changes`, and it is
    displacement.
    """
    of_time = "delta_lp" not in result  # a fit of cycles
    known = ["time"] if of_time else [*ABSCISSAE]
    if x is not None and x not in known:
        raise ParameterError("is unknown", one_of(known, x), symbol="x", value=repr(x))
    laws = results_by_law(result)
    part = next(iter(laws.values()))  # (all have the same record)
    segments = _segments(part)
    x = x or ("time" if of_time or any(V == 0.0 for _, V in segments) else "delta_lp")
    t = part["time"].values - part["time"].values[0]
    values = t if x == "time" else part["delta_lp"].values
    factor, unit = prefixed(QUANTITIES[x].unit, float(np.abs(values).max()))
    ends = [start for start, _ in segments[2:]] + [t[-1]]
    changes = [
        Change(previous, start, end, V_before, V)
        for ((previous, V_before), (start, V)), end in zip(pairwise(segments), ends, strict=False)
    ]
    return FittedRecord(x, factor * values, unit, t, part["friction"].values, changes, laws)


def _segments(result):
    """Starts [s], from the first sample on, and speeds [m/s] of the load point.

    None of a wave, nor of a fit of an earlier version.
    """
    loading = recorded_loading(result)
    if loading is None or loading.t.size > MARKED or loading.rate.any():
        return []
    return list(zip(loading.t.tolist(), loading.V.tolist(), strict=True))


def curves(record, ax, rows=ALL_ROWS):
    """Draw the record, the fitted curve of each law, and the band that 95 % of samples are in.

    Only the law with the smallest residuals has a band: a wider one would fill the panel.
    """
    shown, friction = record.values[rows], record.friction[rows]
    with_band = law_with_band(record.laws)
    scatter(ax, shown, friction, rows, "0.55", "recorded")
    ends = [friction.min(), friction.max()]
    for law, part in record.laws.items():
        if law == with_band:
            low, high = part["band"].transpose("side", "time").values[:, rows]
            ax.fill_between(shown, low, high, color=LAWS[law].color, alpha=0.14, lw=0.0, zorder=2)
        fitted = part["friction_fit"].values[rows]
        look = {"lw": 1.1, "zorder": 4} | LAWS[law].line
        ax.plot(shown, fitted, label=f"{law} law", **look)
        ends += [fitted.min(), fitted.max()]
    margin = 0.05 * (max(ends) - min(ends))
    # a band may be wider than all there is to see
    ax.set(ylim=(min(ends) - margin, max(ends) + margin), ylabel=r"Friction $\tau/\sigma$")
    record.format_panel(ax, rows)


def law_with_band(laws):
    """Return the law with the smallest residuals; None if the result has no bands."""
    known = [law for law, part in laws.items() if "band" in part]
    return min(known, key=lambda law: float(laws[law]["rms"]), default=None)


def residuals(record, law, ax, rows=ALL_ROWS):
    """Draw recorded less fitted friction, in thousandths, and the 95 % of the noise's level."""
    part = record.laws[law]
    level = float(np.hypot(part["noise_white"], part["noise_red"]))
    residual = 1e3 * part["residual"].values
    scatter(ax, record.values[rows], residual[rows], rows, LAWS[law].color, None)
    normal_95(ax, 1e3 * level, zorder=3)
    limit = 1.08 * float(np.abs(residual).max())
    ax.set(ylim=(-limit, limit), ylabel="Residual\n" + r"[$10^{-3}$]")
    record.format_panel(ax, rows)


def normal_95(ax, level=1.0, **style):
    """Draw 0, and the lines between which 95 % of normal values with this deviation are."""
    for height, look in ((0.0, "-"), (NORMAL_95, (0, (4, 3))), (-NORMAL_95, (0, (4, 3)))):
        ax.axhline(height * level, color="k", lw=0.6, ls=look, **style)


def marks(record, ax, *, named=False):
    """Mark where the load point changes its speed; with the speeds, where there is room."""
    for change in record.changes:
        ax.axvline(record.at(change.start), color=GRAY, lw=0.7, ls=":", zorder=0)
    if not (named and record.changes):
        return
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + ROOM * (high - low))
    at = {"xycoords": ax.get_xaxis_transform(), "textcoords": "offset points", "va": "top"}
    for change in record.changes:
        text, left = change.text(), record.at(change.start)
        if record.at(change.end) - left > LETTER * len(text) * record.values[-1]:
            ax.annotate(text, (left, 0.97), (3, 0), fontsize=7, color="0.3", **at)


def scatter(ax, x, y, rows, color, label):
    """Draw noisy values: single samples where they can be told apart, else a thin line."""
    style = {"color": color, "label": label, "rasterized": True, "zorder": 1}
    if rows == ALL_ROWS:
        ax.plot(*_envelope(x, y), lw=0.4, alpha=0.8, **style)
    else:
        ax.plot(x, y, ".", ms=2.2, mew=0.0, **style)


def _envelope(x, y):
    """The same samples, or of many the least and the largest of each few: noise stays as wide."""
    if x.size <= MAX_SAMPLES:
        return x, y
    block = -(-x.size // (MAX_SAMPLES // 2))
    starts = np.arange(0, x.size, block)
    low, high = np.minimum.reduceat(y, starts), np.maximum.reduceat(y, starts)
    return np.repeat(x[starts], 2), np.column_stack([low, high]).ravel()
