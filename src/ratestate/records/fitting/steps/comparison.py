"""Several steps compared: scatter of the estimates, steps up beside steps down, law beside law."""

from typing import NamedTuple

import numpy as np

from ..by_law import value_of
from ..unknowns import SUMS, parameter


class Group(NamedTuple):
    """Mean of n estimates of one parameter, in its coordinate."""

    mean: float
    error: float  # of the mean, with the scatter between the estimates
    scatter: float  # standard deviation between them beyond their errors
    n: int
    is_log: bool  # whether the coordinate is a logarithm

    def over(self, other):
        """(ratio of this mean in SI to the other, its standard error); NaN without both."""
        if not (self.n and other.n):
            return np.nan, np.nan
        if self.is_log:
            ratio = np.exp(self.mean - other.mean)
            return ratio, ratio * np.hypot(self.error, other.error)
        ratio = self.mean / other.mean
        return ratio, np.hypot(self.error, ratio * other.error) / abs(other.mean)


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


def grouped(fits, law, name, chosen=lambda window: True):
    """`Group` of a parameter over the `Fitted` windows that are chosen, in its coordinate.

    Estimates without a finite error do not count.
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
    return group_of(values, errors, is_log)


def is_up(window):
    """Whether a window is that of a step to a higher speed."""
    return window.kind == "step" and window.V_after > window.V_before


def is_down(window):
    """Whether a window is that of a step to a lower speed."""
    return window.kind == "step" and window.V_after < window.V_before
