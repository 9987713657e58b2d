"""What a fit reports, as functions of the coordinates in which it moves.

Most quantities are coordinates themselves (unknowns.py).  The rate dependence of steady friction
and mu0 are not.
"""

import operator
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ....friction.linear_stability import linearisation
from ..forward import ForwardModel
from ..unknowns import parameter, to_coordinate, to_value

#: derivative of the rate dependence by a coordinate that is rounding
ROUNDING = 1e-9


class ReportedQuantity(NamedTuple):
    """A quantity as a function of the coordinates: one of them, or computed from their values."""

    name: str
    forward: ForwardModel
    function: Callable | None = None  # of name -> (n,) values [SI]; None: it is the coordinate
    is_log: bool = False  # whether `value` is a logarithm
    irrelevant: int = 0  # -1 or 1: it ceases to matter where it is small, or large

    @property
    def is_free(self):
        """Whether it is one of the free parameters."""
        return self.name in self.forward.names

    def values(self, points):
        """(n,) the quantity at points (n, k): a logarithm if `is_log`, else in SI."""
        if self.function is None:
            return points[:, self.forward.names.index(self.name)]
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self.function(self.forward.values(points))

    def value(self, point):
        """The quantity at a point (k,), as of `values`."""
        return float(self.values(point[None])[0])

    def gradient(self, point):
        """(k,) derivatives of `value` by the coordinates."""
        if self.function is None:
            return (np.array(self.forward.names) == self.name).astype(float)
        above, below = self.forward.neighbours(point)
        return (self.values(above) - self.values(below)) / np.diag(above - below)

    def si(self, value):
        """A value of the quantity in SI."""
        if self.function is None:
            return to_value(self.name, value)
        with np.errstate(over="ignore"):  # an open end of an interval
            return np.exp(value) if self.is_log else value

    def standard_error(self, point, covariance):
        """Standard error of the value at a point (k,), from the covariance (k, k).

        NaN where rounding has made the covariance of what is hardly determined indefinite.
        """
        gradient = self.gradient(point)
        variance = float(gradient @ covariance @ gradient)
        return variance**0.5 if variance >= 0.0 else np.nan


def reported_quantities(problem):
    """tuple of `ReportedQuantity`: free parameters, mu0, the rate dependence if any of them has an
    effect on it, the trend.
    """
    names, forward = problem.unknowns.names, problem.forward
    V0, V = float(problem.slider.V0), forward.V0
    friction = problem.slider.replace(damping=0.0).friction_law

    def mu0(values):
        return forward.mu0(values | {"V0": np.full_like(values["a"], V0)}, values["level"])

    def rate_dependence(values):
        """d mu_ss/d ln V at `V`; a - b, unless the law has more states or friction of its own."""
        linear = linearisation(friction, friction.coefficient_arrays(V, values))
        return values["a"] * (linear.direct - linear.evolution.sum(axis=-1))

    free = [name for name in names if parameter(name).group in ("slider", "record")]
    rows = {name: parameter(name) for name in free}
    found = [
        ReportedQuantity(name, forward, is_log=row.is_log, irrelevant=row.irrelevant)
        for name, row in rows.items()
    ]
    found.append(ReportedQuantity("mu0", forward, mu0))
    rate = ReportedQuantity("a_minus_b", forward, rate_dependence)
    own = {
        name: to_coordinate(name, getattr(problem.slider, name)) for name in free if name != "lag"
    }
    begin = np.array([own.get(name, 0.0) for name in names])
    if (np.abs(rate.gradient(begin)[: len(free)]) > ROUNDING).any():
        found.append(rate)
    if "trend" in names:
        symbol = parameter("trend").reported_as.format(along=problem.record.trend)
        found.append(ReportedQuantity(symbol, forward, operator.itemgetter("trend")))
    return tuple(found)
