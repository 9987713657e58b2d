"""Several steps compared: scatter of the estimates, steps up beside steps down, law beside law."""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import stdtr

from ...kit.regression import weighted_mean
from ..by_law import value_of
from ..unknowns import SUMS, parameter


class Group(NamedTuple):
    """Mean of n estimates of one parameter, in its coordinate."""

    mean: float
    error: float  # of the mean, with the scatter between the estimates
    scatter: float  # standard deviation between them beyond their errors
    n: int
    is_log: bool  # whether the coordinate is a logarithm


class Ratio(NamedTuple):
    """Mean over steps up divided by that over steps down."""

    value: float
    error: float  # standard error, with the scatter within both groups
    p_value: float  # of as large a difference of the means if there is none


def ratio_of(up, down, is_log):
    """`Ratio` of two groups of estimates: pairs of values (n,) and standard errors (n,).

    The scatter is that about both means together, as of Student's test.  NaN without both, and
    errors and probability where each has one estimate, for then nothing is known of the scatter.
    """
    if not (len(up[0]) and len(down[0])):
        return Ratio(np.nan, np.nan, np.nan)
    of_up, of_down = (weighted_mean(*map(np.asarray, group)) for group in (up, down))
    difference, degrees = of_up.value - of_down.value, len(up[0]) + len(down[0]) - 2
    value = float(np.exp(difference)) if is_log else of_up.value / of_down.value
    if degrees == 0:
        return Ratio(value, np.nan, np.nan)
    enlarged = math.sqrt(max((of_up.chi2 + of_down.chi2) / degrees, 1.0))
    error = enlarged * math.hypot(of_up.error, of_down.error)
    p_value = float(2.0 * stdtr(degrees, -abs(difference) / error))
    own = value * error
    if not is_log:
        own = enlarged * math.hypot(of_up.error, value * of_down.error) / abs(of_down.value)
    return Ratio(value, own, p_value)


def group_of(values, errors, is_log=False):
    """`Group` of estimates (n,) with standard errors (n,): weighted, by DerSimonian & Laird (1986).

    doi:10.1016/0197-2456(86)90046-2; NaN of none.
    """
    n = len(values)
    if n == 0:
        return Group(np.nan, np.nan, np.nan, 0, is_log)
    values, errors = np.asarray(values), np.asarray(errors)
    weights = errors**-2.0
    excess = weighted_mean(values, errors).chi2 - (n - 1)
    per_scatter = float(weights.sum() - (weights**2).sum() / weights.sum())
    scatter = math.sqrt(max(excess / per_scatter, 0.0)) if n > 1 else 0.0
    mean = weighted_mean(values, np.hypot(errors, scatter))
    return Group(mean.value, mean.error, scatter, n, is_log)


def grouped(fits, law, name):
    """`Group` of a parameter over all `Fitted` windows, in its coordinate."""
    values, errors, is_log = estimates_of(fits, law, name)
    return group_of(values, errors, is_log)


def estimates_of(fits, law, name, chosen=lambda window: True):
    """Values (list) of a parameter in its coordinate, errors (list), and whether it is a logarithm.

    Of the `Fitted` windows that are chosen and usable; estimates without a finite error do not
    count.
    """
    is_log = name not in SUMS and parameter(name).is_log
    values, errors = [], []
    for fit in fits:
        separate = fit.usable(law)
        if not separate or not chosen(fit.task.window):
            continue
        part = separate.result
        if name not in part["parameter"].values:
            continue
        value, error = value_of(part, name), float(part["standard_error"].sel(parameter=name))
        if np.isfinite(error):
            values.append(np.log(value) if is_log else value)
            errors.append(error / value if is_log else error)
    return values, errors, is_log


def is_up(window):
    """Whether a window is that of a step to a higher speed."""
    return window.kind == "step" and window.V_after > window.V_before


def is_down(window):
    """Whether a window is that of a step to a lower speed."""
    return window.kind == "step" and window.V_after < window.V_before
