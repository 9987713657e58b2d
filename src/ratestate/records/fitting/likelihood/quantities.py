"""The quantities that a fit reports, as functions of the coordinates in which it moves.

Most are coordinates themselves (unknowns.py).  a - b and mu0 are not, but each can replace one
coordinate: a least-squares fit with such a quantity constrained has one coordinate less.
"""

from typing import NamedTuple

import numpy as np

from ..unknowns import LINEAR, to_value


class ReportedQuantity(NamedTuple):
    """A quantity as a function of the coordinates: a coordinate, a - b, mu0 or the trend.

    Its value is the coordinate, or  by_a a + by_b b + by_level level + by_trend trend.
    """

    name: str
    names: tuple  # of the coordinates
    eliminated: int  # the coordinate that a constraint on this quantity eliminates
    is_coordinate: bool  # whether the quantity is that coordinate
    by_a: float = 0.0
    by_b: float = 0.0
    by_level: float = 0.0
    by_trend: float = 0.0
    a: float = 0.0  # where not free
    b: float = 0.0

    def value(self, point):
        """The quantity at a point (k,): a coordinate, or SI."""
        if self.is_coordinate:
            return float(point[self.eliminated])
        at = dict(zip(self.names, point, strict=True))
        a = np.exp(at["a"]) if "a" in at else self.a
        b, trend = at.get("b", self.b), at.get("trend", 0.0)
        by = self.by_a * a + self.by_b * b + self.by_level * at["level"] + self.by_trend * trend
        return float(by)

    def gradient(self, point):
        """(k,) derivatives of `value` by the coordinates."""
        gradient = np.zeros(len(point))
        if self.is_coordinate:
            gradient[self.eliminated] = 1.0
            return gradient
        by = {"b": self.by_b, "level": self.by_level, "trend": self.by_trend}
        for i, name in enumerate(self.names):
            gradient[i] = self.by_a * np.exp(point[i]) if name == "a" else by.get(name, 0.0)
        return gradient

    def constrained(self, point, value):
        """A copy of the point (k,), its eliminated coordinate set so that this is the value."""
        point = point.copy()
        lacking = value - self.value(point)
        if self.is_coordinate or self.names[self.eliminated] in LINEAR:
            point[self.eliminated] += lacking / self.gradient(point)[self.eliminated]
        else:  # a - b with a alone free
            with np.errstate(invalid="ignore", divide="ignore"):
                a = np.exp(point[self.eliminated]) + lacking / self.by_a
                point[self.eliminated] = np.log(a)
        return point

    def si(self, value):
        """A value of the quantity in SI."""
        return to_value(self.name, value) if self.is_coordinate else value

    def standard_error(self, point, covariance):
        """Standard error of the value at a point (k,), from the covariance (k, k)."""
        gradient = self.gradient(point)
        return float(np.sqrt(gradient @ covariance @ gradient))


def reported_quantities(problem, slider):
    """tuple of `ReportedQuantity`: free parameters, mu0, a - b if a or b is free, the trend."""
    names = problem.unknowns.names
    quantities = [
        ReportedQuantity(name, names, names.index(name), True) for name in problem.unknowns.reported
    ]
    height = float(np.log(problem.forward.V0 / slider.V0))
    rest = {"a": float(slider.a), "b": float(slider.b)}
    level = names.index("level")
    quantities.append(ReportedQuantity("mu0", names, level, False, -height, height, 1.0, **rest))
    free = [name for name in ("b", "a") if name in names]
    if free:
        eliminated = names.index(free[0])
        quantities.append(
            ReportedQuantity("a_minus_b", names, eliminated, False, 1.0, -1.0, **rest)
        )
    if "trend" in names:
        symbol = f"trend_{problem.record.trend}"
        trend = names.index("trend")
        quantities.append(ReportedQuantity(symbol, names, trend, False, by_trend=1.0))
    return tuple(quantities)
