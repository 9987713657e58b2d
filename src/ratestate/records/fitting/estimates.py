"""Estimates with standard errors, intervals and correlation, from their covariance."""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from .unknowns import LINEAR, slope, to_value

LEVELS = (0.68, 0.95)
SIDES = ("lower", "upper")
#: distance of these intervals' ends from the estimate, in standard errors of a Gaussian
ROOTS = ndtri(0.5 + 0.5 * np.array(LEVELS))
#: half width of an interval of a logarithm beyond which it counts as open
ENDLESS = np.log(1e6)
#: standard error of a coordinate from which it counts as not seen by the record at all
UNSEEN = 1e6


class Estimates(NamedTuple):
    """p estimates [SI] with errors, intervals and correlation."""

    names: tuple  # symbols
    values: np.ndarray  # (p,)
    errors: np.ndarray  # (p,) standard errors
    intervals: np.ndarray  # (p, levels, sides)
    correlation: np.ndarray  # (p, p), of the coordinates
    kinds: tuple  # source of each interval: "covariance", "profile" or "posterior"

    def only(self, names):
        """The estimates of these names."""
        i = [self.names.index(name) for name in names]
        kinds = tuple(self.kinds[k] for k in i)
        values, errors, intervals = self.values[i], self.errors[i], self.intervals[i]
        correlation = self.correlation[np.ix_(i, i)]
        return Estimates(tuple(names), values, errors, intervals, correlation, kinds)

    def with_intervals(self, intervals, kind):
        """The estimates with some intervals replaced: name -> (levels, sides) [SI]."""
        ends = np.array(
            [intervals.get(name, old) for name, old in zip(self.names, self.intervals, strict=True)]
        )
        kinds = tuple(
            kind if name in intervals else old
            for name, old in zip(self.names, self.kinds, strict=True)
        )
        return self._replace(intervals=ends, kinds=kinds)


def estimates_from(names, coordinates, covariance, derived=()):
    """`Estimates` from coordinates (unknowns.py) and their covariance.

    Parameters
    ----------
    names : tuple of str, of the k coordinates
    coordinates : (k,)
    covariance : (k, k)
    derived : sequence of (symbol, value, (k,) gradient), linear functions of the coordinates
    """
    count = len(names)
    gradients = np.vstack([np.eye(count), *(gradient for _, _, gradient in derived)])
    joint = gradients @ covariance @ gradients.T
    errors = np.sqrt(np.diag(joint))
    centres = np.concatenate([coordinates, [value for _, value, _ in derived]])
    reach = ROOTS[:, None] * np.array([-1.0, 1.0])
    ends = centres[:, None, None] + errors[:, None, None] * reach
    values, scales = centres.copy(), np.ones(centres.size)
    for i, name in enumerate(names):
        values[i] = to_value(name, centres[i])
        if name not in LINEAR:  # a logarithm as uncertain as this is open
            ends[i] = np.where(np.abs(ends[i] - centres[i]) > ENDLESS, np.inf * reach, ends[i])
        scales[i] = slope(name, values[i])
        ends[i] = to_value(name, ends[i])
    names = (*names, *(symbol for symbol, _, _ in derived))
    correlation = joint / np.outer(errors, errors)
    in_si = np.where(errors < UNSEEN, scales * errors, np.inf)
    return Estimates(names, values, in_si, ends, correlation, ("covariance",) * len(names))
