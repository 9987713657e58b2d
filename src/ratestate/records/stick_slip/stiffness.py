"""The spring's stiffness from the loading between events, where the block sticks.

After a fall the slip rate falls far below V_lp, and rises again before the next peak.  So stress
rises most steeply early in a loading phase, by K (V_lp - V): a line through that is an estimate of
K.  All phases are combined by their weighted mean, without those that are far off; the error allows
for their scatter.  A block that creeps (under the slip law at a few per cent of V_lp, or more)
makes the estimate too small, and shows in a slope that lessens: what it has lost later in the phase
is part of the error.
"""

import math
from typing import NamedTuple

import numpy as np

from ..messages import stick_slip as sentences

#: part of a loading phase, in time, that is fitted; that where creep shows
STICKS, CREEPS = (0.15, 0.45), (0.6, 0.8)
#: fewest samples in it
FEWEST = 8
#: part of the time during which the stress falls, from which slip is smooth
SMOOTH = 0.15
#: standard deviations by which a phase may be off the median of all
FAR = 4.0


class Stiffness(NamedTuple):
    """K and its standard error [Pa/m], nan if unknown, and where they come from."""

    K: float
    error: float
    source: str  # sentence of the table `stiffness`
    phases: int = 0
    falling: float = math.nan  # part of the time during which the stress falls


def loading_stiffness(series, rises, falls, noise):
    """`Stiffness` from the loading phases [(first, last sample)] of a record.

    falls : the same of the events, for the part of the time that they take
    """
    t, y = series.t, series.tau
    if not rises:
        return Stiffness(math.nan, math.nan, "few")
    rising, falling = (np.median([t[j] - t[i] for i, j in spans]) for spans in (rises, falls))
    falling = float(falling / (rising + falling))
    slopes, variances, lost = [], [], []
    for first, last in rises:
        V, V_error = (float(x) for x in series.load.speed(0.5 * (t[first] + t[last])))
        if not V > 0.0 or (CREEPS[1] - CREEPS[0]) * (last - first) < FEWEST:
            continue
        slope, error = _slope(t, y, first, last, STICKS, noise)
        slopes.append(slope / V)
        variances.append((error / V) ** 2 + (slope / V * V_error / V) ** 2)
        lost.append((slope - _slope(t, y, first, last, CREEPS, noise)[0]) / V)
    if not slopes:
        return Stiffness(math.nan, math.nan, "few")
    if falling > SMOOTH:
        return Stiffness(math.nan, math.nan, "smooth", falling=falling)
    K, error, count = _combined(np.array(slopes), np.array(variances))
    creep = max(float(np.median(lost)), 0.0)
    return Stiffness(K, math.hypot(error, creep), "loading", count)


def _slope(t, y, first, last, part, noise):
    """Slope of stress [Pa/s] in a part of a loading phase, and its standard error."""
    begin, end = (round(first + x * (last - first)) for x in part)
    x = t[begin:end] - t[begin:end].mean()
    squares = float(x @ x)
    return float(x @ y[begin:end]) / squares, noise.sd * math.sqrt(noise.inflation / squares)


def _combined(slopes, variances):
    """Weighted mean of slopes that are not far off, its error with their scatter, their number."""
    variances = np.maximum(variances, 1e-300)
    middle = float(np.median(slopes))
    spread = 1.4826 * float(np.median(np.abs(slopes - middle)))
    near = np.abs(slopes - middle) <= FAR * np.hypot(spread, np.sqrt(variances))
    slopes, weights = slopes[near], 1.0 / variances[near]
    K = float(weights @ slopes / weights.sum())
    variance = 1.0 / float(weights.sum())
    if slopes.size > 1:
        scatter = float(weights @ (slopes - K) ** 2) / (slopes.size - 1)
        variance *= max(scatter, 1.0)
    return K, math.sqrt(variance), slopes.size


def stiffness_text(stiffness):
    """Where a `Stiffness` comes from, or why it is not known, in words."""
    values = {"phases": stiffness.phases, "part": 100.0 * stiffness.falling, "fewest": FEWEST}
    return sentences(f"stiffness.{stiffness.source}", **values)
