"""Values that nobody can have measured: their rows are left out, and reported by number."""

import numpy as np

from ...model.quantities import readable
from .messages import message
from .table import quoted
from .titles import USUAL

#: what loggers write where they have no value
MISSING = (-999.0, -999.25, -9999.0, -99999.0)
#: least distance of a spike from both neighbours, over the largest step of all others, and, of
#: friction, also over its typical size.  The peak of a direct effect may be one sample, so can the
#: end of a slip, but these are smaller.
FAR, LEAST = 10.0, 0.1
#: one in so many samples, at most, is tried as a spike
PART = 100


def drop_codes(rows):
    """Leave out rows with a code for a missing value far off from all else in its column."""
    for column in rows.columns.values():
        for code in MISSING:
            values = column.values[rows.kept]
            bad = values == code
            if not bad.any():
                continue
            others = values[~bad]
            if others.size < 2:
                continue
            if others.min() - code > FAR * np.abs(np.diff(others)).max():
                rows.leave_out(bad, f"with {code:g} in {quoted(column.title)}, a code for no value")


def drop_impossible(rows):
    """Leave out rows whose values cannot be; friction out of the stresses if need be.

    A column of sigma that is dead throughout is left out whole beside friction, for which it is not
    needed: the note (list of str) says so.  ParameterError where hardly any row is left.
    """
    notes = []
    record = rows.record
    if "sigma" in record:
        low, high = USUAL["sigma"]
        bad = (record["sigma"] < low) | (record["sigma"] > high)
        if "friction" in record and bad.all():
            size = float(np.median(record.pop("sigma")))
            title = quoted(rows.columns["sigma"].title)
            notes.append(message("notes.dead_sigma", title=title, size=size, low=low, high=high))
        else:
            _drop(rows, "sigma", bad, f"with normal stress outside {low:g} to {high:g} Pa")
    if "friction" not in rows.record:
        rows.record["friction"] = rows.record["tau"] / rows.record["sigma"]
    high = USUAL["friction"][1]
    bad = np.abs(rows.record["friction"]) > high
    _drop(rows, "friction", bad, f"with friction that no rock has (more than {high:g})")
    for symbol in ("friction", "delta_lp", "V_load"):
        if symbol in rows.record:
            values = rows.record[symbol]
            least = LEAST * float(np.median(np.abs(values))) * (symbol == "friction")
            bad = spikes(values, least)
            _drop(rows, symbol, bad, "as single samples far off from those before and after")
    return notes


def _drop(rows, symbol, bad, why):
    """Leave out rows, reported with their values."""
    values = rows.record[symbol]
    rows.leave_out(bad, why, lambda i: f"{symbol} = {readable(symbol, values[i], 4)}")
    rows.check_enough()


def spikes(values, least=0.0):
    """(n,) mask of single samples off to one side of both neighbours: by more than `least`, and
    than `FAR` times the largest of all other steps.

    At most one in `PART`, and one, are found; none in fewer than 10 samples.
    """
    bad = np.zeros(values.size, bool)
    if values.size < PART // 10:
        return bad
    steps = np.diff(values)
    one, other = steps[:-1], steps[1:]
    off = np.where(one * other < 0.0, np.minimum(np.abs(one), np.abs(other)), 0.0)
    count = 1 + off.size // PART
    far = np.argpartition(off, -count)[-count:] + 1
    largest = float(np.abs(np.diff(np.delete(values, far))).max())
    bad[far] = off[far - 1] > max(FAR * largest, least)
    return bad


def flip_signs(record, signs):
    """Turn what is negative throughout, and a load point that moves down: symbols, notes (lists).

    Negative: friction, tau or sigma with a 90 % quantile below 0.  Down: the median of the last
    twentieth of delta_lp is below that of the first or, without delta_lp, that of V_load below 0.

    record : symbol -> array, with delta_lp or V_load; entries are replaced, arrays left as they are
    signs : symbol -> 1 or -1, for those that are known
    """
    notes = {s: f"the sign of {s} is turned, as the format says" for s in signs if signs[s] < 0}
    for symbol in ("friction", "tau", "sigma"):
        if symbol in record and symbol not in signs and np.quantile(record[symbol], 0.9) < 0.0:
            notes[symbol] = f"{symbol} is negative throughout; its sign is turned"
    symbol = "delta_lp" if "delta_lp" in record else "V_load"
    x = record[symbol]
    part = max(1, x.size // 20)
    start, end = (x[:part], x[-part:]) if symbol == "delta_lp" else (0.0, x)
    if symbol not in signs and np.median(end) < np.median(start):
        notes[symbol] = f"{symbol} runs downwards; its sign is turned"
    flipped = [symbol for symbol in notes if symbol in record]
    for symbol in flipped:
        record[symbol] = -record[symbol]
    return flipped, [notes[symbol] for symbol in flipped]
