"""Values that nobody can have measured: their rows are left out, and reported by number."""

import numpy as np

from ...model.quantities import readable
from .sizes import USUAL
from .table import quoted

#: what loggers write where they have no value
MISSING = (-999.0, -999.25, -9999.0, -99999.0)
#: least distance of an isolated sample from both neighbours, over the largest step of all others,
#: and, of friction, also over its typical size.  The peak of a direct
#: effect may be one sample, so can the end of a slip, but these are smaller.
FAR, LEAST = 10.0, 0.1
#: one in so many samples, at most, is tried as an isolated one
PART = 100


def drop_codes(rows):
    """Leave out rows with a code for a missing value far off from all else in its column."""
    for column in rows.columns.values():
        values = column.values[rows.kept]
        for code in MISSING:
            bad = values == code
            if bad.any() and _is_far_below(values[~bad], code):
                why = f"with {code:g} in {quoted(column.title)}, a code for no value"
                rows.leave_out(bad, why, None)
                values = column.values[rows.kept]


def _is_far_below(others, code):
    """Whether a value is below all others by more than ten times their largest step."""
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
        # a dead column of sigma is no reason to reject the friction recorded beside it
        if "friction" not in record or not bad.all():
            why = f"with normal stress outside {low:g} to {high:g} Pa"
            record = _drop_rows(rows, record, bad, why, "sigma")
    if "friction" not in record:
        record["friction"] = record["tau"] / record["sigma"]
    _, high = USUAL["friction"]
    why = f"with friction that no rock has (more than {high:g})"
    record = _drop_rows(rows, record, np.abs(record["friction"]) > high, why, "friction")
    for symbol in ("friction", "delta_lp", "V_load"):
        if symbol in record:
            least = LEAST * float(np.median(np.abs(record[symbol]))) * (symbol == "friction")
            why = "as single samples far off from those before and after"
            bad = isolated_samples(record[symbol], least)
            record = _drop_rows(rows, record, bad, why, symbol)
    return record


def isolated_samples(values, least=0.0):
    """Mask of samples off to one side of both neighbours, by more than all other steps.

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


def _drop_rows(rows, record, bad, why, symbol):
    """The record without some rows, which are reported with their values."""
    if not bad.any():
        return record
    values = dict(zip(rows.kept.tolist(), record[symbol].tolist(), strict=True))
    rows.leave_out(bad, why, lambda row: f"{symbol} = {readable(symbol, values[row], 4)}")
    rows.check_enough()
    return {s: column[~bad] for s, column in record.items()}


def flip_negative(record):
    """Flip friction and stresses that are negative throughout; notes on them."""
    notes = []
    for symbol in ("friction", "tau", "sigma"):
        if symbol in record and np.quantile(record[symbol], 0.9) < 0.0:
            record[symbol] = -record[symbol]
            notes.append(f"{symbol} is negative throughout; its sign is turned")
    return notes
