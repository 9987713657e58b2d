"""Rows of a record, times and speeds, as segments of a history."""

import numpy as np

from ...errors import ParameterError
from ..arrays import column
from ..units import is_array


def segments(t, V_lp):
    """Times of all rows, which of them start segments, and V and rate of these.

    ParameterError for what is no record: see `column`, `Loading.series`.
    """
    times, V = column("t", t), column("V_lp", V_lp)
    if is_array(times) or times.size < 2 or V.shape[-1] != times.size:
        raise ParameterError(
            f"t has {times.size} and V_lp {V.shape[-1]} values; "
            f"a series needs as many times as speeds, and at least 2"
        )
    dt = np.diff(times)
    _check(times, dt)
    keep = np.flatnonzero(dt > 0)
    start = V[..., keep]
    with np.errstate(over="ignore"):
        rate = (V[..., keep + 1] - np.asarray(start)) / dt[keep]
    if not np.isfinite(rate).all():
        raise ParameterError("two times are too close for a ramp; for a jump repeat the time")
    return times, keep, start, rate


def _check(times, dt):
    """Raise ParameterError unless these times, and the steps between them, make a record."""
    if times[0] != 0:
        raise ParameterError(f"t[0] = {times[0]:.6g} s must be 0: subtract it from all times")
    if (dt < 0).any():
        i = int(np.argmax(dt < 0))
        raise ParameterError(
            f"t[{i + 1}] = {times[i + 1]} s is less than t[{i}] = {times[i]} s: times must not "
            f"decrease; mend the record"
        )
    jump = np.concatenate([[True], dt == 0, [True]])  # nor may a jump be at either end
    if (jump[1:] & jump[:-1]).any():
        i = int(np.argmax(jump[1:] & jump[:-1]))
        where = "at an end of the series" if i in (0, times.size - 1) else "a third time"
        raise ParameterError(
            f"t[{i}] = {times[i]} s is repeated {where}: a jump is one time in two rows "
            f"between others; drop a row (V_start of `simulate` gives a start at another speed)"
        )
