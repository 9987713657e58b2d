"""The reported quantities, as functions of the coordinates.

Most quantities are coordinates themselves (unknowns.py).  mu0 and the rate dependence of steady
friction are computed from several coordinates.
"""

import operator
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ....friction.linear_stability import linearisation
from ..forward import ForwardModel
from ..unknowns import parameter, to_coordinate, to_value

#: derivative of the rate dependence by a coordinate up to which it may be rounding
ROUNDING = 1e-9


class ReportedQuantity(NamedTuple):
    """A quantity as a function of the coordinates."""

    name: str
    forward: ForwardModel
    function: Callable | None = None  # of name -> (n,) values [SI]; None: it is a coordinate
    is_log: bool = False  # whether `value` is a logarithm
    no_effect: int = 0  # as of `Parameter`

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
        return (self.values(above) - self.values(below)) / np.diag(above - below)

    def si(self, value):
        if self.function is None:
            return to_value(self.name, value)
        with np.errstate(over="ignore"):  # an open end of an interval
            return np.exp(value) if self.is_log else value

    def standard_error(self, point, covariance):
        """Return the standard error of the value at a point (k,), from the covariance.

        NaN if the variance of a hardly determined quantity is negative from rounding.
        """
        gradient = self.gradient(point)
        variance = float(gradient @ covariance @ gradient)
        return variance**0.5 if variance >= 0.0 else np.nan


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

    free = [name for name in names if parameter(name).group in ("slider", "record")]
    rows = {name: parameter(name) for name in free}
    quantities = [
        ReportedQuantity(name, forward, is_log=row.is_log, no_effect=row.no_effect)
        for name, row in rows.items()
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
