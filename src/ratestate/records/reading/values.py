"""Values of single rows that nobody can have measured: their rows are left out, told by number."""

import numpy as np

from ...model.quantities import readable
from .sizes import USUAL
from .table import shown

#: what loggers write where they have no value
MISSING = (-999.0, -999.25, -9999.0, -99999.0)
#: how far a single sample stands off from both neighbours, over the largest step of all others,
#: to be none that was measured; of friction also over its typical size.  The peak of a direct
#: effect may be one sample, so can the end of a slip, but these are smaller.
FAR, LEAST = 10.0, 0.1
#: most samples that are looked at as single ones
PART = 100


def drop_codes(rows):
    """Leave out rows with a code for a missing value far off from all else in its column."""
    for column in rows.columns.values():
        values = column.values[rows.kept]
        for code in MISSING:
            bad = values == code
            if bad.any() and _apart(values[~bad], code):
                why = f"with {code:g} in {shown(column.title)}, a code for no value"
                rows.leave_out(bad, why, None)
                values = column.values[rows.kept]


def _apart(others, code):
    """Whether a value lies farther below all others than these go in ten of their steps."""
    return others.size > 1 and others.min() - code > FAR * np.abs(np.diff(others)).max()


def drop_impossible(rows, record):
    """Leave out rows whose values cannot be, and the same rows of the record.

    Parameters
    ----------
    rows : Rows
    record : dict
        Symbol -> values [SI] along the rows that are kept, the signs turned.
    """
    if "sigma" in record:
        low, high = USUAL["sigma"]
        bad = (record["sigma"] < low) | (record["sigma"] > high)
        # a dead column of it says nothing against friction that was recorded beside it
        if "friction" not in record or not bad.all():
            why = f"with normal stress outside {low:g} to {high:g} Pa"
            record = _without(rows, record, bad, why, "sigma")
    if "friction" not in record:
        record["friction"] = record["tau"] / record["sigma"]
    _, high = USUAL["friction"]
    why = f"with friction that no rock has (more than {high:g})"
    record = _without(rows, record, np.abs(record["friction"]) > high, why, "friction")
    for symbol in ("friction", "delta_lp", "V_load"):
        if symbol in record:
            least = LEAST * float(np.median(np.abs(record[symbol]))) * (symbol == "friction")
            why = "as single samples far off from those before and after"
            bad = single(record[symbol], least)
            record = _without(rows, record, bad, why, symbol)
    return record


def single(values, least=0.0):
    """Which samples stand off on one side from both neighbours, farther than all else moves.

    Parameters
    ----------
    values : ndarray, shape (n,)
    least : float
        Distance that is too little in any case.

    Returns
    -------
    bad : ndarray of bool, shape (n,)
    """
    bad = np.zeros(values.size, bool)
    if values.size < PART // 10:
        return bad
    steps = np.diff(values)
    off = np.where(steps[:-1] * steps[1:] < 0.0, np.minimum(*np.abs([steps[:-1], steps[1:]])), 0.0)
    far = np.argsort(off)[-(1 + off.size // PART) :] + 1
    largest = float(np.abs(np.diff(np.delete(values, far))).max())
    bad[far] = off[far - 1] > max(FAR * largest, least)
    return bad


def _without(rows, record, bad, why, symbol):
    """The record without some rows, which are told with their value."""
    if not bad.any():
        return record
    values = dict(zip(rows.kept.tolist(), record[symbol].tolist(), strict=True))
    rows.leave_out(bad, why, lambda row: f"{symbol} = {readable(symbol, values[row], 4)}")
    rows.check_enough()
    return {s: column[~bad] for s, column in record.items()}


def turn_negative(record):
    """Turn friction and stresses that are negative throughout; notes on what was turned."""
    notes = []
    for symbol in ("friction", "tau", "sigma"):
        if symbol in record and np.quantile(record[symbol], 0.9) < 0.0:
            record[symbol] = -record[symbol]
            notes.append(f"{symbol} is negative throughout; its sign is turned")
    return notes
