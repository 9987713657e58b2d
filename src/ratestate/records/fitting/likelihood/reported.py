"""The numbers that a fit reports, as functions of the coordinates in which it moves.

Most are coordinates themselves (unknowns.py).  a - b and mu0 are not, but each holds one
coordinate that can be given up for it: a least-squares fit with such a number kept is one with a
coordinate less.
"""

from typing import NamedTuple

import numpy as np

from ..unknowns import LINEAR, to_value


class Reported(NamedTuple):
    """A number as a function of the coordinates: a coordinate, a - b, mu0 or the trend.

    Its value is the coordinate, or  by_a a + by_b b + by_level level + by_trend trend.
    """

    name: str
    names: tuple  # of the coordinates
    given_up: int  # the coordinate that is given up where the number is kept
    plain: bool  # whether the number is that coordinate
    by_a: float = 0.0
    by_b: float = 0.0
    by_level: float = 0.0
    by_trend: float = 0.0
    a: float = 0.0  # where not free
    b: float = 0.0

    def value(self, point):
        """The number at a point (k,): a coordinate, or SI."""
        if self.plain:
            return float(point[self.given_up])
        at = dict(zip(self.names, point, strict=True))
        a = np.exp(at["a"]) if "a" in at else self.a
        b, trend = at.get("b", self.b), at.get("trend", 0.0)
        by = self.by_a * a + self.by_b * b + self.by_level * at["level"] + self.by_trend * trend
        return float(by)

    def gradient(self, point):
        """(k,) derivatives of `value` by the coordinates."""
        found = np.zeros(len(point))
        if self.plain:
            found[self.given_up] = 1.0
            return found
        by = {"b": self.by_b, "level": self.by_level, "trend": self.by_trend}
        for i, name in enumerate(self.names):
            found[i] = self.by_a * np.exp(point[i]) if name == "a" else by.get(name, 0.0)
        return found

    def kept(self, point, value):
        """The point (k,) with the one coordinate such that the number has this value."""
        point = point.copy()
        lacking = value - self.value(point)
        if self.plain or self.names[self.given_up] in LINEAR:
            point[self.given_up] += lacking / self.gradient(point)[self.given_up]
        else:  # a - b with a alone free
            with np.errstate(invalid="ignore", divide="ignore"):
                a = np.exp(point[self.given_up]) + lacking / self.by_a
                point[self.given_up] = np.log(a)
        return point

    def si(self, value):
        """The number in SI, from its own value."""
        return to_value(self.name, value) if self.plain else value


def reported_of(problem, slider):
    """tuple of `Reported`: free parameters, mu0, a - b where one of both is free, the trend."""
    names = problem.unknowns.names
    found = [Reported(name, names, names.index(name), True) for name in problem.unknowns.reported]
    height = float(np.log(problem.forward.V0 / slider.V0))
    rest = {"a": float(slider.a), "b": float(slider.b)}
    level = names.index("level")
    found.append(Reported("mu0", names, level, False, -height, height, 1.0, 0.0, **rest))
    free = [name for name in ("b", "a") if name in names]
    if free:
        given_up = names.index(free[0])
        found.append(Reported("a_minus_b", names, given_up, False, 1.0, -1.0, **rest))
    if "trend" in names:
        symbol = f"trend_{problem.record.trend}"
        found.append(Reported(symbol, names, names.index("trend"), False, by_trend=1.0))
    return tuple(found)
