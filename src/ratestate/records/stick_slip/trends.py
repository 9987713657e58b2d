"""Stress drop against the logarithm of the recurrence interval, and of V_lp: A + B log10(x).

The line of the laboratories (Karner & Marone 2000, doi:10.1029/GM120p0187; Beeler et al. 2001,
doi:10.1029/2000JB900242) and of the paper's section 3.2.  Events at one V_lp are alike, and a line
need not pass through their mean: so the drop's variance is that among events at one V_lp, and one
more that all of them share, as far as the residuals show it.  Errors and line are from generalized
least squares with both.
"""

import math
from typing import NamedTuple

import numpy as np

from ..messages import stick_slip as sentences

#: fewest events, and least ratio of the largest to the smallest abscissa
FEWEST, NARROWEST = 4, 1.5
#: part by which speeds differ that count as one
SAME = 0.02


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
        values = {"what": what, "factor": factor, "least": NARROWEST}
        return Trend(message=sentences("trend.narrow", **values))
    group = speed_groups(V_lp)
    design = np.column_stack([np.ones(x.size), np.log10(x)])
    shared = 0.0
    message = ""
    if group.max() < 2:
        message = sentences("trend.two") if group.max() == 1 else ""
    else:
        shared = _shared_variance(design, drop, group)
    coefficients, covariance = _solve(design, drop, group, shared)
    A, B = (float(c) for c in coefficients)
    A_error, B_error = (float(e) for e in np.sqrt(np.diag(covariance)))
    return Trend(A, A_error, B, B_error, x.size, message)


def speed_groups(V):
    """(m,) number of the speed, in rising order, that each belongs to."""
    order = np.argsort(V)
    jumps = np.diff(V[order]) > SAME * V[order][:-1]
    number = np.empty(V.size, int)
    number[order] = np.concatenate([[0], np.cumsum(jumps)])
    return number


def _shared_variance(design, drop, group):
    """Variance, over that among events at one speed, of what all at one speed share.

    By moments: the mean square of the residuals' means, less what the scatter explains; 0 at least.
    """
    coefficients, *_ = np.linalg.lstsq(design, drop, rcond=None)
    rest = drop - design @ coefficients
    counts = np.bincount(group)
    means = np.bincount(group, rest) / counts
    own = _scatter(rest, group)
    lines = max(counts.size - 2, 1)
    between = float(counts @ means**2) / lines
    usual = (rest.size - float(counts @ counts) / rest.size) / max(counts.size - 1, 1)
    return max(between / own - 1.0, 0.0) / usual


def _scatter(rest, group):
    """Variance of residuals among events at one speed; of all where there is one event at each."""
    counts = np.bincount(group)
    degrees = rest.size - counts.size
    if degrees < 1:
        return max(float(rest @ rest) / max(rest.size - 2, 1), 1e-300)
    inner = rest - (np.bincount(group, rest) / counts)[group]
    total = float(rest @ rest)
    return max(float(inner @ inner) / degrees, 1e-12 * total / rest.size, 1e-300)


def _solve(design, drop, group, shared):
    """Coefficients of generalized least squares, and their covariance."""
    correlation = np.eye(drop.size) + shared * (group[:, None] == group[None])
    weighted = np.linalg.solve(correlation, design)
    inverse = np.linalg.inv(design.T @ weighted)
    coefficients = inverse @ (weighted.T @ drop)
    rest = drop - design @ coefficients
    variance = float(rest @ np.linalg.solve(correlation, rest)) / max(drop.size - 2, 1)
    return coefficients, inverse * variance
