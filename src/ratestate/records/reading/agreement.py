"""Checks whether the columns of a record agree with each other."""

import numpy as np

from ...errors import ParameterError
from ...model.quantities import readable
from .columns import other_column
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
REMEDY = (
    ": too few digits to find speeds in; name a column of velocity in columns={'V_load': ...}, or "
    "give what the load point did as loading=... of fit"
)


def disagreements(table, chosen, rows, record, segments):
    """Notes on columns that contradict each other."""
    return [
        *_friction(record),
        *_constant(record),
        *([text + REMEDY] if (text := coarse_resolution(record, segments)) else []),
        *_speeds(table, chosen, rows, record),
    ]


def _friction(record):
    """A note if friction is not tau/sigma."""
    if not {"friction", "tau", "sigma"} <= set(record):
        return []
    good = record["sigma"] != 0.0
    recorded = np.median(record["friction"][good]) if good.any() else 0.0
    if recorded == 0.0:
        return []
    ratio = float(np.median(record["tau"][good] / record["sigma"][good]) / recorded)
    if abs(ratio - 1.0) <= AGREE:
        return []
    return [
        f"tau/sigma is {ratio:.3g} times the friction that is recorded; one of the three columns "
        f"or units is perhaps another, and friction is used as it is"
    ]


def _constant(record):
    """A note on the longest stretch of one value of friction, if noise would not have left it.

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
        return []
    return [
        f"friction stays at {friction[first]:.6g} from {t[first]:.7g} s to {t[last]:.7g} s, "
        f"{repeats + 1} rows, and has noise elsewhere: a channel at the end of its range, or a "
        f"load cell that dropped out; leave that stretch out by time=..."
    ]


def coarse_resolution(record, segments):
    """A text on a displacement with too few digits; "" if it stays constant in holds."""
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
            return f"delta_lp moves in steps of {readable('delta_lp', digit, 3)}"
    return ""


def _speeds(table, chosen, rows, record):
    """A note if a velocity beside the displacement leads elsewhere."""
    column = None if "V_load" in chosen else other_column(table, chosen, "V_load")
    if column is None or "delta_lp" not in record or column.values.size <= rows.kept.max():
        return []
    try:
        V = in_si("V_load", column.values[rows.kept], unit_of(column, "V_load", {}))
    except ParameterError:  # the column is not needed
        return []
    good = np.isfinite(V)
    t, x = record["time"][good], record["delta_lp"][good]
    if t.size < 2:
        return []
    by_V, by_x = abs(float(np.trapezoid(V[good], t))), abs(float(x[-1] - x[0]))
    if abs(by_V - by_x) <= MOVED * max(by_V, by_x):
        return []
    return [
        f"the column {quoted(column.title)} leads {readable('delta_lp', by_V, 3)} far from "
        f"{t[0]:.7g} s to {t[-1]:.7g} s, and delta_lp {readable('delta_lp', by_x, 3)}; one of the "
        f"two or its unit is perhaps another, and delta_lp is used"
    ]
