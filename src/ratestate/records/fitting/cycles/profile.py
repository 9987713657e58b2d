"""Intervals of cycle fits from the profile of chi-squared, where it may be no parabola.

Where the features of cycles hardly distinguish parameters, the valley of chi-squared is long and
curved, and errors from its curvature at the bottom are too small on one side.  The profile of a
quantity is the least chi-squared of all fits in which it has a given value.  A quadratic penalty
holds the quantity near that value; with a strict constraint least squares would advance slowly
along the curve.  Where a search ends, chi-squared is the least for the quantity's value there.
"""

import numpy as np

from ..estimates import ROOTS
from ..likelihood.profile import BetterPoint
from .search import FLOOR, FTOL, NO_CYCLE

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


class Profiles:
    """Profiles about the best run of a problem.

    Parameters
    ----------
    problem : Problem
    run : Run
    names : (p,) tuple of str, the free parameters first
    covariance : (k + 1, k + 1) of the coordinates and mu0
    errors : (p,) of the logarithms of the parameters, of mu0 and a - b
    enlarged : factor by which errors are enlarged
    better : fall of chi-squared by which a point is better than the run

    Methods raise `BetterPoint` with the first such point.
    """

    def __init__(self, problem, run, names, covariance, errors, enlarged, better):
        self.problem, self.run, self.names = problem, run, names
        self.covariance, self.errors, self.enlarged = covariance, errors, enlarged
        self.better = better

    def intervals(self):
        """(p, levels, sides) ends in the quantities' own scale, inf where open; their kinds.

        A parameter needs a profile where its error is `SMALL` or more; mu0 and a - b where that
        of any parameter is.
        """
        size = self.problem.space.size
        worst = self.errors[:size].max()
        ends, kinds = [], []
        for i, error in enumerate(self.errors):
            estimate = self._value(i, self.run.end)
            plain = (error if i < size else worst) < SMALL
            kinds.append("covariance" if plain else "profile")
            ends.append(
                estimate + error * ROOTS[:, None] * np.array([-1.0, 1.0])
                if plain
                else np.stack([self._side(i, estimate, sign) for sign in (-1.0, 1.0)], axis=1)
            )
        return np.array(ends), tuple(kinds)

    def _is_mu0(self, i):
        return self.names[i] == "mu0"

    def _value(self, i, q):
        """Quantity i at coordinates q (k,): a logarithm, mu0 or a - b."""
        if self._is_mu0(i):
            return self.problem.best_mu0(q)
        return float(self.problem.space.value(self.names[i], q[None])[0])

    def _gradient(self, i, q):
        """(k,) derivative of `_value`."""
        if self._is_mu0(i):
            return self.problem.best_mu0_gradient(q)
        return self.problem.space.gradient(self.names[i], q)

    def _side(self, i, estimate, sign):
        """(levels,) ends on one side."""
        values, roots = [estimate], [0.0]
        q, gradient = self.run.end, self._gradient(i, self.run.end)
        lead = self.covariance[:-1, :-1] @ gradient
        lead = lead / max(float(gradient @ lead), 1e-300)
        step = min(self.errors[i], FIRST / np.abs(lead).max())
        for _ in range(STEPS):
            fit = self._penalized_fit(i, values[-1] + sign * step, q + sign * step * lead, step)
            moved = 0.0 if fit is None else sign * (fit[0] - values[-1])
            if moved < LEAST * step or fit[2] > roots[-1] + LEAP:
                step *= SHORTER
                continue
            value, end, root = fit
            lead = (end - q) / (value - values[-1])
            q, step = end, moved / np.clip(root - roots[-1], 1.0 / LONGER, 1.0 / SHORTER)
            values.append(value)
            roots.append(root)
            remaining = FAR - np.abs(q - self.run.end).max()
            if root > ROOTS[-1] or remaining < NEAR:
                break
            step = min(step, remaining / np.abs(lead).max())
        # where the root passes for the last time
        roots = np.minimum.accumulate(roots[::-1])[::-1] + 1e-9 * np.arange(len(roots))
        return np.where(roots[-1] < ROOTS, sign * np.inf, np.interp(ROOTS, roots, values))

    def _penalized_fit(self, i, value, start, step):
        """Fit with quantity i near a value: value, coordinates, root of the rise of chi-squared.

        None where there is no cycle.
        """
        from scipy.optimize import least_squares

        problem, weight = self.problem, WEIGHT * self.enlarged / step
        if not np.isfinite(problem.linearized(start)[0]).all():
            return None
        no_cycle = np.full(problem.levels.size + 2, NO_CYCLE)

        def penalty(q):
            """Residual of the penalty, its derivatives by q, and by mu0."""
            if self._is_mu0(i):
                return -weight * value, np.zeros(q.size), weight
            return weight * (self._value(i, q) - value), weight * self._gradient(i, q), 0.0

        def residual(q):
            far = np.abs(q - self.run.end).max() > FAR + NEAR
            return no_cycle if far else problem.residual(q, penalty(q))

        def jacobian(q):
            return problem.jacobian(q, penalty(q))

        result = least_squares(
            residual, start, jacobian, x_scale="jac", ftol=FTOL, xtol=1e-6, max_nfev=EVALUATIONS
        )
        reached = (
            problem.best_mu0(result.x, penalty(result.x))
            if self._is_mu0(i)
            else self._value(i, result.x)
        )
        chi2 = 2.0 * result.cost - FLOOR**2 - (weight * (reached - value)) ** 2
        if not chi2 < 1e12:
            return None
        if chi2 < self.run.chi2 - self.better:
            raise BetterPoint(result.x)
        rise = np.sqrt(max(chi2 - self.run.chi2, 0.0)) / self.enlarged
        return reached, result.x, float(rise)
