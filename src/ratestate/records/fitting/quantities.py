"""The reported quantities, as functions of the coordinates, and their estimates.

Most quantities are coordinates themselves (unknowns.py).  mu0 and the rate dependence of steady
friction are computed from several coordinates.
"""

import operator
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy

from ...friction.linear_stability import linearisation
from .forward import ForwardModel
from .unknowns import parameter, to_coordinate, to_value

LEVELS = (0.68, 0.95)
SIDES = ("lower", "upper")
#: distance of these intervals' ends from the estimate, in standard errors of a Gaussian
ROOTS = scipy.special.ndtri(0.5 + 0.5 * np.array(LEVELS))
#: `ROOTS` along (levels, sides)
GAUSSIAN = np.repeat(ROOTS[:, None], 2, axis=1)
#: half width beyond which a logarithm's interval counts as open
ENDLESS = np.log(1e6)
#: standard error of a coordinate on which the record does not depend
UNSEEN = 1e6
#: derivative of the rate dependence by a coordinate up to which it may be rounding
ROUNDING = 1e-9


class ReportedQuantity(NamedTuple):
    """A quantity as a function of the coordinates."""

    name: str
    forward: ForwardModel
    function: Callable | None = None  # of name -> (n,) values [SI]; None: it is a coordinate
    is_log: bool = False  # whether `value` is a logarithm
    no_effect: int = 0  # as of `FitParameter`

    @property
    def is_free(self):
        """Whether the quantity is one of the free parameters."""
        return self.name in self.forward.names

    def values(self, points):
        """Return the quantity (n,) at points (n, k): a logarithm if `is_log`, or in SI."""
        if self.function is None:
            return points[:, self.forward.names.index(self.name)]
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self.function(self.forward.values(points))

    def value(self, point):
        """Return one of `values` (float) at a point (k,)."""
        return float(self.values(point[None])[0])

    def gradient(self, point):
        """Return the derivatives (k,) of `value` by the coordinates."""
        if self.function is None:
            return (np.array(self.forward.names) == self.name).astype(float)
        above, below = self.forward.neighbours(point)
        high, low = np.split(self.values(np.concatenate([above, below])), 2)
        return (high - low) / np.diag(above - below)

    def si(self, value):
        if self.function is None:
            return to_value(self.name, value)
        with np.errstate(over="ignore"):  # an open end of an interval
            return np.exp(value) if self.is_log else value

    def standard_error(self, solution):
        """Return the standard error of the value at a `Solution`."""
        return float(np.linalg.norm(self.gradient(solution.point) @ solution.root))


def reported_quantities(problem):
    """Return `ReportedQuantity`s: free parameters, mu0, rate dependence, trend.

    The rate dependence is left out if no free parameter has an effect on it.
    """
    names, forward = problem.unknowns.names, problem.forward
    V0, V = float(problem.slider.V0), forward.V0
    friction = problem.slider.replace(damping=0.0).friction_law

    def mu0(values):
        return forward.mu0(values | {"V0": np.full_like(values["a"], V0)}, values["level"])

    def rate_dependence(values):
        """Return d mu_ss/d ln V at `V`; it is a - b for one state and the log form."""
        linear = linearisation(friction, friction.coefficient_arrays(V, values))
        return values["a"] * (linear.direct - linear.evolution.sum(axis=-1))

    rows = {name: parameter(name) for name in names}
    free = [name for name, row in rows.items() if row.group in ("slider", "record")]
    quantities = [
        ReportedQuantity(name, forward, None, rows[name].is_log, rows[name].no_effect)
        for name in free
    ]
    quantities.append(ReportedQuantity("mu0", forward, mu0))
    rate = ReportedQuantity("a_minus_b", forward, rate_dependence)
    given = {
        name: to_coordinate(name, getattr(problem.slider, name)) for name in free if name != "lag"
    }
    start = np.array([given.get(name, 0.0) for name in names])
    if (np.abs(rate.gradient(start)[: len(free)]) > ROUNDING).any():
        quantities.append(rate)
    if "trend" in names:
        symbol = f"trend_{problem.record.trend}"
        quantities.append(ReportedQuantity(symbol, forward, operator.itemgetter("trend")))
    return tuple(quantities)


class Estimate(NamedTuple):
    """The estimate of a quantity [SI]."""

    value: float
    error: float  # standard error
    interval: np.ndarray  # (levels, sides)
    kind: str  # source of the interval: "covariance", "profile" or "posterior"

    @property
    def relative_error(self):
        """Standard error from the covariance, divided by the value's size."""
        return float(self.error / max(abs(self.value), 1e-300))


class Estimates(NamedTuple):
    """Estimates of p quantities, and their correlation."""

    by_name: dict  # symbol -> `Estimate`
    correlation: np.ndarray  # (p, p), of the logarithms of positive quantities

    def correlation_of(self, names):
        """Return the correlation (n, n) of these names."""
        which = [[*self.by_name].index(name) for name in names]
        return self.correlation[np.ix_(which, which)]

    def with_intervals(self, intervals, kind):
        """Return `Estimates` with some intervals, name -> (levels, sides) [SI], of this kind."""
        changed = {
            name: self.by_name[name]._replace(interval=interval, kind=kind)
            for name, interval in intervals.items()
        }
        return self._replace(by_name=self.by_name | changed)


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
    scaled = np.where(errors < UNSEEN, np.where(is_log, values, 1.0) * errors, np.inf)
    rows = zip(names, values.tolist(), scaled, _from_logs(ends, logs), strict=True)
    by_name = {name: Estimate(x, error, pair, "covariance") for name, x, error, pair in rows}
    return Estimates(by_name, covariance / np.outer(errors, errors))


def _from_logs(values, is_log):
    with np.errstate(over="ignore"):  # an open end of an interval
        return np.where(is_log, np.exp(values), values)
