"""Part of a record, between two times or two displacements."""

import numpy as np

from ...errors import ParameterError
from ...model.quantities import readable
from ...model.units import to_si


def window_ends(symbol, window, name):
    """Both ends of a window [SI], infinite where None is given."""
    if window is None:
        return None
    try:
        # as plain numbers: a message shows them
        first, last = (x.item() if isinstance(x, np.generic) else x for x in window)
    except (TypeError, ValueError):
        first = last = window
        sound = False
    else:
        sound = not isinstance(window, str)
        window = (first, last) if sound else window
    if not sound:
        like = "('11640 s', '11720 s')" if symbol == "time" else "('8600 um', '8900 um')"
        raise ParameterError(
            f"{name} = {window!r} must be a pair such as {like}; either may be None"
        )
    low = -np.inf if first is None else to_si(symbol, first, label=f"{name} (from)", bound="")
    high = np.inf if last is None else to_si(symbol, last, label=f"{name} (to)", bound="")
    if not low < high:
        raise ParameterError(f"{name} = {window!r} must be a pair in increasing order")
    return low, high


def rows_inside(symbol, values, window, name):
    """First row in the window, and one more than the last; the rows between count as inside.

    values : ndarray [SI], NaN among them
    """
    good = np.flatnonzero((values >= window[0]) & (values <= window[1]))
    if not good.size:
        low, high = np.nanmin(values), np.nanmax(values)
        raise ParameterError(
            f"{name}: no row lies in the window; the record reaches from "
            f"{readable(symbol, low, 7)} to {readable(symbol, high, 7)}"
        )
    return int(good[0]), int(good[-1]) + 1
