"""Least squares in which one reported number keeps a value."""

import numpy as np

from ..problem import search
from ..solve import FEW
from ..unknowns import Unknowns


class Held:
    """A `Problem` in which a `Reported` keeps a value, and a coordinate is given up for it."""

    def __init__(self, problem, reported, value):
        self.whole, self.reported, self.value = problem, reported, value
        self.others = [i for i in range(len(problem.unknowns.names)) if i != reported.given_up]
        names, low, high = problem.unknowns
        rest = self.others
        self.unknowns = Unknowns(tuple(names[i] for i in rest), low[rest], high[rest])

    def point(self, rest):
        """The whole point (k,) of the coordinates that move."""
        point = np.zeros(len(self.others) + 1)
        point[self.others] = rest
        return self.reported.kept(point, self.value)

    def residual(self, rest, noise):
        return self.whole.residual(self.point(rest), noise)

    def jacobian(self, rest, noise):
        point = self.point(rest)
        columns = self.whole.jacobian(point, noise)
        gradient = self.reported.gradient(point)
        given_up = self.reported.given_up
        by_others = -gradient[self.others] / gradient[given_up]
        return columns[:, self.others] + np.outer(columns[:, given_up], by_others)


def best_with(solution, reported, value, starts):
    """Point, and deviance from the solution, of the best fit in which a number has this value.

    None where no start moves through the whole record.
    """
    held = Held(solution.problem, reported, value)
    best = None
    for start in starts:
        rest = np.clip(start[held.others], held.unknowns.low, held.unknowns.high)
        found = search(held, rest, solution.noise, FEW)
        if found and (best is None or found.cost < best.cost):
            best = found
    return best and (held.point(best.x), 2.0 * float(best.cost) - solution.chi2)
