"""Least squares with one reported quantity constrained to a value."""

import numpy as np

from ..generalized_least_squares import SEARCH_EVALUATIONS
from ..problem import search
from ..unknowns import Unknowns, parameter, to_coordinate


class ConstrainedProblem:
    """A `Problem` with a `ReportedQuantity` constrained: one coordinate is eliminated by it."""

    def __init__(self, problem, quantity, value):
        self.problem, self.quantity, self.value = problem, quantity, value
        names, low, high = problem.unknowns
        name = names[quantity.eliminated]
        #: where Newton's method for the eliminated coordinate starts; not every law allows 0
        own = getattr(problem.slider, name) if parameter(name).group == "slider" else 0.0
        self.start = to_coordinate(name, own)
        rest = self.rest = [i for i in range(len(names)) if i != quantity.eliminated]
        self.unknowns = Unknowns(tuple(names[i] for i in rest), low[rest], high[rest])

    def point(self, rest):
        """The point (k,) with these values (k - 1,) of the others; NaN if only a < 0 would do."""
        point = np.insert(rest, self.quantity.eliminated, self.start)
        return self.quantity.constrained(point, self.value)

    def whitened(self, rest, noise):
        """As `Problem.whitened`, at the other coordinates (k - 1,) and by them."""
        point, eliminated = self.point(rest), self.quantity.eliminated
        residual, columns = self.problem.whitened(point, noise)
        gradient = self.quantity.gradient(point)
        by_rest = -gradient[self.rest] / gradient[eliminated]
        return residual, columns[:, self.rest] + np.outer(columns[:, eliminated], by_rest)


def constrained_fit(solution, quantity, value, starts):
    """Point (k,), and deviance (< 0: better), of the best fit in which a quantity has this value.

    None where no start moves through the whole record.
    """
    problem = ConstrainedProblem(solution.problem, quantity, value)
    fits = []
    for start in starts:
        rest = np.clip(start[problem.rest], problem.unknowns.low, problem.unknowns.high)
        if fit := search(problem, rest, solution.noise, SEARCH_EVALUATIONS):
            fits.append(fit)
    best = min(fits, key=lambda fit: fit.cost, default=None)
    return best and (problem.point(best.x), 2.0 * float(best.cost) - solution.chi2)
