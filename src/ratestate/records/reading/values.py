"""Leave out rows with impossible values; turn signs; compare columns with each other."""

import itertools

import numpy as np

from ...errors import ParameterError
from ...model.quantities import readable
from ..messages import reading as sentences
from .columns import column_by_name, quoted, unit_of
from .sizes import in_si
from .titles import TYPICAL_RANGES

#: numbers that loggers write for missing values
MISSING_CODES = (-999.0, -999.25, -9999.0, -99999.0)
#: least jump into or out of a dropout, as a multiple of the largest other step and, for friction,
#: of its typical size.  The peak of a direct effect and the end of a slip are smaller.
JUMP_RATIO, MIN_JUMP = 10.0, 0.1
#: at most one dropout in so many samples, plus three, can be found
SAMPLES_PER_DROPOUT = 100
#: largest relative difference of friction and tau/sigma in one file
RATIO_TOLERANCE = 0.05
#: largest relative difference of an integrated velocity and a displacement (speeds are often
#: nominal)
MOVE_TOLERANCE = 0.25
#: fewest rows per distinct displacement, on average, from which its resolution can be found;
#: largest displacement in a hold, as a multiple of the resolution
MIN_REPEATS, MAX_DIGITS = 5, 1.5
#: fewest rows of constant friction that are noted, their largest probability by chance, and the
#: least fraction of other rows with an extremum from which friction counts as noisy
MIN_CONSTANT_ROWS, MAX_CHANCE, NOISE_FRACTION = 20, 1e-6, 0.25


def drop_codes(rows):
    """Leave out rows with a code for a missing value that is far from all other values."""
    for symbol in rows.record:
        for code in MISSING_CODES:
            values = rows.record[symbol]
            number = in_si(symbol, np.array(code), rows.units[symbol])
            bad = values == number
            others = values[~bad] if bad.any() else values[:0]
            steps = np.abs(np.diff(others))
            if steps.size and others.min() - number > JUMP_RATIO * steps.max():
                title = quoted(rows.columns[symbol].title)
                rows.leave_out(bad, f"with {code:g} in {title}, a code for no value")


def drop_impossible(rows):
    """Leave out rows with impossible values; compute friction if need be; return notes (list).

    If friction is recorded and every sigma is impossible, the column of sigma is left out, with a
    note.  ParameterError if too few rows are left.
    """
    notes = []
    record = rows.record
    if "sigma" in record:
        low, high = TYPICAL_RANGES["sigma"]
        bad = (record["sigma"] < low) | (record["sigma"] > high)
        if "friction" in record and bad.all():
            size = float(np.median(record.pop("sigma")))
            title = quoted(rows.columns["sigma"].title)
            notes.append(sentences("notes.dead_sigma", title=title, size=size, low=low, high=high))
        else:
            _drop(rows, "sigma", bad, f"with normal stress outside {low:g} to {high:g} Pa")
    if "friction" not in rows.record:
        rows.record["friction"] = rows.record["tau"] / rows.record["sigma"]
    high = TYPICAL_RANGES["friction"][1]
    bad = np.abs(rows.record["friction"]) > high
    _drop(rows, "friction", bad, f"with friction that no rock has (more than {high:g})")
    drop_dropouts(rows, "friction", "tau")
    return notes


def drop_dropouts(rows, *symbols):
    """Leave out rows that are `dropouts` of any of the symbols."""
    for symbol in [s for s in symbols if s in rows.record]:
        values = rows.record[symbol]
        stress = symbol in ("friction", "tau")
        least = MIN_JUMP * float(np.median(np.abs(values))) if stress else 0.0
        # a longer stretch of zero speed is a hold
        bad = dropouts(values, least, 1 if symbol == "V_load" else values.size // 2)
        _drop(rows, symbol, bad, "as a dropout, far off from the rows before and after")


def _drop(rows, symbol, bad, why):
    values = rows.record[symbol]
    rows.leave_out(bad, why, lambda i: f"{symbol} = {readable(symbol, values[i], 4)}")
    rows.check_enough()


def dropouts(values, least, longest):
    """Return a mask (n,) of dropouts: stretches between a jump away and a jump back.

    A stretch at either end of the record is a dropout if the rest varies, and if the stretch is 0
    throughout, or constant and farther from the rest than the range of the rest.

    least : least size of a jump
    longest : most samples of a dropout

    Notes
    -----
    Jumps are steps larger than `least` and than `JUMP_RATIO` times the largest of all other steps.
    """
    bad = np.zeros(values.size, bool)
    while True:  # without one dropout, the next may be recognized
        kept = np.flatnonzero(~bad)
        further = kept[_find_dropouts(values[kept], least, longest)]
        if not further.size or bad.sum() + further.size > values.size // 2:
            return bad
        bad[further] = True


def _find_dropouts(values, least, longest):
    """Return a mask (n,) of `dropouts`, no two of them next to each other."""
    jumps, other = _find_jumps(values, least)
    starts = [0, *(jumps + 1).tolist(), values.size]
    bad = np.zeros(values.size, bool)
    for start, end in itertools.pairwise(starts if jumps.size else []):
        if end - start > longest or (start > 0 and bad[start - 1]):
            continue
        if start == 0 or end == values.size:
            part, rest = values[start:end], np.delete(values, np.s_[start:end])
            jump = abs(values[end] - part[-1] if start == 0 else part[0] - values[start - 1])
            is_constant = part.size > 1 and np.ptp(part) == 0.0 and jump > np.ptp(rest)
            bad[start:end] = other > 0.0 and (is_constant or not part.any())
        else:
            fall, rise = values[start] - values[start - 1], values[end] - values[end - 1]
            net = abs(values[end] - values[start - 1])
            bad[start:end] = 2.0 * net < min(abs(fall), abs(rise))
    return bad


def _find_jumps(values, least):
    """Return the samples before the jumps of `dropouts` (indices), and the largest other step.

    Fewer than 10 samples have no jumps.
    """
    steps = np.abs(np.diff(values))
    n_jumps = 2 * (3 + values.size // SAMPLES_PER_DROPOUT)
    if values.size >= SAMPLES_PER_DROPOUT // 10 and steps.size > n_jumps:
        largest = np.sort(np.partition(steps, -n_jumps - 1)[-n_jumps - 1 :])[::-1]
        counts = np.flatnonzero(largest[:-1] > np.maximum(JUMP_RATIO * largest[1:], least))
        if counts.size:
            other = largest[counts[-1] + 1]
            return np.flatnonzero(steps > np.maximum(JUMP_RATIO * other, least)), other
    return np.zeros(0, int), 0.0


def flip_signs(record, signs):
    """Turn the sign of negative columns; return the turned symbols and notes (lists).

    Friction, tau or sigma is negative if its 90 % quantile is below 0.  The pore pressure is turned
    too if both its quantile and the quantile of sigma are below 0.  The load point moves backwards
    if the median of delta_lp in the last twentieth is below the median in the first twentieth or,
    without delta_lp, if the median of V_load is below 0.

    record : symbol -> array, with delta_lp or V_load; entries are replaced, arrays do not change
    signs : symbol -> 1 or -1, for known signs
    """
    notes = {s: f"the sign of {s} is changed, as the format says" for s in signs if signs[s] < 0}
    for symbol in ("friction", "tau", "sigma", "pore_pressure"):
        # a pore pressure may be a little below 0; its sign follows the sign of sigma
        follows = symbol != "pore_pressure" or "sigma" in notes
        known = symbol in signs or symbol not in record
        if follows and not known and np.quantile(record[symbol], 0.9) < 0.0:
            notes[symbol] = f"{symbol} is negative throughout, so its sign is changed"
    symbol = "delta_lp" if "delta_lp" in record else "V_load"
    x = record[symbol]
    part = max(1, x.size // 20)
    start, end = (x[:part], x[-part:]) if symbol == "delta_lp" else (0.0, x)
    if symbol not in signs and np.median(end) < np.median(start):
        notes[symbol] = f"{symbol} runs downwards, so its sign is changed"
    flipped = [symbol for symbol in notes if symbol in record]
    for symbol in flipped:
        record[symbol] = -record[symbol]
    return flipped, [notes[symbol] for symbol in flipped]


def contradictions(rows, coarse):
    """Return notes (list of str) on columns that contradict each other.

    coarse : text of `coarse_resolution`, which becomes another note; "" if the resolution is fine
    """
    notes = [
        _friction_disagreement(rows.record),
        _constant_friction(rows.record),
        sentences("notes.remedy", text=coarse) if coarse else "",
        _velocity_disagreement(rows),
    ]
    return [note for note in notes if note]


def _friction_disagreement(record):
    """Return a note if friction is not tau/sigma, else ""."""
    if not record.keys() >= {"friction", "tau", "sigma"}:
        return ""
    is_loaded = record["sigma"] != 0.0
    recorded = np.median(record["friction"][is_loaded]) if is_loaded.any() else 0.0
    if recorded == 0.0:
        return ""
    ratio = float(np.median(record["tau"][is_loaded] / record["sigma"][is_loaded]) / recorded)
    return sentences("notes.ratio", ratio=ratio) if abs(ratio - 1.0) > RATIO_TOLERANCE else ""


def _constant_friction(record):
    """Return a note on the longest stretch of constant friction if it is not by chance, else "".

    Rounded values repeat.  If a value repeats from row to row with probability p, the probability
    of m successive repeats in n rows is about n p^m.
    """
    t, friction = record["time"], record["friction"]
    ends = np.flatnonzero(np.diff(friction))  # last row of each stretch except the last one
    ends = np.concatenate([[-1], ends, [t.size - 1]])
    longest = int(np.argmax(np.diff(ends)))
    first, last = int(ends[longest]) + 1, int(ends[longest + 1])
    repeats, others = last - first, t.size - 1 - (last - first)
    steps = np.delete(np.diff(friction), np.s_[first:last])
    moves = steps[steps != 0.0]
    noisy = moves.size > 1 and np.mean(moves[1:] * moves[:-1] < 0.0) > NOISE_FRACTION
    p = (others - moves.size + 1) / (others + 2)
    if repeats + 1 < MIN_CONSTANT_ROWS or not noisy or t.size * p**repeats > MAX_CHANCE:
        return ""
    span = {"first": t[first], "last": t[last], "rows": repeats + 1}
    return sentences("notes.constant", friction=friction[first], **span)


def coarse_resolution(record, segments):
    """Return a text if the displacement changes by its own resolution in a hold; else ""."""
    if "delta_lp" not in record:
        return ""
    t, x = record["time"], record["delta_lp"]
    values = np.unique(x)
    if MIN_REPEATS * values.size > x.size:
        return ""
    digit = float(np.median(np.diff(values)))
    starts = np.searchsorted(t, segments.t)
    for i, j, V in zip(starts, [*starts[1:], t.size], segments.V, strict=True):
        part = max(1, (j - i) // 10)
        change = abs(np.median(x[j - part : j]) - np.median(x[i : i + part]))
        if V == 0.0 and change > MAX_DIGITS * digit:
            return sentences("notes.coarse", digit=digit)
    return ""


def _velocity_disagreement(rows):
    """Return a note if a recorded velocity contradicts the displacement, else ""."""
    record, (_, table, chosen) = rows.record, rows.files[0]
    used = [id(column.values) for column in chosen.values()]
    taken = [i for i, column in enumerate(table.columns) if id(column.values) in used]
    index = None if "V_load" in record else column_by_name(table, "V_load", taken)
    if index is None or len(rows.files) > 1:
        return ""
    column = table.columns[index]
    if column.values.size <= rows.kept.max():
        return ""
    try:
        V = in_si("V_load", column.values[rows.kept], unit_of(column, "V_load", {}))
    except ParameterError:  # the column is not needed
        return ""
    is_finite = np.isfinite(V)
    t, x = record["time"][is_finite], record["delta_lp"][is_finite]
    if t.size < 2:
        return ""
    by_V, by_x = abs(float(np.trapezoid(V[is_finite], t))), abs(float(x[-1] - x[0]))
    if abs(by_V - by_x) <= MOVE_TOLERANCE * max(by_V, by_x):
        return ""
    title = quoted(column.title)
    return sentences("notes.speeds", title=title, by_V=by_V, by_x=by_x, first=t[0], last=t[-1])
