"""The points of a branch to full accuracy, each with the parameter to which it belongs.

A branch is followed with returns only as fine as its shape needs.  Where amplitudes change much
faster than the parameter, as on a canard or beside a fold, a small error of a point is then a large
error of the cycle at its parameter.  So finer returns correct point and parameter together, at
right angles to the branch, and the remaining error is projected along the branch back to the
parameter:

    P(u, p) - u = 0,    n . d(u, p) = 0,    p the parameter's logarithm

where n has the branch's own direction, or that of p where p is fixed.
"""

from typing import NamedTuple

import numpy as np

from ..cycles.attractor import single_returns
from ..cycles.search_step import FINER
from ..cycles.sensitivity import (
    backward_error,
    coarser_orbits,
    difference,
    orbits_of_one_period,
    parameter_derivatives,
    stiffness_derivatives,
)
from ..cycles.shooting import change_along, effective_tolerance, solve_each
from ..cycles.system import select, tightest

# Corrections of one point, each with finer returns or nearer to the branch than the last.
MAX_CORRECTIONS = 12
# Of the error estimate.
SAFETY = 3.0
# Farthest that a point moves, in units of its weights: farther away lies another branch.
FARTHEST = 0.1


class Points(NamedTuple):
    """n points of a branch; arrays change in place."""

    u: np.ndarray  # (n, k) psi and G at the stress maximum
    parameter: np.ndarray  # (n,) [SI]
    tol: np.ndarray  # (n,) tolerance of the returns
    last: np.ndarray  # (n,) that of the returns before
    period: np.ndarray  # (n,)
    #: (n, 4) of `sensitivity.Orbits.measures` at this parameter; inf where none could be estimated
    errors: np.ndarray


class Shape(NamedTuple):
    """The branch at each of n points, in the coordinates (psi, G, p)/weights."""

    weights: np.ndarray  # (n, k + 1)
    direction: np.ndarray  # (n, k + 1) of length 1
    curvature: np.ndarray  # (n,) |d/ds| of the direction's p component
    fixed_p: np.ndarray  # (n,) whether p is fixed


class Correction(NamedTuple):
    """One step of Newton's method at n points, and the errors that it leaves."""

    step: np.ndarray  # (n, k + 1) of psi, G and p, onto the branch; not finite where there is none
    moved: np.ndarray  # (n, 4) changes of the measures, at constant p, by the step
    error: np.ndarray  # (n, 4) the same by the errors of a return
    along: np.ndarray  # (n, 4) the same by a unit of length along the branch
    tol: np.ndarray  # (n,) tolerance that the returns kept
    period: np.ndarray  # (n,)


def polished(family, points, exact):
    """`Points` of a branch of a `family.Family`, from `newton.Point`s in their order along it.

    A point whose next correction is not finite, or too long, stays as it is, with the errors found
    so far: inf before the first correction.

    exact : special of a point -> the exact value of its parameter [SI]
    """
    special = np.array([point.special for point in points], dtype=str)
    now, shape = _as_followed(family, points, special, exact)
    # A fold is where the branch turns back; its position along the branch has this error.
    located = np.where(special == "fold", [point.error for point in points], 0.0)
    rows, moved = np.arange(len(points)), np.full(len(points), np.inf)
    for number in range(MAX_CORRECTIONS):
        correction = _correction(family, select(now, rows), select(shape, rows))
        near = np.abs(correction.step / shape.weights[rows]).max(axis=1) < FARTHEST
        near &= np.isfinite(correction.moved + correction.error).all(axis=1)
        rows, correction = rows[near], select(correction, near)
        now.u[rows] += correction.step[:, :-1]
        now.parameter[rows] *= 1.0 + correction.step[:, -1]
        now.period[rows] = correction.period
        finer = correction.tol / np.maximum(now.last[rows], correction.tol)
        errors = SAFETY * (finer[:, None] * correction.moved + correction.error)
        now.errors[rows] = errors + located[rows, None] * correction.along
        # Correct again with finer returns; at the finest, as long as steps become shorter.  The
        # first step is longer than errors of returns: the branch was followed less closely.
        floor = tightest(family.sliders(now.parameter[rows]), now.u[rows])
        error, by_step = now.errors[rows, :2].max(axis=1), correction.moved[:, :2].max(axis=1)
        converging = by_step < 0.5 * moved[rows]
        again = (error > family.rtol) | (number == 0)
        again &= (now.tol[rows] > floor) | converging
        moved[rows], now.last[rows] = by_step, now.tol[rows]
        rows, floor, error = rows[again], floor[again], error[again]
        if not len(rows):
            break
        finer = np.clip(family.rtol / error, 0.01, 0.3) * now.tol[rows]
        now.tol[rows] = np.maximum(finer, floor)
    return now


def _as_followed(family, points, special, exact):
    """`Points` and `Shape` of the branch as it was followed, with parameters that are exact."""
    p = np.array([point.p for point in points])
    k = len(family.smallest)
    U = np.array([point.u for point in points]).reshape(-1, k)
    direction = np.array([point.tangent for point in points]).reshape(-1, k + 1)
    direction = direction / np.column_stack([family.scale(U), np.ones(len(p))])
    curvature = np.zeros(len(p))
    if len(p) > 1:  # over both neighbours, of which one may be all but the same point
        position = np.column_stack([U / family.scale(U), p])
        length = np.linalg.norm(np.diff(position, axis=0), axis=1)
        change = np.abs(np.diff(direction[:, -1]))
        curvature = np.convolve(change, [1.0, 1.0]) / np.convolve(length, [1.0, 1.0])
    shape = Shape(family.weights(U, p), direction, curvature, np.isin(special, list(exact)))
    u, parameter = family.points(U, p), np.exp(p)
    for name, value in exact.items():
        parameter[special == name] = value
    last = family.tolerance(u, p)
    tol = np.maximum(FINER * last, tightest(family.sliders(parameter), u))
    period = np.array([point.measures["period"] for point in points])
    return Points(u, parameter, tol, last, period, np.full((len(p), 4), np.inf)), shape


def _correction(family, now, shape):
    """`Correction` of `Points` of this shape."""
    system = family.sliders(now.parameter)
    orbits = orbits_of_one_period(system, single_returns(now.u, now.tol, now.period), now.tol)
    coarse, finer = coarser_orbits(orbits, now.last)
    by_steps, finer = difference(coarse, orbits), finer[:, None]
    by_p = parameter_derivatives(orbits, lambda by: family.sliders(now.parameter * by))
    by_K = by_p if family.parameter == "K" else stiffness_derivatives(orbits)
    returns, reached = orbits.returns, effective_tolerance(orbits.returns, now.tol)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        plane = _linearised(orbits, by_p, shape)
        step = plane.closing(now.u - returns.image)
        # As the effects of v and psi all but cancel where b/a is near 1, errors weigh more there.
        equivalent = backward_error(system, reached * system.cancellation)[:, None]
        error = plane.at_p(equivalent * plane.closing(-by_K.image), equivalent * by_K.measures)
        # Errors that steps accumulate need not be equivalent to any change of K.
        error += plane.at_p(finer * plane.closing(-by_steps.image), finer * by_steps.measures)
        moved, period = plane.at_p(step), returns.numbers["period"]
        return Correction(step, moved, error, plane.along, reached, period)


class Linearised(NamedTuple):
    """The branch near n points of it, to first order in psi, G and p."""

    #: (n, k + 1, k + 1) derivatives of the gap P(u, p) - u and, last, of the distance from the
    #: plane in which a point is corrected
    matrix: np.ndarray
    measures: np.ndarray  # (n, 4, k + 1) gradients of the measures
    slope: np.ndarray  # (n,) |p component| of the branch's direction, of length 1 in its weights
    along: np.ndarray  # (n, 4) changes of the measures by a unit of length along the branch
    curvature: np.ndarray  # (n,)

    def closing(self, gap):
        """(n, k + 1) vectors in the plane that change the gap by this one (n, k).

        NaN where the branch lies in the plane.
        """
        return solve_each(self.matrix, np.pad(gap, [(0, 0), (0, 1)]))

    def at_p(self, vector, change=0.0):
        """(n, 4) sizes of what a vector and `change` do to the measures, back along the branch."""
        across = change_along(self.measures, vector) + change
        shift = np.abs(vector[:, -1])
        steep = self.slope + np.sqrt(self.slope**2 + 2.0 * self.curvature * shift)
        back = np.where(shift > 0.0, np.minimum(2.0 * shift / steep, 1.0), 0.0)
        return np.abs(across) + back[:, None] * self.along


def _linearised(orbits, by_p, shape):
    """`Linearised` branch at the points from which orbits begin."""
    k = orbits.returns.jacobian.shape[1]
    gap = np.concatenate([orbits.returns.jacobian - np.eye(k), by_p.image[:, :, None]], axis=2)
    constant_p = np.eye(k + 1)[-1]
    normal = np.where(shape.fixed_p[:, None], constant_p, shape.direction) / shape.weights
    matrix = np.concatenate([gap, normal[:, None, :]], axis=1)
    measures = np.concatenate([orbits.by_u, by_p.measures[:, :, None]], axis=2)
    tangent = _null_vectors(gap * shape.weights[:, None, :])
    along = np.abs(change_along(measures, tangent * shape.weights))
    return Linearised(matrix, measures, np.abs(tangent[:, -1]), along, shape.curvature)


def _null_vectors(matrices):
    """(n, k + 1) vectors of length 1 that matrices (n, k, k + 1) map to 0; NaN where not finite."""
    finite = np.isfinite(matrices).all(axis=(1, 2))
    rows = np.where(finite[:, None, None], matrices, 0.0)
    size = np.abs(rows).max(axis=2, keepdims=True)  # multipliers spread the rows over decades
    vectors = np.linalg.svd(rows / np.where(size > 0.0, size, 1.0))[2][:, -1]
    return np.where(finite[:, None], vectors, np.nan)
