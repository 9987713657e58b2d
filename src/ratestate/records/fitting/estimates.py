"""Estimates with standard errors, intervals and correlation, from a covariance."""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

LEVELS = (0.68, 0.95)
SIDES = ("lower", "upper")
#: distance of these intervals' ends from the estimate, in standard errors of a Gaussian
ROOTS = ndtri(0.5 + 0.5 * np.array(LEVELS))
#: `ROOTS` along (levels, sides)
GAUSSIAN = np.repeat(ROOTS[:, None], 2, axis=1)
#: half width beyond which a logarithm's interval counts as open
ENDLESS = np.log(1e6)
#: standard error of a coordinate on which the record does not depend
UNSEEN = 1e6


def is_unconstrained(error):
    """Return whether the 95 % interval of a logarithm with this error is open."""
    return ROOTS[-1] * error > ENDLESS


class Estimate(NamedTuple):
    """The `Estimates` of one quantity."""

    value: float
    error: float
    interval: np.ndarray  # (levels, sides)
    kind: str

    @property
    def relative_error(self):
        """Standard error from the covariance, divided by the value's size."""
        return float(self.error / max(abs(self.value), 1e-300))


class Estimates(NamedTuple):
    """p estimates [SI] with errors, intervals and correlation."""

    names: tuple  # symbols
    values: np.ndarray  # (p,)
    errors: np.ndarray  # (p,) standard errors
    intervals: np.ndarray  # (p, levels, sides)
    correlation: np.ndarray  # (p, p), of the logarithms of positive quantities
    kinds: tuple  # source of each interval: "covariance", "profile" or "posterior"

    def of(self, name):
        """Return the `Estimate` of this name; ValueError if there is none."""
        i = self.names.index(name)
        return Estimate(float(self.values[i]), self.errors[i], self.intervals[i], self.kinds[i])

    def correlation_of(self, names):
        """Return the correlation (n, n) of these names."""
        which = [self.names.index(name) for name in names]
        return self.correlation[np.ix_(which, which)]

    def with_intervals(self, intervals, kind):
        """Return `Estimates` with some intervals replaced.

        intervals : name -> (levels, sides) [SI]; other names are ignored
        kind : source of these intervals
        """
        named = list(zip(self.names, self.intervals, self.kinds, strict=True))
        ends = np.array([intervals.get(name, old) for name, old, _ in named])
        kinds = tuple(kind if name in intervals else old for name, _, old in named)
        return self._replace(intervals=ends, kinds=kinds)


def estimates_from(names, centres, covariance, is_log, roots=GAUSSIAN):
    """Return `Estimates` from the covariance (p, p) of quantities or logarithms.

    centres : (p,) the quantities, or their logarithms if `is_log`
    is_log : (p,) of bool
    roots : (p, levels, sides) or broadcast to that, distance of an interval's end from the
        estimate, in standard errors

    Ends of a logarithm's interval farther than `ENDLESS` become 0 and inf.  Errors of `UNSEEN` or
    more become inf.
    """
    errors = np.sqrt(np.diag(covariance))
    sides = np.array([-1.0, 1.0])
    ends = centres[:, None, None] + errors[:, None, None] * roots * sides
    logs = is_log[:, None, None]
    ends = np.where(logs & (np.abs(ends - centres[:, None, None]) > ENDLESS), np.inf * sides, ends)
    values = _from_logs(centres, is_log)
    scaled = np.where(is_log, values, 1.0) * errors
    return Estimates(
        names,
        values,
        np.where(errors < UNSEEN, scaled, np.inf),
        _from_logs(ends, logs),
        covariance / np.outer(errors, errors),
        ("covariance",) * len(names),
    )


def _from_logs(values, is_log):
    with np.errstate(over="ignore"):  # an open end of an interval
        return np.where(is_log, np.exp(values), values)
