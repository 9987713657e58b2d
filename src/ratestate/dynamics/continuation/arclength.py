"""Pseudo-arclength continuation of fixed points u = P(u, p) of a map through folds.

This module does not depend on the map.  Sources as in `newton`.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .bifurcations import bifurcation_points, change, locate, without_noise
from .newton import NO_CONVERGENCE, Point, Problem, StepFailed, fixed_point, unit

MAX_ROTATION = 0.2  # rad between the tangents of neighbouring points: some 15 points to a fold
MAX_CHANGE = 0.2  # of test functions of multipliers, which lie between -1 and 1
MAX_DEVIATION = 0.5  # of the prediction, in steps; farther away lies another branch
FAST = 4  # Newton iterations after which a step may still grow


class Steps(NamedTuple):
    """Lengths of steps along the branch, in units of scale + |u| and of p; not checked.

    They are shortened where the branch bends or multipliers change fast.
    """

    first: float = 0.02
    smallest: float = 1e-6
    largest: float = 0.2


class Options(NamedTuple):
    """How a branch is followed, and where it ends besides at stop."""

    steps: Steps = Steps()
    #: also ends where p comes to this; at p0, after a fold, if not given
    start: float | None = None
    #: needed with `start`: about the direction (u, p) at (u0, p0), which is then only near the
    #: first point
    along: np.ndarray | None = None
    #: of a Point; also ends where this falls to 0.  Beyond lies a Hopf point, too near for a return
    #: map, which the caller computes otherwise: the last point has no `special`
    amplitude: Callable[[Point], float] | None = None
    #: after which to give up, special ones not counted
    max_points: int = 1000
    #: called with each new Point
    progress: Any = None


class Branch(NamedTuple):
    """Fixed points in their order along a branch, and why it ends.

    `end` is "stop" or "start" (the last point has exactly this p, and this as `special`, unless the
    branch led away beyond "start" at once), "hopf"
    (at the last point `amplitude` is 0, or it is below and falling at the first), "no return"
    (the map has no image beyond), "no convergence" or "max_points".  Points of special "fold",
    "period_doubling" and "torus" lie where tests of multipliers vanish, to within noise.
    """

    points: list[Point]
    end: str


def follow_branch(problem, u0, p0, stop, **settings):
    """`Branch` of fixed points from near (u0, p0) towards p = stop.

    No points, and the end "no return" or "no convergence", if none is found at p0.

    u0, p0, stop : (n,), float and float; that stop is not p0 is not checked
    settings : fields of `Options`
    """
    options = Options(**settings)
    start = p0 if options.start is None else options.start
    towards = np.copysign(1.0, stop - start)
    ends = {
        "stop": End(lambda point: towards * (stop - point.p), stop),
        "start": End(lambda point: towards * (point.p - start), start),
    }
    if options.amplitude is not None:
        ends["hopf"] = End(options.amplitude, None)
    course = Course(problem, ends, options.steps)
    points: list[Point] = []
    end, y, along = "", np.append(u0, p0), options.along
    try:
        if along is None:
            a = course.point_at(y, towards * _constant_p(y))
        else:
            weights = problem.weights(u0)
            a = fixed_point(problem, y, unit(along / weights), along, weights, problem.tol)
        new, step = [a], options.steps.first
        for count in range(1, options.max_points + 1):
            points.extend(new)
            for point in new if options.progress else ():
                options.progress(point)
            if end or count == options.max_points:
                break
            new, end, a, step = course.advance(a, step)
    except StepFailed as failure:
        end = failure.reason
    return Branch(without_noise(points), end or "max_points")


class End(NamedTuple):
    """A place where a branch ends."""

    distance: Callable[[Point], float]  # > 0 before the end
    p: float | None  # exact value at the last point


def _constant_p(y):
    """Normal of the plane of points with the same p."""
    return np.eye(len(y))[-1]


class Course(NamedTuple):
    """A branch under way: the map, the ends by name, and the lengths of steps."""

    problem: Problem
    ends: dict[str, End]
    steps: Steps

    def point_at(self, guess, along):
        """The fixed point, a `Point`, at exactly the p of `guess` (n + 1,); StepFailed without one.

        along : (n + 1,) about the tangent there, in units of weights
        """
        weights, tol = self.problem.weights(guess[:-1]), self.problem.tol
        return fixed_point(self.problem, guess, _constant_p(guess), along, weights, tol)

    def advance(self, a, step):
        """One step from a, as long as possible up to `step`.

        Returns the list of points to keep, the end's name ("" if the branch goes on), the point
        where the next step starts, and its length.  StepFailed where the smallest step fails too.
        """
        while True:
            try:
                b, next_step = self._predict_and_correct(a, step)
                return *self._points_between(a, b), b, next_step
            except StepFailed:
                if step <= self.steps.smallest:
                    raise
                step = max(0.5 * step, self.steps.smallest)

    def _predict_and_correct(self, a, step):
        """The point that lies `step` ahead of a along its tangent, and the length of the next step.

        Where the tangent reaches the p of an end earlier, the point lies there; the map may end
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
        if strain > 1 and step > self.steps.smallest:
            raise StepFailed(NO_CONVERGENCE)
        growth = min(2.0 if b.iterations <= FAST else 0.7, 0.7 / max(strain, 0.1))
        return b, float(np.clip(growth * step, self.steps.smallest, self.steps.largest))

    def _points_between(self, a, b):
        """Special points after a, then b or an end before it; the end's name or ""."""
        weights = self.problem.weights(a.u)
        kept: list[Point] = []
        last = a
        for point in [*bifurcation_points(self.problem, a, b, weights), b]:
            reached = []
            for name, end in self.ends.items():
                if end.distance(point) <= 0 < end.distance(last):
                    where = locate(self.problem, last, point, end.distance, weights)
                    reached.append((where, name))
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
