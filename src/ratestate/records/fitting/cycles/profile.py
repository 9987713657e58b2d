"""Intervals of cycle fits from the profile of chi-squared, where it may be no parabola.

Where the features of cycles hardly distinguish parameters, the valley of chi-squared is long and
curved, and errors from its curvature at the bottom are too small on one side.  The profile of a
quantity is the least chi-squared of all fits in which it has a given value.  A quadratic penalty
holds the quantity near that value; with a strict constraint least squares would advance slowly
along the curve.  Where a search ends, chi-squared is the least for the quantity's value there.
"""

from typing import NamedTuple

import numpy as np

from ...kit.least_squares import minimum
from ..estimates import ROOTS
from ..likelihood.profile import BetterPoint
from .search import ENOUGH, Problem, Run

# Error of a logarithm below which the parabola is good enough.
SMALL = 0.08
# Weight of the penalty, over that of a chi-squared that rises by 1 within a step.
WEIGHT = 4.0
# Most steps on a side, and evaluations in each; the longest first step of a coordinate.
STEPS, EVALUATIONS, FIRST = 8, 12, 0.5
# Bounds of a step over the one before, chi-squared's root being meant to rise by 1 in each; part of
# a step that must be achieved; rise of the root that means a step out of the valley.
SHORTER, LONGER, LEAST, LEAP = 0.3, 3.0, 0.1, 2.5
# Farthest that a coordinate goes from its estimate: this near to it an interval counts as open.
FAR, NEAR = np.log(1e3), 0.5


def profiled_intervals(problem, run, errors, enlarged, better):
    """dict name -> (levels, sides) ends as of `Problem.value`, -inf or inf where open.

    A parameter needs a profile where its error is `SMALL` or more; mu0 and a - b where that of any
    parameter is.  Raises `BetterPoint` where a point of a profile fits better than the run.

    errors : dict, name -> error of the logarithm of a parameter, of mu0 and a - b
    enlarged : factor by which errors are enlarged
    better : fall of chi-squared by which a point is better
    """
    free = problem.space.names
    worst = max(errors[name] for name in free)
    intervals = {}
    for name, error in errors.items():
        if (error if name in free else worst) >= SMALL:
            estimate = problem.value(name, run.point)
            profile = _Profile(problem, run, name, estimate, error, enlarged, better)
            intervals[name] = np.stack([profile.side(-1.0), profile.side(1.0)], axis=1)
    return intervals


class _Profile(NamedTuple):
    """The profile of a quantity about a run."""

    problem: Problem
    run: Run
    name: str
    estimate: float
    error: float
    enlarged: float
    better: float

    def side(self, sign):
        """(levels,) ends on one side."""
        self.problem.near = self.run.near
        point, values, roots = self.run.point, [self.estimate], [0.0]
        gradient = self.problem.gradient(self.name, point)
        lead = self.enlarged**2 * self.run.covariance @ gradient
        lead = lead / max(float(gradient @ lead), 1e-300)
        step = min(self.error, FIRST / np.abs(lead[:-1]).max(initial=1e-300))
        for _ in range(STEPS):
            fit = self._penalized_fit(values[-1] + sign * step, point + sign * step * lead, step)
            moved = 0.0 if fit is None else sign * (fit[0] - values[-1])
            if moved < LEAST * step or fit[2] > roots[-1] + LEAP:
                step *= SHORTER
                continue
            value, end, root = fit
            lead = (end - point) / (value - values[-1])
            point, step = end, moved / np.clip(root - roots[-1], 1.0 / LONGER, 1.0 / SHORTER)
            values.append(value)
            roots.append(root)
            remaining = FAR - self._distance(point)
            if root > ROOTS[-1] or remaining < NEAR:
                break
            step = min(step, remaining / np.abs(lead[:-1]).max())
        # where the root passes for the last time
        roots = np.minimum.accumulate(roots[::-1])[::-1] + 1e-9 * np.arange(len(roots))
        return np.where(roots[-1] < ROOTS, sign * np.inf, np.interp(ROOTS, roots, values))

    def _distance(self, point):
        """Farthest that a coordinate of a point is from the run's end."""
        return np.abs(point - self.run.point)[:-1].max()

    def _penalized_fit(self, value, start, step):
        """Fit with the quantity near a value: value, point, root of the rise of chi-squared.

        None where there is no cycle.
        """
        problem, name = self.problem, self.name
        weight = WEIGHT * self.enlarged / step

        def with_penalty(point):
            residual, jacobian = problem.linearized(point)
            if self._distance(point) > FAR + NEAR:
                residual = np.full_like(residual, np.nan)
            penalty = weight * (problem.value(name, point) - value)
            by_point = weight * problem.gradient(name, point)
            return np.append(residual, penalty), np.vstack([jacobian, by_point])

        anywhere = np.full(start.size, np.inf)
        found = minimum(with_penalty, start, -anywhere, anywhere, EVALUATIONS, ENOUGH)
        if found is None:
            return None
        reached = problem.value(name, found.x)
        chi2 = 2.0 * found.cost - (weight * (reached - value)) ** 2
        if chi2 < self.run.chi2 - self.better:
            raise BetterPoint(found.x)
        return reached, found.x, float(np.sqrt(max(chi2 - self.run.chi2, 0.0)) / self.enlarged)
