"""Intervals of cycle fits from the profile of chi-squared, where it is not a parabola.

Where the features of cycles hardly tell parameters apart, the valley of chi-squared is long and
bent, and errors from its curvature at the bottom are too small on one side.  The profile of a
number is the least chi-squared of all fits in which it keeps a value.
"""

import numpy as np

from ..result import ROOTS
from .search import FLOOR, FTOL

# Error of a logarithm below which the parabola is good enough.
SMALL = 0.08
# Beyond this nothing is known, and no end would mean much.
LARGE = 1.0
# Weight that holds a number at its value; most steps on a side, and evaluations in each.
HOLD, STEPS, EVALUATIONS = 1e4, 10, 12
# A logarithm this far from its estimate has no end there.
FAR = np.log(1e3)


class Profiles:
    """Profiles about the best run of a problem.

    Parameters
    ----------
    problem : Problem
    run : Run
    names : tuple of str, free parameters and then mu0
    covariance : (k + 1, k + 1) of the coordinates and mu0
    errors : (k + 1,) of the logarithms of the parameters, and of mu0
    enlarged : factor by which errors are
    """

    def __init__(self, problem, run, names, covariance, errors, enlarged):
        self.problem, self.run, self.names = problem, run, names
        self.covariance, self.errors, self.enlarged = covariance, errors, enlarged

    def value(self, i, q):
        """The number i at coordinates q (k,): a logarithm, or mu0."""
        if self.names[i] == "mu0":
            return self.problem.best_mu0(q)
        return float(np.log(self.problem.space.values(q[None])[self.names[i]][0]))

    def ends(self, i):
        """(levels, sides) ends of the intervals of number i, in its own scale; inf: none there."""
        here = self.value(i, self.run.end)
        error = self.errors[:-1].max() if self.names[i] == "mu0" else self.errors[i]
        if not SMALL < error < LARGE:
            return here + self.errors[i] * ROOTS[:, None] * np.array([-1.0, 1.0])
        return np.stack([self._side(i, here, sign) for sign in (-1.0, 1.0)], axis=1)

    def _side(self, i, here, sign):
        """(levels,) ends on one side."""
        values, roots = [here], [0.0]
        q, step = self.run.end, min(self.errors[i], 0.3 if self.names[i] != "mu0" else np.inf)
        gradient = self._gradient(i, q)
        lead = self.covariance[:-1, :-1] @ gradient
        lead = lead / max(float(gradient @ lead), 1e-300)
        for _ in range(STEPS):
            value = values[-1] + sign * step
            found = self._held(i, value, q + lead * (value - values[-1]))
            if found is None:
                step *= 0.5
                continue
            root = float(np.sqrt(max(found[1] - self.run.chi2, 0.0))) / self.enlarged
            lead = (found[0] - q) / (value - values[-1])
            rise = max(root - roots[-1], 0.2)
            q, step = found[0], step * float(np.clip(1.0 / rise, 0.3, 2.5))
            values.append(value)
            roots.append(max(root, roots[-1] + 1e-9))
            if root > ROOTS[-1] or (self.names[i] != "mu0" and abs(value - here) > FAR):
                break
        ends = np.interp(ROOTS, roots, values)
        return np.where(roots[-1] < ROOTS, sign * np.inf, ends)

    def _gradient(self, i, q):
        step = 1e-3 * np.eye(q.size)
        return np.array([(self.value(i, q + h) - self.value(i, q - h)) / 2e-3 for h in step])

    def _held(self, i, value, start):
        """Coordinates and chi-squared of the best fit with number i at a value; None: no cycle."""
        from scipy.optimize import least_squares

        problem = self.problem
        if not np.isfinite(problem.at(start)[0]).all():
            return None

        def residual(q):
            if self.names[i] == "mu0":
                return np.append(problem.with_level(q, value), FLOOR)
            return np.append(problem.residual(q), HOLD * (self.value(i, q) - value))

        def jacobian(q):
            if self.names[i] == "mu0":
                return np.vstack([np.nan_to_num(problem.at(q)[1]), np.zeros(q.size)])
            return np.vstack([problem.jacobian(q), HOLD * self._gradient(i, q)])

        found = least_squares(
            residual, start, jacobian, x_scale="jac", ftol=FTOL, xtol=1e-6, max_nfev=EVALUATIONS
        )
        chi2 = 2.0 * found.cost - FLOOR**2
        return (found.x, chi2) if chi2 < 1e12 else None
