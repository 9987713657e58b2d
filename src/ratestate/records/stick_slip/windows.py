"""The window around the extremes of alike events.

All events at one load-point velocity share a window, counted from the middles of their falls: the
one with the least error in which a polynomial of the lowest degree with an extreme is not
contradicted by one two degrees higher, in value and slope.  (Lepskii 1991, doi:10.1137/1135065,
chooses windows by such comparisons.)  The mean difference of the degrees over all events is part
of the error of each extreme.
"""

import math

import numpy as np

from .polynomials import Window, extremes

#: events from which a window is chosen, at most; part of them that must have samples enough
MOST, ENOUGH = 16, 0.8
#: standard errors of the mean difference between both degrees that do not contradict
AGREE = 1.5
#: standard deviations of the sum of squares that a window may have too much
ROUGH = 4.0
#: power of the contradiction by which an error must be smaller
PRICE = 4


def chosen_window(t, y, middles, windows, k, sign, noise):
    """The `Window` among these in which extremes are least uncertain and not contradicted.

    The more the degrees contradict each other, the smaller the error must be in return.  None if no
    window has samples enough.
    """
    some = middles[:: math.ceil(middles.size / MOST)]
    choices: list[tuple[float, Window]] = []
    for window in windows:
        found = extremes(t, y, some, window, k, sign, noise)
        if np.isfinite(found.value).mean() < ENOUGH:
            continue
        error = math.sqrt(float(np.nanmean(found.error**2)))
        choices.append((error * max(_contradiction(found), 1.0) ** PRICE, window))
    return min(choices, default=(0.0, None))[1]


def _contradiction(found):
    """How far the degrees are apart, and samples from them, over what is allowed."""
    excess = found.excess[np.isfinite(found.excess)]
    parts = [excess.sum() / ROUGH / math.sqrt(excess.size)]
    pairs = (found.difference, found.variance), (found.turn, found.turn_variance)
    for off, variance in pairs:
        spread = math.sqrt(max(np.nansum(variance), 1e-300))
        parts.append(abs(np.nansum(off)) / AGREE / spread)
    return float(max(parts))


def biased_errors(found):
    """(m,) errors of `Extremes` with what all may be off: the mean difference of the degrees."""
    known = found.difference[np.isfinite(found.difference)]
    return np.hypot(found.error, abs(known.mean()) if known.size else math.nan)
