"""Fixed points u = P(u, p) of a map of R^n with a parameter p: bordered Newton iteration.

Points y = (u, p) are measured in z = y/weights, with weights scale + |u| for u and 1 for p, so
that a step or an error is relative where u is large and absolute where it is small.

Source: Keller (1977), Numerical solution of bifurcation and nonlinear eigenvalue problems;
Kuznetsov (2023), Elements of Applied Bifurcation Theory, chapter 10, doi:10.1007/978-3-031-22007-4.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

NO_RETURN = "no return"
NO_CONVERGENCE = "no convergence"
MAX_ITERATIONS = 10
# Change of the image between neighbouring p, in weights, that counts as a jump; a kink, as where
# orbits graze a stop, is none.
JUMP = 0.01
# Of the step over which p is varied: where the map bends over the whole step.
SHORTER = 1 / 16


class Point(NamedTuple):
    """A fixed point on a branch."""

    u: np.ndarray  # (n,)
    p: float
    multipliers: np.ndarray  # (n,) complex eigenvalues of dP/du, by descending modulus
    special: str  # kind of bifurcation, or name of an end; "" elsewhere
    error: float  # the last Newton correction, or that due to noise, in units of weights
    measures: dict[str, float]  # of `Problem.evaluate` at this point
    tangent: np.ndarray  # (n + 1,) d(u, p)/ds, of length 1 in units of weights
    iterations: int

    @property
    def y(self):
        """The fixed point (u, p), shape (n + 1,)."""
        return np.append(self.u, self.p)


class Problem(NamedTuple):
    """The map, and the accuracy of its fixed points."""

    #: of u (m, n) and p (m,), giving an object with `image` (m, n), P(u, p); `jacobian` (m, n, n),
    #: dP/du; `ok` (m,), False where there is no image; `measures`, name -> (m,), to store
    evaluate: Callable[[np.ndarray, np.ndarray], Any]
    scale: np.ndarray  # (n,) > 0, size of u from which on changes count as relative
    tol: float  # largest last Newton correction, in units of scale + |u| and of p
    noise: float  # bound of the errors of P, in units of scale + |u|

    def weights(self, u):
        """Units (n + 1,) in which distances from (u, p) are measured; 1 for p."""
        return np.append(self.scale + np.abs(u), 1.0)


class StepFailed(Exception):
    """No point of the branch was found where one was sought: a shorter step may lead to one.

    reason : NO_RETURN, NO_CONVERGENCE or, where the branch leads away from one, an end's name
    """

    @property
    def reason(self):
        """Why: NO_RETURN, NO_CONVERGENCE or the name of an end."""
        return self.args[0]


def unit(vector):
    """The vector at length 1; NaN, with a warning, for the zero vector."""
    return vector / np.linalg.norm(vector)


def fixed_point(problem, guess, normal, along, weights, tol):
    """The fixed point, a `Point`, on the plane through `guess` that `normal` is perpendicular to.

    Solves P(u, p) - u = 0 and normal . (z - z_guess) = 0 by Newton's method.  The tangent
    points to the side of `along`, which like `normal` is in the coordinates z = y/weights; the last
    unit vector as `normal` keeps p exactly as it is.  tol = 0: as small as noise allows.

    Raises `StepFailed` where the map has no image, or Newton's method does not converge.
    """
    y, last = np.array(guess), np.inf
    for iteration in range(1, MAX_ITERATIONS + 1):
        orbit, rows = _linearised(problem, y, weights)
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


def _linearised(problem, y, weights):
    """The map at y, and the derivative (n, n + 1) of P(u, p) - u with respect to z.

    dP/dp is a central difference, or a one-sided one at the edge of where the map is defined.
    Its error slows Newton's method, but changes no fixed point and no fold of the branch, where
    the p component of the tangent vanishes whatever dP/dp is.  So its step is not the third root
    of the noise but the square root, which suits maps that vary fast with p; and less where the
    map bends so much over this step that noise matters less over a shorter one.
    """
    n = len(y) - 1
    step = np.sqrt(problem.noise)
    p = y[-1] + step * np.array([0.0, 1.0, -1.0, SHORTER, -SHORTER])
    orbit = problem.evaluate(np.tile(y[:-1], (len(p), 1)), p)
    defined = orbit.ok & np.isfinite(orbit.image).all(axis=1)
    if not (defined[0] and defined[1:3].any() and np.isfinite(orbit.jacobian[0]).all()):
        raise StepFailed(NO_RETURN)
    above, below = (1 if defined[1] else 0), (2 if defined[2] else 0)
    change, one_sided = orbit.image[above] - orbit.image[below], orbit.image[0] - orbit.image[below]
    unequal = np.abs(change - 2 * one_sided) > 0.9 * np.abs(change) + JUMP * weights[:-1]
    if defined[1:3].all() and unequal.any():
        raise StepFailed(NO_CONVERGENCE)  # a jump, which looks like a steep slope
    dP_dp = change / (p[above] - p[below])
    if defined.all():
        nearby = (orbit.image[3] - orbit.image[4]) / (p[3] - p[4])
        noise = problem.noise * weights[:-1] / (SHORTER * step)
        dP_dp = np.where(np.abs(nearby - dP_dp) > noise, nearby, dP_dp)
    return orbit, np.column_stack([orbit.jacobian[0] - np.eye(n), dP_dp]) * weights


def _point(orbit, y, error, tangent, iterations):
    multipliers = np.linalg.eigvals(orbit.jacobian[0]).astype(complex)
    return Point(
        u=y[:-1],
        p=float(y[-1]),
        multipliers=multipliers[np.argsort(-np.abs(multipliers), kind="stable")],
        special="",
        error=float(error),
        measures={name: float(values[0]) for name, values in orbit.measures.items()},
        tangent=tangent,
        iterations=iterations,
    )
