"""Checks whether the columns of a record agree with each other."""

import numpy as np

from ...errors import ParameterError
from ..messages import reading as sentences
from .columns import column_by_name
from .sizes import in_si, unit_of
from .table import quoted

#: largest relative difference of friction and tau/sigma of one file
AGREE = 0.05
#: and of a velocity and a displacement: speeds are often nominal
MOVED = 0.25
#: fewest rows at one displacement, on average, if its last digit can be found; largest move in a
#: hold, in digits (one, and noise)
REPEATED, DIGITS = 5, 1.5
#: fewest rows of constant friction that are noted, largest probability that they are by chance, and
#: least part of other rows at which friction has an extremum if it has noise
CONSTANT, CHANCE, NOISY = 20, 1e-6, 0.25


def disagreements(rows, coarse):
    """Notes (list of str) on columns that contradict each other; empty if none do.

    coarse : text of `coarse_resolution`, which becomes a note as well; "" for none
    """
    notes = [
        _friction_disagreement(rows.record),
        _constant_friction(rows.record),
        sentences("notes.remedy", text=coarse) if coarse else "",
        _velocity_disagreement(rows),
    ]
    return [note for note in notes if note]


def _friction_disagreement(record):
    """A note if friction is not tau/sigma, else ""."""
    if not record.keys() >= {"friction", "tau", "sigma"}:
        return ""
    good = record["sigma"] != 0.0
    recorded = np.median(record["friction"][good]) if good.any() else 0.0
    if recorded == 0.0:
        return ""
    ratio = float(np.median(record["tau"][good] / record["sigma"][good]) / recorded)
    return sentences("notes.ratio", ratio=ratio) if abs(ratio - 1.0) > AGREE else ""


def _constant_friction(record):
    """A note on the longest stretch of one value, if noise would not have left it, else "".

    Rounded values repeat: with a probability p from row to row, n rows have a stretch of m repeats
    by chance with one of n p^m.
    """
    t, friction = record["time"], record["friction"]
    ends = np.flatnonzero(np.diff(friction))  # of stretches, but the last
    ends = np.concatenate([[-1], ends, [t.size - 1]])
    longest = int(np.argmax(np.diff(ends)))
    first, last = int(ends[longest]) + 1, int(ends[longest + 1])
    repeats, others = last - first, t.size - 1 - (last - first)
    steps = np.delete(np.diff(friction), np.s_[first:last])
    moves = steps[steps != 0.0]
    noisy = moves.size > 1 and np.mean(moves[1:] * moves[:-1] < 0.0) > NOISY
    p = (others - moves.size + 1) / (others + 2)
    if repeats + 1 < CONSTANT or not noisy or t.size * p**repeats > CHANCE:
        return ""
    span = {"first": t[first], "last": t[last], "rows": repeats + 1}
    return sentences("notes.constant", friction=friction[first], **span)


def coarse_resolution(record, segments):
    """A text if the displacement has so few digits that it moves by them in a hold; else ""."""
    if "delta_lp" not in record:
        return ""
    t, x = record["time"], record["delta_lp"]
    values = np.unique(x)
    if REPEATED * values.size > x.size:
        return ""
    digit = float(np.median(np.diff(values)))
    starts = np.searchsorted(t, segments.t)
    for i, j, V in zip(starts, [*starts[1:], t.size], segments.V, strict=True):
        part = max(1, (j - i) // 10)
        moved = abs(np.median(x[j - part : j]) - np.median(x[i : i + part]))
        if V == 0.0 and moved > DIGITS * digit:
            return sentences("notes.coarse", digit=digit)
    return ""


def _velocity_disagreement(rows):
    """A note if a velocity beside the displacement leads elsewhere, else ""."""
    columns, record = rows.table.columns, rows.record
    own = [*map(id, rows.columns.values())]
    taken = [i for i, column in enumerate(columns) if id(column) in own]
    index = None if "V_load" in record else column_by_name(rows.table, "V_load", taken)
    if index is None or columns[index].values.size <= rows.kept.max():
        return ""
    try:
        unit = unit_of(columns[index], "V_load", {})
        V = in_si("V_load", columns[index].values[rows.kept], unit)
    except ParameterError:  # the column is not needed
        return ""
    good = np.isfinite(V)
    t, x = record["time"][good], record["delta_lp"][good]
    if t.size < 2:
        return ""
    by_V, by_x = abs(float(np.trapezoid(V[good], t))), abs(float(x[-1] - x[0]))
    if abs(by_V - by_x) <= MOVED * max(by_V, by_x):
        return ""
    title = quoted(columns[index].title)
    return sentences("notes.speeds", title=title, by_V=by_V, by_x=by_x, first=t[0], last=t[-1])
