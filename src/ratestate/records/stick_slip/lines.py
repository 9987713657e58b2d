"""Straight lines: the spring's stiffness from the loading, and trends of the stress drop.

After a fall the slip rate falls far below V_lp, and rises again before the next peak.  So stress
rises most steeply early in a loading phase, by K (V_lp - V): a line through that is an estimate of
K.  All phases are combined by their weighted mean, without those that are far off; the error allows
for their scatter.  A block that creeps (under the slip law at a few per cent of V_lp, or more)
makes the estimate too small, and shows in a slope that lessens: what it has lost later in the phase
is part of the error.

A trend is stress drop = A + B log10(x), x the recurrence interval or V_lp: the line of the
laboratories (Karner & Marone 2000, doi:10.1029/GM120p0187; Beeler et al. 2001,
doi:10.1029/2000JB900242) and of the paper's section 3.2.  Events at one V_lp are alike, and a line
need not pass through their mean: so the drop's variance is that among events at one V_lp, and one
more that all of them share, as far as the residuals show it.  Errors and line are from generalized
least squares with both.
"""

import math
from typing import NamedTuple

import numpy as np
import pandas

from ..kit.regression import weighted_mean
from ..messages import stick_slip as sentences

#: part of a loading phase, in time, that is fitted; that where creep shows; fewest samples in it
STICKS, CREEPS, FEWEST_SAMPLES = (0.15, 0.45), (0.6, 0.8), 8
#: part of the time during which the stress falls, from which slip is smooth
SMOOTH = 0.15
#: standard deviations by which a phase may be off the median of all
FAR = 4.0
#: fewest events of a trend, and least ratio of the largest to the smallest abscissa
FEWEST, NARROWEST = 4, 1.5
#: part by which speeds differ that count as one
SAME = 0.02
#: least variance, so that what has no scatter can be divided by it
TINY = 1e-300


class Stiffness(NamedTuple):
    """K and its standard error [Pa/m], nan if unknown, and where they come from."""

    K: float
    error: float
    source: str  # sentence of the table `stiffness`
    phases: int = 0
    falling: float = math.nan  # part of the time during which the stress falls

    @property
    def text(self):
        """Where K comes from, or why it is not known, in words."""
        part = 100.0 * self.falling
        values = {"phases": self.phases, "part": part, "fewest": FEWEST_SAMPLES}
        return sentences(f"stiffness.{self.source}", **values)


def loading_stiffness(series, rises, falls, noise):
    """`Stiffness` from the loading phases [(first, last sample)] of a record.

    falls : (m, 2) samples of the whole events, for the part of the time that they take
    """
    t, y = series.t, series.tau
    slopes, errors, lost = [], [], []
    for first, last in rises:
        middle = 0.5 * (t[first] + t[last])
        V, V_error = (series.at(middle, column) for column in (series.V_lp, series.V_lp_error))
        if not V > 0.0 or (CREEPS[1] - CREEPS[0]) * (last - first) < FEWEST_SAMPLES:
            continue
        slope, error = _slope(t, y, first, last, STICKS, noise)
        slopes.append(slope / V)
        errors.append(math.hypot(error / V, slope / V * V_error / V))
        lost.append((slope - _slope(t, y, first, last, CREEPS, noise)[0]) / V)
    if not slopes:
        return Stiffness(math.nan, math.nan, "few")
    rising, falling = (np.median(np.diff(t[np.array(spans)])) for spans in (rises, falls))
    falling = float(falling / (rising + falling))
    if falling > SMOOTH:
        return Stiffness(math.nan, math.nan, "smooth", falling=falling)
    errors = np.maximum(errors, TINY**0.5)
    off = np.abs(slopes - np.median(slopes))
    near = off <= FAR * np.hypot(1.4826 * np.median(off), errors)
    mean, phases = weighted_mean(np.array(slopes)[near], errors[near]), int(near.sum())
    scatter = max(mean.chi2 / max(phases - 1, 1), 1.0)
    error = math.hypot(mean.error * math.sqrt(scatter), max(float(np.median(lost)), 0.0))
    return Stiffness(mean.value, error, "loading", phases)


def _slope(t, y, first, last, part, noise):
    """Slope of stress [Pa/s] in a part of a loading phase, and its standard error."""
    begin, end = (round(first + x * (last - first)) for x in part)
    x = t[begin:end] - t[begin:end].mean()
    squares = float(x @ x)
    return float(x @ y[begin:end]) / squares, noise.sd * math.sqrt(noise.inflation / squares)


class Trend(NamedTuple):
    """A line: A at x = 1 in SI, B a decade [Pa], their standard errors, and what must be known."""

    A: float = math.nan
    A_error: float = math.nan
    B: float = math.nan
    B_error: float = math.nan
    events: int = 0
    message: str = ""


def trend(x, drop, V_lp, what):
    """The `Trend` of stress drops with x, all (m,); NaN do not count.

    what : x in words, for the message of a `Trend` without numbers
    """
    use = np.isfinite(x) & np.isfinite(drop) & np.isfinite(V_lp) & (np.nan_to_num(x) > 0.0)
    x, drop, V_lp = x[use], drop[use], V_lp[use]
    if x.size < FEWEST:
        return Trend(message=sentences("trend.few", events=x.size, fewest=FEWEST))
    factor = float(x.max() / x.min())
    if factor < NARROWEST:
        texts = {"what": what, "factor": factor, "least": NARROWEST}
        return Trend(message=sentences("trend.narrow", **texts))
    groups = speed_groups(V_lp)
    columns = np.column_stack([np.ones(x.size), np.log10(x), drop])
    rest = drop - columns[:, :2] @ np.linalg.lstsq(columns[:, :2], drop)[0]
    speeds = int(groups.max()) + 1
    shared = _shared_variance(rest, groups) if speeds > 2 else 0.0
    # (events less a part of their mean at each speed have independent errors of one size)
    part = 1.0 - (1.0 + shared * np.bincount(groups)) ** -0.5
    means = pandas.DataFrame(columns).groupby(groups).transform("mean").values
    design, values = np.split(columns - part[groups, None] * means, [2], axis=1)
    inverse = np.linalg.inv(design.T @ design)
    line = inverse @ design.T @ values[:, 0]
    rest = values[:, 0] - design @ line
    A_error, B_error = np.sqrt(rest @ rest / max(x.size - 2, 1) * np.diag(inverse))
    message = sentences("trend.two") if speeds == 2 else ""
    return Trend(float(line[0]), float(A_error), float(line[1]), float(B_error), x.size, message)


def speed_groups(V):
    """(m,) number of the speed, in rising order, that each belongs to."""
    order = np.argsort(V)
    jumps = np.diff(V[order]) > SAME * V[order][:-1]
    number = np.empty(V.size, int)
    number[order] = np.concatenate([[0], np.cumsum(jumps)])
    return number


def _shared_variance(rest, groups):
    """Variance, over that among events at one speed, of what all at one speed share.

    By moments: the mean square of the residuals' means, less what the scatter explains; 0 at least.
    If there is one event at each speed, their scatter is that of all.
    """
    counts, means = (
        np.bincount(groups),
        pandas.Series(rest).groupby(groups).transform("mean").values,
    )
    total, inner, degrees = float(rest @ rest), rest - means, rest.size - counts.size
    if degrees < 1:
        own = total / max(rest.size - 2, 1)
    else:
        own = max(float(inner @ inner) / degrees, 1e-12 * total / rest.size)
    between = float(means @ means) / max(counts.size - 2, 1)
    usual = (rest.size - float(counts @ counts) / rest.size) / max(counts.size - 1, 1)
    return max(between / max(own, TINY) - 1.0, 0.0) / usual
