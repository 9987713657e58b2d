"""The window around the extremes of alike events, and these extremes.

All events at one load-point velocity share a window, counted from the middles of their falls: the
one with the least error in which a polynomial of the lowest degree with an extreme is not
contradicted by one two degrees higher, in value and slope.  (Lepskii 1991, doi:10.1137/1135065,
chooses windows by such comparisons.)  What the degrees still differ by, in the mean of all events,
moves the extremes, and half of that is part of their error.
"""

import math

import numpy as np

from .polynomials import Extreme, Window, extreme

#: events from which a window is chosen, at most; part of them that must have samples enough
MOST, ENOUGH = 16, 0.8
#: standard errors of the mean difference between both degrees that do not contradict
AGREE = 1.5
#: standard deviations of the sum of squares that a window may have too much
ROUGH = 4.0
#: largest shift of a place, over the extent of the window
FARTHEST = 0.5


def chosen_window(t, y, middles, windows, k, sign, noise):
    """The `Window` among these in which an extreme is least uncertain and not contradicted.

    Where all are contradicted, the one that is so least; None where none has samples enough.
    """
    some = middles[:: math.ceil(middles.size / MOST)]
    agree: list[tuple[float, Window]] = []
    contradicted: list[tuple[float, Window]] = []
    for window in windows:
        found = [extreme(t, y, middle, window, k, sign, noise) for middle in some]
        found = [one for one in found if math.isfinite(one.value)]
        if len(found) < ENOUGH * len(some):
            continue
        column = dict(zip(Extreme._fields, np.array(found).T, strict=True))
        against = _contradiction(column)
        if against <= 1.0:
            agree.append((float(np.mean(column["error"] ** 2)), window))
        else:
            contradicted.append((against, window))
    return min(agree or contradicted, default=(0.0, None))[1]


def _contradiction(column):
    """How far the degrees are apart, and samples from them, over what is allowed.

    column : field of `Extreme` -> (events,) numbers
    """
    excess = column["excess"]
    parts = [excess.sum() / ROUGH / math.sqrt(excess.size)]
    for off, variance in (("difference", "variance"), ("turn", "turn_variance")):
        spread = math.sqrt(max(column[variance].sum(), 1e-300))
        parts.append(abs(column[off].sum()) / AGREE / spread)
    return float(max(parts))


def extremes(t, y, middles, window, k, sign, noise):
    """list of `Extreme` of all events in one window.

    Where most have a vertex, those that noise leaves without one are taken where the others are.
    """
    found = [extreme(t, y, middle, window, k, sign, noise) for middle in middles]
    found = _moved(found, sign, k)
    inside = np.array([one.inside == 1.0 for one in found])
    if 0.5 < inside.mean() < 1.0:
        after = np.array([one.time for one in found])[inside] - middles[inside]
        known = float(np.median(after)), float(after.std())
        for i in np.flatnonzero(~inside):
            found[i] = extreme(t, y, middles[i], window, k, sign, noise, known)
    bias = _bias(found)
    return [one._replace(error=math.hypot(one.error, bias)) for one in found]


def _moved(found, sign, k):
    """`Extreme`s whose vertices are moved by what the degrees' slopes differ by, in the mean."""
    vertices = [one for one in found if one.inside == 1.0]
    if not vertices:
        return found
    turn = float(np.mean([one.turn for one in vertices]))
    variance = float(np.mean([one.turn_variance for one in vertices])) / len(vertices)
    beyond = 0.5 * max(turn**2 - variance, 0.0)
    moved = []
    for one in found:
        if one.inside == 1.0:
            shift = float(np.clip(-turn / one.curvature, -FARTHEST, FARTHEST))
            more = math.hypot(math.sqrt(variance) / abs(one.curvature), 0.5 * shift)
            one = one._replace(
                time=one.time + shift * one.extent,
                time_error=math.hypot(one.time_error, more * one.extent),
                value=one.value + sign * beyond / abs(one.curvature) / one.extent**k,
            )
        moved.append(one)
    return moved


def _bias(found):
    """What all `Extreme`s in one window may be off: the mean difference of the degrees; or nan."""
    differences = [one.difference for one in found if math.isfinite(one.difference)]
    return abs(float(np.mean(differences))) if differences else math.nan
