"""Intervals of cycle fits from the profile of chi-squared, where it may be no parabola.

Where the features of cycles hardly tell parameters apart, the valley of chi-squared is long and
bent, and errors from its curvature at the bottom are too small on one side.  The profile of a
number is the least chi-squared of all fits in which it keeps a value.  A spring pulls the number
to that value rather than a clamp, which would make least squares creep along the bend: where they
come to rest chi-squared is the least for the value that the number has there.
"""

import numpy as np

from ..likelihood.profile import Better
from ..result import ROOTS
from .search import FLOOR, FTOL, NO_CYCLE

# Error of a logarithm below which the parabola is good enough.
SMALL = 0.08
# Stiffness of the spring, over that of a chi-squared that rises by 1 within a step.
SPRING = 4.0
# Most steps on a side, and evaluations in each; the longest first step of a coordinate.
STEPS, EVALUATIONS, FIRST = 8, 12, 0.5
# Bounds of a step over the one before, where chi-squared's root is to rise by 1 in each; the part
# of a step that the spring must achieve; a rise that tells of a step out of the valley.
SHORTER, LONGER, LEAST, LEAP = 0.3, 3.0, 0.1, 2.5
# A coordinate goes no farther from its estimate: a number has no end there, or this near to it.
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
    enlarged : factor by which errors are
    better : fall of chi-squared by which a point is better than the run

    Methods raise `Better` with the first such point.
    """

    def __init__(self, problem, run, names, covariance, errors, enlarged, better):
        self.problem, self.run, self.names = problem, run, names
        self.covariance, self.errors, self.enlarged = covariance, errors, enlarged
        self.better = better

    def intervals(self):
        """(p, levels, sides) ends in the numbers' own scale, inf where there is none; their kinds.

        A number needs a profile where it, or what mu0 and a - b follow, is known no better than
        `SMALL`.
        """
        size = self.problem.space.size
        worst = self.errors[:size].max()
        ends, kinds = [], []
        for i, error in enumerate(self.errors):
            here = self._value(i, self.run.end)
            plain = (error if i < size else worst) < SMALL
            kinds.append("covariance" if plain else "profile")
            ends.append(
                here + error * ROOTS[:, None] * np.array([-1.0, 1.0])
                if plain
                else np.stack([self._side(i, here, sign) for sign in (-1.0, 1.0)], axis=1)
            )
        return np.array(ends), tuple(kinds)

    def _is_mu0(self, i):
        return self.names[i] == "mu0"

    def _value(self, i, q):
        """The number i at coordinates q (k,): a logarithm, mu0 or a - b."""
        if self._is_mu0(i):
            return self.problem.best_mu0(q)
        return float(self.problem.space.number(self.names[i], q[None])[0])

    def _gradient(self, i, q):
        """(k,) derivative of `_value`."""
        if self._is_mu0(i):
            return self.problem.best_mu0_gradient(q)
        return self.problem.space.gradient(self.names[i], q)

    def _side(self, i, here, sign):
        """(levels,) ends on one side."""
        values, roots = [here], [0.0]
        q, gradient = self.run.end, self._gradient(i, self.run.end)
        lead = self.covariance[:-1, :-1] @ gradient
        lead = lead / max(float(gradient @ lead), 1e-300)
        step = min(self.errors[i], FIRST / np.abs(lead).max())
        for _ in range(STEPS):
            found = self._pulled(i, values[-1] + sign * step, q + sign * step * lead, step)
            moved = 0.0 if found is None else sign * (found[0] - values[-1])
            if moved < LEAST * step or found[2] > roots[-1] + LEAP:
                step *= SHORTER
                continue
            value, there, root = found
            lead = (there - q) / (value - values[-1])
            q, step = there, moved / np.clip(root - roots[-1], 1.0 / LONGER, 1.0 / SHORTER)
            values.append(value)
            roots.append(root)
            left = FAR - np.abs(q - self.run.end).max()
            if root > ROOTS[-1] or left < NEAR:
                break
            step = min(step, left / np.abs(lead).max())
        # where the root passes for the last time
        roots = np.minimum.accumulate(roots[::-1])[::-1] + 1e-9 * np.arange(len(roots))
        return np.where(roots[-1] < ROOTS, sign * np.inf, np.interp(ROOTS, roots, values))

    def _pulled(self, i, value, start, step):
        """Value, coordinates, root of the rise of chi-squared where number i is pulled to a value.

        None where there is no cycle.
        """
        from scipy.optimize import least_squares

        problem, spring = self.problem, SPRING * self.enlarged / step
        if not np.isfinite(problem.at(start)[0]).all():
            return None
        beyond = np.full(problem.levels.size + 2, NO_CYCLE)

        def pull(q):
            """Residual of the spring, its derivatives by q, and by mu0."""
            if self._is_mu0(i):
                return -spring * value, np.zeros(q.size), spring
            return spring * (self._value(i, q) - value), spring * self._gradient(i, q), 0.0

        def residual(q):
            far = np.abs(q - self.run.end).max() > FAR + NEAR
            return beyond if far else problem.residual(q, pull(q))

        def jacobian(q):
            return problem.jacobian(q, pull(q))

        found = least_squares(
            residual, start, jacobian, x_scale="jac", ftol=FTOL, xtol=1e-6, max_nfev=EVALUATIONS
        )
        reached = (
            problem.best_mu0(found.x, pull(found.x)) if self._is_mu0(i) else self._value(i, found.x)
        )
        chi2 = 2.0 * found.cost - FLOOR**2 - (spring * (reached - value)) ** 2
        if not chi2 < 1e12:
            return None
        if chi2 < self.run.chi2 - self.better:
            raise Better(found.x)
        rise = np.sqrt(max(chi2 - self.run.chi2, 0.0)) / self.enlarged
        return reached, found.x, float(rise)
