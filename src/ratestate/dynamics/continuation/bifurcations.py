"""Find points of a branch by Newton's method, and the bifurcations between them.

The map P of R^n has one parameter p; this module does not depend on the map.  Points y = (u, p) are
measured in z = y/weights, with weights scale + |u| for u and 1 for p, so that a step or an error is
relative where u is large and absolute where it is small.

At a bifurcation a multiplier crosses the unit circle, and a test function changes sign.  Factors
like 1 + m are divided by 1 + |m|, so that multipliers from 1e-300 to 1e6 leave test functions of
order 1.

Sources: Keller (1977), Numerical solution of bifurcation and nonlinear eigenvalue problems;
Kuznetsov (2023), Elements of Applied Bifurcation Theory, chapter 10, doi:10.1007/978-3-031-22007-4.
"""

from collections.abc import Callable
from itertools import combinations, pairwise
from typing import Any, NamedTuple

import numpy as np

NO_RETURN = "no return"
NO_CONVERGENCE = "no convergence"
MAX_ITERATIONS, MAX_SECANTS = 10, 100
# Change of the image between neighbouring p, in weights, that counts as a jump; a kink, as where
# orbits graze a stop, is not one.
JUMP = 0.01
# Part of the step over which p is varied, if the map bends over the whole step.
SHORTER_PART = 1 / 16


class BranchPoint(NamedTuple):
    """A fixed point on a branch."""

    u: np.ndarray  # (n,)
    p: float
    multipliers: np.ndarray  # (n,) complex eigenvalues of dP/du, by descending modulus
    special: str  # kind of bifurcation, or name of an end; "" elsewhere
    error: float  # the last Newton correction, or the effect of noise, in units of weights
    measures: dict[str, float]  # of `FixedPointProblem.evaluate` at this point
    tangent: np.ndarray  # (n + 1,) d(u, p)/ds, of length 1 in units of weights
    iterations: int

    @property
    def y(self):
        """The fixed point (u, p), shape (n + 1,)."""
        return np.append(self.u, self.p)


class FixedPointProblem(NamedTuple):
    """The map, and the accuracy of its fixed points."""

    #: of u (m, n) and p (m,), giving an object with `image` (m, n), P(u, p); `jacobian` (m, n, n),
    #: dP/du; `ok` (m,), False if there is no image; `measures`, name -> (m,), to store
    evaluate: Callable[[np.ndarray, np.ndarray], Any]
    scale: np.ndarray  # (n,) > 0, size of u from which on changes count as relative
    tol: float  # largest last Newton correction, in units of scale + |u| and of p
    noise: float  # bound of the errors of P, in units of scale + |u|

    def weights(self, u):
        """Return the units (n + 1,) of distances from (u, p); 1 for p."""
        return np.append(self.scale + np.abs(u), 1.0)


class StepFailed(Exception):
    """No point of the branch was found; a shorter step may lead to one.

    The argument is the reason: NO_RETURN, NO_CONVERGENCE or the name of an end.
    """


def unit(vector):
    """Return the vector at length 1."""
    return vector / np.linalg.norm(vector)


def fixed_point(problem, guess, normal, along, weights, tol):
    """Return the `BranchPoint` on the plane through `guess` that is perpendicular to `normal`.

    Newton's method solves P(u, p) - u = 0 and normal . (z - z_guess) = 0.  `normal` and `along` are
    in the coordinates z; the last unit vector as `normal` keeps p exactly as it is.  The tangent
    points to the side of `along`.  tol = 0 asks for the accuracy that noise allows.

    Raises `StepFailed` if the map has no image or Newton's method does not converge.
    """
    y, last = np.array(guess), np.inf
    for iteration in range(1, MAX_ITERATIONS + 1):
        orbit, rows = _linearised_map(problem, y, weights)
        size = np.abs(rows).max(axis=1)  # multipliers spread the rows over decades
        residual = np.append((orbit.image[0] - y[:-1]) / size, normal @ ((y - guess) / weights))
        try:
            inverse = np.linalg.inv(np.vstack([rows / size[:, None], normal]))
        except np.linalg.LinAlgError:
            break
        correction = -inverse @ residual
        noise = np.append(weights[:-1] * problem.noise / size, 0.0)
        floor = np.linalg.norm(np.abs(inverse) @ noise)
        step = float(np.linalg.norm(correction))
        if floor > max(tol, np.sqrt(problem.noise)):
            break  # as at constant p beside a fold, where noise decides if a solution exists
        stagnant = step > 0.5 * last
        if step <= max(tol, 10.0 * floor if stagnant else floor):
            direction = np.linalg.svd(rows / size[:, None])[2][-1]
            tangent = weights * np.copysign(1.0, direction @ along) * direction
            return _point(orbit, y, max(step, floor), tangent, iteration)
        if stagnant or not np.isfinite(step):
            break
        y, last = y + weights * correction, step
    raise StepFailed(NO_CONVERGENCE)


def _linearised_map(problem, y, weights):
    """Return the map at y, and the derivative (n, n + 1) of P(u, p) - u with respect to z.

    dP/dp is a central difference, or a one-sided one at the edge of where the map is defined.
    Its error slows Newton's method, but changes no fixed point and no fold of the branch, where
    the p component of the tangent vanishes whatever dP/dp is.  So its step is not the third root
    of the noise but the square root, which suits maps that vary fast with p.  It is shorter if the
    map bends so much over this step that noise matters less over a shorter one.
    """
    n = len(y) - 1
    step = np.sqrt(problem.noise)
    p = y[-1] + step * np.array([0.0, 1.0, -1.0, SHORTER_PART, -SHORTER_PART])
    orbit = problem.evaluate(np.tile(y[:-1], (len(p), 1)), p)
    defined = orbit.ok & np.isfinite(orbit.image).all(axis=1)
    if not (defined[0] and defined[1:3].any() and np.isfinite(orbit.jacobian[0]).all()):
        raise StepFailed(NO_RETURN)
    upper, lower = (1 if defined[1] else 0), (2 if defined[2] else 0)
    change, one_sided = orbit.image[upper] - orbit.image[lower], orbit.image[0] - orbit.image[lower]
    unequal = np.abs(change - 2 * one_sided) > 0.9 * np.abs(change) + JUMP * weights[:-1]
    if defined[1:3].all() and unequal.any():
        raise StepFailed(NO_CONVERGENCE)  # a jump, which looks like a steep slope
    dP_dp = change / (p[upper] - p[lower])
    if defined.all():
        slope_at_ends = (orbit.image[3] - orbit.image[4]) / (p[3] - p[4])
        noise = problem.noise * weights[:-1] / (SHORTER_PART * step)
        dP_dp = np.where(np.abs(slope_at_ends - dP_dp) > noise, slope_at_ends, dP_dp)
    return orbit, np.column_stack([orbit.jacobian[0] - np.eye(n), dP_dp]) * weights


def _point(orbit, y, error, tangent, iterations):
    multipliers = np.linalg.eigvals(orbit.jacobian[0]).astype(complex)
    return BranchPoint(
        u=y[:-1],
        p=float(y[-1]),
        multipliers=multipliers[np.argsort(-np.abs(multipliers), kind="stable")],
        special="",
        error=float(error),
        measures={name: float(values[0]) for name, values in orbit.measures.items()},
        tangent=tangent,
        iterations=iterations,
    )


# Bifurcations


def fold(point):
    """Return dp/ds, which changes sign if the branch turns back in p.

    As dp/ds is proportional to det(1 - dP/du), a multiplier is 1 there.  If branches merely cross,
    a multiplier is 1 as well, but dp/ds keeps its sign.
    """
    return point.tangent[-1]


def period_doubling(point):
    """Return a number from -1 to 1 that changes sign if a multiplier passes -1."""
    m = point.multipliers
    return np.prod((1 + m) / (1 + np.abs(m))).real


def torus(point):
    """Return a number from -1 to 1 that changes sign if the product of two multipliers passes 1.

    It is a Neimark-Sacker bifurcation if they are complex.
    """
    products = np.array([m * n for m, n in combinations(point.multipliers, 2)])
    return np.prod((products - 1) / (1 + np.abs(products))).real


def saddle(point):
    """Return a number from -1 to 1 that changes sign if a multiplier passes 1."""
    m = point.multipliers
    return np.prod((1 - m) / (1 + np.abs(m))).real


TESTS = {"fold": fold, "period_doubling": period_doubling, "torus": torus}


def change(a, b):
    """Return how much the multipliers of two points differ, from 0 to 2."""
    return max(abs(test(b) - test(a)) for test in (saddle, period_doubling, torus))


def bifurcation_points(problem, a, b, weights):
    """Return the bifurcations between neighbouring points of a branch, in order, a list.

    Each is a `BranchPoint` with the name of the bifurcation as `special`, as near to it as rounding
    and noise allow.  The tangents at a and b must make an acute angle.  Raises `StepFailed` if one
    that must exist is not found.
    """
    points = []
    for name, test in TESTS.items():
        if (test(a) > 0) == (test(b) > 0):
            continue
        point = locate(problem, a, b, test, weights)
        # With two real multipliers m and 1/m it is a neutral saddle, not a torus bifurcation.
        if name != "torus" or _is_pair(point):
            points.append(point._replace(special=name))
    chord = (b.y - a.y) / weights**2
    return sorted(points, key=lambda point: chord @ point.y)


def _is_pair(point):
    """Return whether the two multipliers whose product is nearest to 1 are a conjugate pair."""
    pairs = combinations(point.multipliers, 2)
    first, second = min(pairs, key=lambda pair: abs(pair[0] * pair[1] - 1))
    return first.imag != 0 and second == first.conjugate()


def stable_pieces(special, stable):
    """Return whether cycles are stable on each piece (n - 1,) between two points of a branch.

    special, stable : (n,) as `continue_cycle` returns them
    """
    # If a multiplier is on the unit circle, rounding would decide whether the point is stable.
    counts = stable.astype(bool) | np.isin(special, ["hopf", *TESTS])
    return counts[:-1] & counts[1:]


def without_noise(points):
    """Return the branch without folds between which p varies by no more than its error.

    If p is all but constant, as near a degenerate Hopf point, noise makes it turn back.  Then two
    folds, or a fold and an end, are that close in p, and the folds become ordinary points.
    """
    points = list(points)
    while True:
        folds = [i for i, point in enumerate(points) if point.special == "fold"]
        for i, j in pairwise([0, *folds, len(points) - 1]):
            ends = [k for k in (i, j) if k in folds]
            p = [point.p for point in points[i : j + 1]]
            if ends and max(p) - min(p) <= max(points[k].error for k in ends):
                break
        else:
            return points
        for k in ends:
            points[k] = points[k]._replace(special="")


def locate(problem, a, b, test, weights):
    """Return the `BranchPoint` between a and b where the function `test` of a point is 0.

    Its sign at a and at b must differ, which is not checked.  The method is false position by
    `illinois` in the distance along the chord, with each trial on the branch.  Raises `StepFailed`
    if a trial is not found, or after `MAX_SECANTS` of them.
    """
    chord = (b.y - a.y) / weights
    length, normal = np.linalg.norm(chord), unit(chord)
    low, high, f_low, f_high = 0.0, length, test(a), test(b)
    last, side = np.inf, 0
    for _ in range(MAX_SECANTS):
        s = (low * f_high - high * f_low) / (f_high - f_low)
        guess = _hermite(a, b, normal, length, weights, s / length)
        point = fixed_point(problem, guess, normal, normal, weights, tol=0.0)
        f = test(point)
        if f == 0 or abs(s - last) <= point.error:
            return point
        f_low, f_high, side = illinois(f_low, f_high, f, side)
        low, high = (low, s) if side > 0 else (s, high)
        last = s
    raise StepFailed(NO_CONVERGENCE)


def illinois(low, high, new, side):
    """Return the values at both ends of brackets after a trial, and the end it replaced: -1, 1.

    It replaces the end whose sign it has; the other value is halved if that end stays a second time
    (the Illinois method, Dowell & Jarratt 1971, doi:10.1007/BF01934364).

    low, high, new : (n,) or float; low and high of opposite signs, which is not checked
    side : the end that the previous trial replaced, or 0
    """
    is_high = (new > 0) == (high > 0)
    kept_low, kept_high = np.where(side > 0, 0.5 * low, low), np.where(side < 0, 0.5 * high, high)
    sides = np.where(is_high, 1, -1)
    return np.where(is_high, kept_low, new), np.where(is_high, new, kept_high), sides


def _hermite(a, b, normal, length, weights, x):
    """Return the cubic through a (x = 0) and b (x = 1) with their tangents."""
    slope_a = a.tangent * length / (normal @ (a.tangent / weights))
    slope_b = b.tangent * length / (normal @ (b.tangent / weights))
    rise = b.y - a.y
    deviation = (1 - x) * (slope_a - rise) - x * (slope_b - rise)
    return a.y + x * rise + x * (1 - x) * deviation
