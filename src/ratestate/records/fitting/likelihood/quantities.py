"""The quantities that a fit reports, as functions of the coordinates in which it moves.

Most are coordinates themselves (unknowns.py).  The rate dependence of steady friction and mu0 are
not, but each can replace one coordinate: a least-squares fit with such a quantity constrained has
one coordinate less.
"""

import operator
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ....friction.linear_stability import linearisation
from ..forward import Forward
from ..unknowns import LINEAR, parameter, starts_of, to_coordinate, to_value

#: steps of Newton's method, of which one is enough where a quantity is linear
NEWTON = 3
#: derivative of the rate dependence by a coordinate that is rounding
ROUNDING = 1e-9


class ReportedQuantity(NamedTuple):
    """A quantity as a function of the coordinates: one of them, or computed from their values."""

    name: str
    names: tuple  # of the coordinates
    eliminated: int  # the coordinate that a constraint on this quantity eliminates
    forward: Forward
    function: Callable | None = None  # of name -> (n,) values [SI]; None: it is the coordinate

    @property
    def is_coordinate(self):
        """Whether it is one of the coordinates."""
        return self.function is None

    @property
    def is_log(self):
        """Whether `value` is a logarithm."""
        return self.is_coordinate and parameter(self.name).is_log

    def values(self, points):
        """(n,) the quantity at points (n, k): its coordinate, with logarithms; else in SI."""
        if self.function is None:
            return points[:, self.eliminated]
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self.function(self.forward.values(points))

    def value(self, point):
        """The quantity at a point (k,), as of `values`."""
        return float(self.values(point[None])[0])

    def gradient(self, point):
        """(k,) derivatives of `value` by the coordinates."""
        if self.is_coordinate:
            return np.eye(len(self.names))[self.eliminated]
        above, below = self.forward.neighbours(point)
        return (self.values(above) - self.values(below)) / np.diag(above - below)

    def constrained(self, point, value):
        """A copy of the point (k,), its eliminated coordinate set so that this is the value.

        NaN where only a negative value of what moves as its logarithm would do.
        """
        point, i = point.copy(), self.eliminated
        if self.is_coordinate:
            point[i] = value
            return point
        is_log = parameter(self.names[i]).is_log
        with np.errstate(invalid="ignore", divide="ignore"):
            for _ in range(NEWTON):
                change = (value - self.value(point)) / self.gradient(point)[i]
                # in the parameter itself, in which most quantities are linear
                point[i] += np.log1p(change) if is_log else change
        return point

    def si(self, value):
        """A value of the quantity in SI."""
        return to_value(self.name, value) if self.is_coordinate else value

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
    names, law, forward = problem.unknowns.names, problem.law, problem.forward
    V0, V = float(problem.slider.V0), forward.V0
    friction = problem.slider.replace(damping=0.0).friction_law

    def mu0(values):
        return forward.mu0(values | {"V0": np.full_like(values["a"], V0)}, values["level"])

    def rate_dependence(values):
        """d mu_ss/d ln V at `V`; a - b, unless the law has more states or friction of its own."""
        linear = linearisation(friction, friction.coefficient_arrays(V, values))
        return values["a"] * (linear.direct - linear.evolution.sum(axis=-1))

    aside = (*starts_of(law), "lag", *LINEAR)
    moving = [name for name in names if name not in aside]

    def quantity(name, replaced, function=None):
        return ReportedQuantity(name, names, names.index(replaced), forward, function)

    sums = [quantity("mu0", "level", mu0)]
    own = {name: to_coordinate(name, getattr(problem.slider, name)) for name in moving}
    begin = np.array([own.get(name, 0.0) for name in names])
    for name in sorted(moving, key=lambda name: name != "b"):
        rate = quantity("a_minus_b", name, rate_dependence)
        if abs(rate.gradient(begin)[rate.eliminated]) > ROUNDING:
            sums.append(rate)
            break
    if "trend" in names:
        symbol = parameter("trend").reported_as.format(along=problem.record.trend)
        sums.append(quantity(symbol, "trend", operator.itemgetter("trend")))
    free = [name for name in names if parameter(name).group in ("slider", "record")]
    return (*(quantity(name, name) for name in free), *sums)
