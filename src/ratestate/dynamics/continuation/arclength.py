"""Pseudo-arclength continuation of fixed points u = P(u, p) of a map through folds.

This module does not depend on the map.  Sources as in `newton`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .bifurcations import bifurcation_points, change, locate, without_noise
from .newton import NO_CONVERGENCE, Lost, Point, Problem, solve, unit

MAX_ROTATION = 0.2  # rad between the tangents of neighbouring points: some 15 points to a fold
MAX_CHANGE = 0.2  # of test functions of multipliers, which lie between -1 and 1
MAX_DEVIATION = 0.5  # of the prediction, in steps; farther away lies another branch
FAST = 4  # Newton iterations after which a step may still grow


class Steps(NamedTuple):
    """Lengths of steps along the branch, in units of scale + |u| and of p."""

    first: float = 0.02
    smallest: float = 1e-6
    largest: float = 0.2


STEPS = Steps()


class Branch(NamedTuple):
    """Fixed points in their order along a branch, and why it ends.

    `end` is "stop" or "start" (the last point has exactly this p, and this as `special`), "hopf"
    (at the last point `amplitude` is 0, or it is below and falling at the first), "no return"
    (the map has no image beyond), "no convergence" or "max_points".
    """

    points: list[Point]
    end: str


def follow(
    evaluate,
    u0,
    p0,
    *,
    stop,
    scale,
    start=None,
    along=None,
    amplitude=None,
    tol=1e-8,
    noise=1e-10,
    steps=STEPS,
    max_points=1000,
    progress=None,
):
    """Follow the branch of fixed points u = P(u, p) from (u0, p0) to p = stop.

    Parameters
    ----------
    evaluate : callable
        Of u (m, n) and p (m,), giving an object with ``image`` (m, n), P(u, p); ``jacobian``
        (m, n, n), dP/du; ``ok`` (m,), False where there is no image; ``measures``, name -> (m,),
        to store with each point.
    u0 : (n,) ndarray
        Near the fixed point at p0.
    p0, stop : float
        The branch ends where p gets to stop.
    scale : (n,) ndarray
        Size of u below which changes count as absolute and above which as relative, > 0.
    start : float, optional
        The branch also ends where p comes to this; p0, after a fold, if not given.
    along : (n + 1,) ndarray, optional
        Needed if start is given: about the direction (u, p) of the branch at (u0, p0), which is
        then only near its first point.
    amplitude : callable, optional
        Of a Point; the branch ends where it falls to 0.  Beyond lies a Hopf point, too near
        for a return map, which the caller computes otherwise: the last point has no ``special``.
    tol : float
        Largest last Newton correction, in units of scale + |u| and of p.
    noise : float
        Bound of the errors of P, in units of scale + |u|.
    steps : Steps
        Steps are shortened where the branch bends or multipliers change fast.
    max_points : int
        Points, special ones not counted, after which to give up.
    progress : callable, optional
        Of each new Point.

    Returns
    -------
    Branch
        Points of special ``fold``, ``period_doubling`` and ``torus`` lie where tests of
        multipliers vanish, to within noise.  No point at all if there is no fixed point at p0.
    """
    problem = Problem(evaluate, np.asarray(scale, float), tol, max(noise, np.finfo(float).eps))
    start = p0 if start is None else start
    towards = np.copysign(1.0, stop - start)
    ends = {
        "stop": End(lambda point: towards * (stop - point.p), stop),
        "start": End(lambda point: towards * (point.p - start), start),
    }
    if amplitude is not None:
        ends["hopf"] = End(amplitude, None)
    points: list[Point] = []

    def keep(new):
        points.extend(new)
        for point in new if progress else ():
            progress(point)

    end = ""
    try:
        y, weights = np.append(u0, p0), problem.weights(u0)
        a = (
            _at(problem, y, towards * _constant_p(y))
            if along is None
            else solve(problem, y, unit(along / weights), along, weights, tol)
        )
        keep([a])
        step = steps.first
        for _ in range(max_points - 1):
            new, end, a, step = _advance(problem, a, step, steps, ends)
            keep(new)
            if end:
                break
    except Lost as lost:
        end = lost.args[0]
    return Branch(without_noise(points), end or "max_points")


class End(NamedTuple):
    """A place where a branch ends."""

    distance: Callable[[Point], float]  # > 0 before the end
    p: float | None  # exact value at the last point


def _at(problem, guess, along):
    """The fixed point at exactly the p of `guess`."""
    weights = problem.weights(guess[:-1])
    return solve(problem, guess, _constant_p(guess), along, weights, problem.tol)


def _constant_p(y):
    """Normal of the plane of points with the same p."""
    return np.eye(len(y))[-1]


def _advance(problem, a, step, steps, ends):
    """One step from a, as long as possible up to `step`.

    Returns the points to keep, the end's name ("" if the branch goes on), the point where the next
    step starts, and its length.
    """
    while True:
        try:
            b, next_step = _predict_and_correct(problem, a, step, steps, ends)
            return *_points_between(problem, a, b, ends), b, next_step
        except Lost:
            if step <= steps.smallest:
                raise
            step = max(0.5 * step, steps.smallest)


def _predict_and_correct(problem, a, step, steps, ends):
    """The point that lies `step` ahead of a along its tangent, and the length of the next step.

    Where the tangent reaches the p of an end earlier, the point lies there; the map may end beyond.
    """
    weights = problem.weights(a.u)
    t = unit(a.tangent / weights)
    guess, normal = a.y + step * weights * t, t
    for p in (end.p for end in ends.values() if end.p is not None):
        gap = p - a.p
        if gap * t[-1] > 0 and abs(gap) <= step * abs(t[-1]):
            step = gap / t[-1]
            guess, normal = a.y + step * weights * t, _constant_p(t)
            guess[-1] = p
    b = solve(problem, guess, normal, t, weights, problem.tol)
    if np.linalg.norm((b.y - guess) / weights) > MAX_DEVIATION * step:
        raise Lost(NO_CONVERGENCE)
    rotation = np.arccos(min(t @ unit(b.tangent / weights), 1.0))
    strain = max(rotation / MAX_ROTATION, change(a, b) / MAX_CHANGE)
    if strain > 1 and step > steps.smallest:
        raise Lost(NO_CONVERGENCE)
    growth = min(2.0 if b.iterations <= FAST else 0.7, 0.7 / max(strain, 0.1))
    return b, float(np.clip(growth * step, steps.smallest, steps.largest))


def _points_between(problem, a, b, ends):
    """Points after a up to b: special points, and then b or the end of the branch before it.

    Returns the points, and the name of the end or "".
    """
    weights = problem.weights(a.u)
    kept: list[Point] = []
    last = a
    for point in [*bifurcation_points(problem, a, b, weights), b]:
        reached = []
        for name, end in ends.items():
            if end.distance(point) <= 0 < end.distance(last):
                reached.append((locate(problem, last, point, end.distance, weights), name))
            elif point is b and end.distance(b) <= min(0, end.distance(last)):
                raise Lost(name)  # the branch began beyond this end
        if reached:
            chord = (point.y - last.y) / weights**2
            final, name = min(reached, key=lambda item: chord @ item[0].y)
            if (p := ends[name].p) is not None:
                exact = _at(problem, np.append(final.u, p), final.tangent / weights)
                final = exact._replace(special=name)
            return [*kept, final], name
        kept.append(point)
        last = point
    return kept, ""
