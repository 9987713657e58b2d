"""Pseudo-arclength continuation of fixed points u = P(u, p) of a map through folds.

This module does not depend on the map.  Sources as in `bifurcations`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .bifurcations import (
    NO_CONVERGENCE,
    BranchPoint,
    FixedPointProblem,
    StepFailed,
    bifurcation_points,
    change,
    fixed_point,
    locate,
    unit,
    without_noise,
)

MAX_ROTATION = 0.2  # rad between the tangents of neighbouring points: some 15 points to a fold
MAX_CHANGE = 0.2  # of test functions of multipliers, which lie between -1 and 1
MAX_DEVIATION = 0.5  # from the prediction, in steps; farther away lies another branch
FAST_ITERATIONS = 4  # Newton iterations up to which a step may still grow
# Lengths of steps, in units of scale + |u| and of p; with the largest a branch looks smooth.
FIRST_STEP, SMALLEST_STEP, LARGEST_STEP = 0.02, 1e-6, 0.06


class Branch(NamedTuple):
    """Fixed points in their order along a branch, and why it ends.

    `end` is "stop" or "start" (the last point has exactly this p, and this as `special`, unless the
    branch led away beyond "start" at once), "hopf" (at the last point `amplitude` is 0, or it is
    below and falling at the first), "no return" (the map has no image beyond), "no convergence" or
    "max_points".  Points of special "fold", "period_doubling" and "torus" lie where tests of
    multipliers vanish, to within noise.
    """

    points: list[BranchPoint]
    end: str


def follow_branch(
    problem, u0, p0, stop, *, start=None, along=None, amplitude=None, max_points=1000, progress=None
):
    """Return the `Branch` of fixed points from near (u0, p0) towards p = stop.

    It has no points, and the end "no return" or "no convergence", if none is found at p0.

    u0, p0, stop : (n,), float and float; that stop is not p0 is not checked
    start : the branch also ends if p comes to this after a fold; p0 by default
    along : needed with `start`: about the direction (u, p) at (u0, p0), which is then only near the
        first point
    amplitude : function of a `BranchPoint`; the branch also ends if it falls to 0, at a point
        without `special`, as beyond lies a Hopf point, too near for a return map
    max_points : how many to follow at most, not counting special ones
    progress : called with each new `BranchPoint`
    """
    start = p0 if start is None else start
    towards = np.copysign(1.0, stop - start)
    ends = {
        "stop": _End(lambda point: towards * (stop - point.p), stop),
        "start": _End(lambda point: towards * (point.p - start), start),
    }
    if amplitude is not None:
        ends["hopf"] = _End(amplitude, None)
    course = _Course(problem, ends)
    points: list[BranchPoint] = []
    end, y = "", np.append(u0, p0)
    try:
        if along is None:
            a = course.point_at(y, towards * _constant_p(y))
        else:
            weights = problem.weights(u0)
            a = fixed_point(problem, y, unit(along / weights), along, weights, problem.tol)
        new, step = [a], FIRST_STEP
        for count in range(1, max_points + 1):
            points.extend(new)
            for point in new if progress else ():
                progress(point)
            if end or count == max_points:
                break
            new, end, a, step = course.advance(a, step)
    except StepFailed as failure:
        end = failure.args[0]
    return Branch(without_noise(points), end or "max_points")


def _constant_p(y):
    """Return the normal of the plane of points with the same p."""
    return np.eye(len(y))[-1]


class _End(NamedTuple):
    """A place where a branch ends."""

    distance: Callable[[BranchPoint], float]  # > 0 before the end
    p: float | None  # exact value at the last point


class _Course(NamedTuple):
    """A branch under way: the map, and the ends by name."""

    problem: FixedPointProblem
    ends: dict[str, _End]

    def point_at(self, guess, along):
        """Return the `BranchPoint` at exactly the p of `guess` (n + 1,); `StepFailed` if none.

        along : (n + 1,) about the tangent there, in units of weights
        """
        weights, tol = self.problem.weights(guess[:-1]), self.problem.tol
        return fixed_point(self.problem, guess, _constant_p(guess), along, weights, tol)

    def advance(self, a, step):
        """Take one step from a, as long as possible up to `step`; `StepFailed` if none succeeds.

        Returns the list of points to keep, the end's name ("" if the branch goes on), the point
        where the next step starts, and its length.
        """
        while True:
            try:
                b, next_step = self._predict_and_correct(a, step)
                return *self._points_between(a, b), b, next_step
            except StepFailed:
                if step <= SMALLEST_STEP:
                    raise
                step = max(0.5 * step, SMALLEST_STEP)

    def _predict_and_correct(self, a, step):
        """Return the point that lies `step` ahead of a, and the length of the next step.

        If the tangent reaches the p of an end earlier, the point lies there; the map may end
        beyond.
        """
        weights = self.problem.weights(a.u)
        t = unit(a.tangent / weights)
        guess, normal = a.y + step * weights * t, t
        for p in (end.p for end in self.ends.values() if end.p is not None):
            gap = p - a.p
            if gap * t[-1] > 0 and abs(gap) <= step * abs(t[-1]):
                step = gap / t[-1]
                guess, normal = a.y + step * weights * t, _constant_p(t)
                guess[-1] = p
        b = fixed_point(self.problem, guess, normal, t, weights, self.problem.tol)
        if np.linalg.norm((b.y - guess) / weights) > MAX_DEVIATION * step:
            raise StepFailed(NO_CONVERGENCE)
        rotation = np.arccos(min(t @ unit(b.tangent / weights), 1.0))
        strain = max(rotation / MAX_ROTATION, change(a, b) / MAX_CHANGE)
        if strain > 1 and step > SMALLEST_STEP:
            raise StepFailed(NO_CONVERGENCE)
        growth = min(2.0 if b.iterations <= FAST_ITERATIONS else 0.7, 0.7 / max(strain, 0.1))
        return b, float(np.clip(growth * step, SMALLEST_STEP, LARGEST_STEP))

    def _points_between(self, a, b):
        """Return the special points after a, then b or an end before it; and the end's name."""
        weights = self.problem.weights(a.u)
        kept: list[BranchPoint] = []
        last = a
        for point in [*bifurcation_points(self.problem, a, b, weights), b]:
            reached = []
            for name, end in self.ends.items():
                if end.distance(point) <= 0 < end.distance(last):
                    found = locate(self.problem, last, point, end.distance, weights)
                    reached.append((found, name))
                elif point is b and end.distance(b) <= min(0, end.distance(last)):
                    raise StepFailed(name)  # the branch began beyond this end
            if reached:
                chord = (point.y - last.y) / weights**2
                final, name = min(reached, key=lambda item: chord @ item[0].y)
                if (p := self.ends[name].p) is not None:
                    exact = self.point_at(np.append(final.u, p), final.tangent / weights)
                    final = exact._replace(special=name)
                return [*kept, final], name
            kept.append(point)
            last = point
        return kept, ""
