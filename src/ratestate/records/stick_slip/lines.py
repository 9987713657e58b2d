"""Straight lines: the spring's stiffness from the loading, and trends of the stress drop.

After a fall the slip rate V drops far below V_lp, and it rises again before the next peak.  The
slope of the stress is K (V_lp - V), so it is steepest early in a loading phase.  A line through
this part gives an estimate of K.  The result is the weighted mean of all phases without outliers,
with an error that includes their scatter.  If the block creeps (under the slip law at a few per
cent of V_lp, or more), the estimate is too small, and the slope decreases during the phase.  This
decrease is part of the error.

A trend is stress drop = A + B log10(x), with x the recurrence interval or V_lp.  Laboratories fit
this line (Karner & Marone 2000, doi:10.1029/GM120p0187; Beeler et al. 2001,
doi:10.1029/2000JB900242), and so does section 3.2 of the paper.  Events at one V_lp are alike, and
a line need not pass through their mean.  So the variance of a drop has two parts: the variance
among events at one V_lp, and a part that all of these share, estimated from the residuals.  The
line and its errors follow from generalized least squares.
"""

import math
from typing import NamedTuple

import numpy as np
import pandas

from ..kit.regression import weighted_mean
from ..messages import stick_slip as sentences

#: part of a loading phase that is fitted; part that shows creep; fewest samples of the latter
STIFFNESS_PART, CREEP_PART, FEWEST_SAMPLES = (0.15, 0.45), (0.6, 0.8), 8
#: fraction of the time during which the stress falls, above which slip is smooth
SMOOTH = 0.15
#: largest deviation of a phase from the median of all, in standard deviations
MAX_DEVIATION = 4.0
#: fewest events of a trend, and least ratio of the largest to the smallest abscissa
FEWEST, NARROWEST = 4, 1.5
#: largest relative difference between neighbouring speeds that count as one
SAME_SPEED = 0.02
#: least variance, which avoids a division by zero
TINY = 1e-300


class Stiffness(NamedTuple):
    """K and its standard error [Pa/m], NaN if unknown, and their source."""

    K: float
    error: float
    source: str  # name of a message in the table `stiffness`
    phases: int = 0
    falling: float = math.nan  # fraction of the time during which the stress falls

    @property
    def text(self):
        """Describe where K comes from, or why it is unknown."""
        part = 100.0 * self.falling
        values = {"phases": self.phases, "part": part, "fewest": FEWEST_SAMPLES}
        return sentences(f"stiffness.{self.source}", **values)


def loading_stiffness(series, rises, falls, noise):
    """Return the `Stiffness` from the loading phases [(first, last sample)] of a record.

    falls : (m, 2) samples of whole events, for the fraction of time during which the stress falls
    """
    t, y = series.t, series.tau
    slopes, errors, decreases = [], [], []
    for first, last in rises:
        middle = 0.5 * (t[first] + t[last])
        V, V_error = (series.at(middle, column) for column in (series.V_lp, series.V_lp_error))
        if not V > 0.0 or (CREEP_PART[1] - CREEP_PART[0]) * (last - first) < FEWEST_SAMPLES:
            continue
        slope, error = _slope(t, y, first, last, STIFFNESS_PART, noise)
        slopes.append(slope / V)
        errors.append(math.hypot(error / V, slope / V * V_error / V))
        decreases.append((slope - _slope(t, y, first, last, CREEP_PART, noise)[0]) / V)
    if not slopes:
        return Stiffness(math.nan, math.nan, "few")
    rising, falling = (np.median(np.diff(t[np.array(spans)])) for spans in (rises, falls))
    falling = float(falling / (rising + falling))
    if falling > SMOOTH:
        return Stiffness(math.nan, math.nan, "smooth", falling=falling)
    errors = np.maximum(errors, TINY**0.5)
    distance = np.abs(slopes - np.median(slopes))
    is_used = distance <= MAX_DEVIATION * np.hypot(1.4826 * np.median(distance), errors)
    phases = int(is_used.sum())
    mean, error, chi2 = weighted_mean(np.array(slopes)[is_used], errors[is_used])
    error *= math.sqrt(max(chi2 / max(phases - 1, 1), 1.0))
    error = math.hypot(error, max(float(np.median(decreases)), 0.0))
    return Stiffness(mean, error, "loading", phases)


def _slope(t, y, first, last, part, noise):
    """Return the slope of stress [Pa/s] in a part of a loading phase, and its standard error."""
    begin, end = (round(first + x * (last - first)) for x in part)
    x = t[begin:end] - t[begin:end].mean()
    squares = float(x @ x)
    return float(x @ y[begin:end]) / squares, noise.sd * math.sqrt(noise.inflation / squares)


class Trend(NamedTuple):
    """A line: A at x = 1 in SI, B per decade [Pa], their standard errors, and a message."""

    A: float = math.nan
    A_error: float = math.nan
    B: float = math.nan
    B_error: float = math.nan
    events: int = 0
    message: str = ""


def trend(x, drop, V_lp, label):
    """Fit the `Trend` of stress drops with x, all (m,), without events that have NaN.

    label : x in words, for the message
    """
    use = np.isfinite(x) & np.isfinite(drop) & np.isfinite(V_lp) & (np.nan_to_num(x) > 0.0)
    x, drop, V_lp = x[use], drop[use], V_lp[use]
    if x.size < FEWEST:
        return Trend(message=sentences("trend.few", events=x.size, fewest=FEWEST))
    factor = float(x.max() / x.min())
    if factor < NARROWEST:
        texts = {"label": label, "factor": factor, "least": NARROWEST}
        return Trend(message=sentences("trend.narrow", **texts))
    groups = speed_groups(V_lp)
    columns = np.column_stack([np.ones(x.size), np.log10(x), drop])
    residuals = drop - columns[:, :2] @ np.linalg.lstsq(columns[:, :2], drop)[0]
    speeds = int(groups.max()) + 1
    shared = _shared_variance(residuals, groups) if speeds > 2 else 0.0
    # (subtracting a part of the mean at each speed makes the errors independent and equal)
    part = 1.0 - (1.0 + shared * np.bincount(groups)) ** -0.5
    means = pandas.DataFrame(columns).groupby(groups).transform("mean").values
    design, values = np.split(columns - part[groups, None] * means, [2], axis=1)
    inverse = np.linalg.inv(design.T @ design)
    line = inverse @ design.T @ values[:, 0]
    residuals = values[:, 0] - design @ line
    A_error, B_error = np.sqrt(residuals @ residuals / max(x.size - 2, 1) * np.diag(inverse))
    message = sentences("trend.two") if speeds == 2 else ""
    return Trend(float(line[0]), float(A_error), float(line[1]), float(B_error), x.size, message)


def speed_groups(V):
    """Return the number of each speed (m,) in rising order; similar speeds share a number."""
    order = np.argsort(V)
    jumps = np.diff(V[order]) > SAME_SPEED * V[order][:-1]
    number = np.empty(V.size, int)
    number[order] = np.concatenate([[0], np.cumsum(jumps)])
    return number


def _shared_variance(residuals, groups):
    """Return the variance between speeds divided by the variance among events at one speed.

    It is the mean square of the mean residuals minus the part that the scatter explains, at least
    0.  If no speed has two events, the scatter of all events is used.
    """
    counts = np.bincount(groups)
    means = pandas.Series(residuals).groupby(groups).transform("mean").values
    size, total, deviations = residuals.size, float(residuals @ residuals), residuals - means
    degrees = size - counts.size
    if degrees < 1:
        within = total / max(size - 2, 1)
    else:
        within = max(float(deviations @ deviations) / degrees, 1e-12 * total / size)
    between = float(means @ means) / max(counts.size - 2, 1)
    typical_count = (size - float(counts @ counts) / size) / max(counts.size - 1, 1)
    return max(between / max(within, TINY) - 1.0, 0.0) / typical_count
