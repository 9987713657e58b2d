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
from ..cycles.shooting import change_along, effective_tolerance, select, tightest

# Corrections of one point, each with finer returns or nearer to the branch than the last.
MAX_CORRECTIONS = 12
# Of the error estimate.
SAFETY = 3.0
# Farthest that a point moves, in units of its weights: farther away lies another branch.
FARTHEST = 0.1


class Points(NamedTuple):
    """n points of a branch; arrays change in place."""

    u: np.ndarray  # (n, 2) psi and G at the stress maximum
    parameter: np.ndarray  # (n,) [SI]
    tol: np.ndarray  # (n,) tolerance of the returns
    last: np.ndarray  # (n,) that of the returns before
    period: np.ndarray  # (n,)
    #: (n, 4) of `sensitivity.Orbits.measures` at this parameter; inf where none could be estimated
    errors: np.ndarray


class Shape(NamedTuple):
    """The branch at each of n points, in the coordinates (psi, G, p)/weights."""

    weights: np.ndarray  # (n, 3)
    direction: np.ndarray  # (n, 3) of length 1
    curvature: np.ndarray  # (n,) |d/ds| of the direction's p component
    fixed_p: np.ndarray  # (n,) whether p is fixed


class Correction(NamedTuple):
    """One step of Newton's method at n points, and the errors that it leaves."""

    step: np.ndarray  # (n, 3) of psi, G and p, onto the branch; not finite where there is none
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
        now.u[rows] += correction.step[:, :2]
        now.parameter[rows] *= 1.0 + correction.step[:, 2]
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
    U = np.array([point.u for point in points]).reshape(-1, 2)
    direction = np.array([point.tangent for point in points]).reshape(-1, 3)
    direction = direction / np.column_stack([family.scale(U), np.ones(len(p))])
    curvature = np.zeros(len(p))
    if len(p) > 1:  # over both neighbours, of which one may be all but the same point
        position = np.column_stack([U / family.scale(U), p])
        length = np.linalg.norm(np.diff(position, axis=0), axis=1)
        change = np.abs(np.diff(direction[:, 2]))
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
        # As beta psi and v all but cancel where b/a is near 1, errors of either weigh more there.
        equivalent = backward_error(system, reached * system.beta / (system.beta - 1.0))[:, None]
        error = plane.at_p(equivalent * plane.closing(-by_K.image), equivalent * by_K.measures)
        # Errors that steps accumulate need not be equivalent to any change of K.
        error += plane.at_p(finer * plane.closing(-by_steps.image), finer * by_steps.measures)
        moved, period = plane.at_p(step), returns.numbers["period"]
        return Correction(step, moved, error, plane.along, reached, period)


class Linearised(NamedTuple):
    """The branch near n points of it, to first order in psi, G and p."""

    first: np.ndarray  # (n, 3) gradient of the gap P(u, p) - u in psi
    second: np.ndarray  # (n, 3) that in G
    normal: np.ndarray  # (n, 3) of the plane in which a point is corrected
    measures: np.ndarray  # (n, 4, 3) gradients of the measures
    slope: np.ndarray  # (n,) |p component| of the branch's direction, of length 1 in its weights
    along: np.ndarray  # (n, 4) changes of the measures by a unit of length along the branch
    curvature: np.ndarray  # (n,)

    def closing(self, gap):
        """(n, 3) vectors in the plane that change the gap by this one (n, 2).

        Not finite where the branch lies in the plane.
        """
        first, second, normal = self.first, self.second, self.normal
        across = gap[:, :1] * np.cross(second, normal) + gap[:, 1:] * np.cross(normal, first)
        return across / np.einsum("ij,ij->i", first, np.cross(second, normal))[:, None]

    def at_p(self, vector, change=0.0):
        """(n, 4) sizes of what a vector and `change` do to the measures, back along the branch."""
        across = change_along(self.measures, vector) + change
        shift = np.abs(vector[:, 2])
        steep = self.slope + np.sqrt(self.slope**2 + 2.0 * self.curvature * shift)
        back = np.where(shift > 0.0, np.minimum(2.0 * shift / steep, 1.0), 0.0)
        return np.abs(across) + back[:, None] * self.along


def _linearised(orbits, by_p, shape):
    """`Linearised` branch at the points from which orbits begin."""
    gap = np.concatenate([orbits.returns.jacobian - np.eye(2), by_p.image[:, :, None]], axis=2)
    first, second = gap[:, 0], gap[:, 1]
    constant_p = np.array([0.0, 0.0, 1.0])
    normal = np.where(shape.fixed_p[:, None], constant_p, shape.direction) / shape.weights
    measures = np.concatenate([orbits.by_u, by_p.measures[:, :, None]], axis=2)
    tangent = np.cross(first, second) / shape.weights
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    along = np.abs(change_along(measures, tangent * shape.weights))
    slope = np.abs(tangent[:, 2])
    return Linearised(first, second, normal, measures, slope, along, shape.curvature)
