"""The quantities that a fit reports, as functions of the coordinates in which it moves.

Most are coordinates themselves (unknowns.py).  a - b and mu0 are not, but each can replace one
coordinate: a least-squares fit with such a quantity constrained has one coordinate less.
"""

from typing import NamedTuple

import numpy as np

from ..unknowns import FREE, PARAMETERS, to_value


class ReportedQuantity(NamedTuple):
    """A quantity as a function of the coordinates: one of them, or a sum of weighted values."""

    name: str
    names: tuple  # of the coordinates
    eliminated: int  # the coordinate that a constraint on this quantity eliminates
    weights: dict  # of a, b, level and trend; empty if the quantity is the coordinate
    given: dict  # values of a and b, where they are not free

    @property
    def is_coordinate(self):
        """Whether it is one of the coordinates, and no sum."""
        return not self.weights

    @property
    def is_log(self):
        """Whether `value` is a logarithm."""
        return self.is_coordinate and PARAMETERS[self.name].is_log

    def value(self, point):
        """The quantity at a point (k,): a coordinate (a logarithm if `is_log`), else in SI."""
        if self.is_coordinate:
            return float(point[self.eliminated])
        named = zip(self.names, point, strict=True)
        at = self.given | {name: to_value(name, x) for name, x in named if name in self.weights}
        return float(sum(weight * at[name] for name, weight in self.weights.items()))

    def gradient(self, point):
        """(k,) derivatives of `value` by the coordinates."""
        weights = {self.name: 1.0} if self.is_coordinate else self.weights
        gradient = np.array([weights.get(name, 0.0) for name in self.names])
        if not self.is_coordinate and "a" in self.names:
            gradient[self.names.index("a")] *= np.exp(point[self.names.index("a")])
        return gradient

    def constrained(self, point, value):
        """A copy of the point (k,), its eliminated coordinate set so that this is the value.

        NaN where only a negative a would do.
        """
        point, i = point.copy(), self.eliminated
        lacking = value - self.value(point)
        if self.is_coordinate or not PARAMETERS[self.names[i]].is_log:
            point[i] += lacking / self.gradient(point)[i]
        else:  # a - b with a alone free
            with np.errstate(invalid="ignore", divide="ignore"):
                point[i] = np.log(np.exp(point[i]) + lacking / self.weights["a"])
        return point

    def si(self, value):
        """A value of the quantity in SI."""
        return to_value(self.name, value) if self.is_coordinate else value

    def standard_error(self, point, covariance):
        """Standard error of the value at a point (k,), from the covariance (k, k)."""
        gradient = self.gradient(point)
        return float(np.sqrt(gradient @ covariance @ gradient))


def reported_quantities(problem):
    """tuple of `ReportedQuantity`: free parameters, mu0, a - b if a or b is free, the trend."""
    names, slider = problem.unknowns.names, problem.slider
    height = float(np.log(problem.forward.V0 / slider.V0))
    # name -> the coordinate that it can replace, and weights
    sums = {"mu0": ("level", {"a": -height, "b": height, "level": 1.0})}
    if free := [name for name in ("b", "a") if name in names]:
        sums["a_minus_b"] = free[0], {"a": 1.0, "b": -1.0}
    for name in names:
        if symbol := PARAMETERS[name].reported_as.format(along=problem.record.trend):
            sums[symbol] = name, {name: 1.0}
    given = {"a": float(slider.a), "b": float(slider.b)}
    return (
        *(ReportedQuantity(n, names, i, {}, {}) for i, n in enumerate(names) if n in FREE),
        *(
            ReportedQuantity(name, names, names.index(replaced), weights, given)
            for name, (replaced, weights) in sums.items()
        ),
    )
