"""Several steps compared: scatter of the estimates, steps up beside steps down, law beside law."""

from typing import NamedTuple

import numpy as np
from scipy.special import stdtr

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
    means, variances, squares = [], [], 0.0
    for values, errors in (map(np.asarray, up), map(np.asarray, down)):
        weights = np.maximum(errors, 1e-300) ** -2.0
        means.append(float(weights @ values / weights.sum()))
        variances.append(1.0 / float(weights.sum()))
        squares += float(weights @ (values - means[-1]) ** 2)
    degrees = len(up[0]) + len(down[0]) - 2
    value = float(np.exp(means[0] - means[1])) if is_log else means[0] / means[1]
    if degrees == 0:
        return Ratio(value, np.nan, np.nan)
    scale = max(squares / degrees, 1.0)
    difference, error = means[0] - means[1], np.sqrt(scale * sum(variances))
    p_value = float(2.0 * stdtr(degrees, -abs(difference) / error))
    own = value * error
    if not is_log:
        own = np.sqrt(scale * (variances[0] + value**2 * variances[1])) / abs(means[1])
    return Ratio(value, float(own), p_value)


def group_of(values, errors, is_log=False):
    """`Group` of estimates (n,) with standard errors (n,): weighted, by DerSimonian & Laird (1986).

    doi:10.1016/0197-2456(86)90046-2; NaN of none.
    """
    n = len(values)
    if n == 0:
        return Group(np.nan, np.nan, np.nan, 0, is_log)
    values, errors = np.asarray(values, float), np.maximum(errors, 1e-300)
    weights = errors**-2.0
    mean = weights @ values / weights.sum()
    excess = weights @ (values - mean) ** 2 - (n - 1)
    per_scatter = weights.sum() - (weights**2).sum() / weights.sum()
    scatter = max(excess / per_scatter, 0.0) if n > 1 else 0.0
    weights = 1.0 / (errors**2 + scatter)
    mean = weights @ values / weights.sum()
    return Group(float(mean), float(weights.sum() ** -0.5), float(scatter**0.5), n, is_log)


def grouped(fits, law, name):
    """`Group` of a parameter over all `Fitted` windows, in its coordinate."""
    values, errors, is_log = estimates_of(fits, law, name)
    return group_of(values, errors, is_log)


def estimates_of(fits, law, name, chosen=lambda window: True):
    """Values (list) of a parameter in its coordinate, errors (list), and whether it is a logarithm.

    Of the `Fitted` windows that are chosen; estimates without a finite error do not count.
    """
    is_log = name not in SUMS and parameter(name).is_log
    values, errors = [], []
    for fit in fits:
        separate = fit.of(law)
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
