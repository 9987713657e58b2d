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

from ...engine.model import FINISHED
from ..cycles.attraction import FINER
from ..cycles.attractor import CycleEstimates
from ..cycles.sensitivity import (
    backward_error,
    coarser_orbits,
    difference,
    follow_period,
    parameter_change,
    parameter_derivatives,
    stiffness_derivatives,
)
from ..cycles.shooting import change_along, effective_tolerance, tightest

# Corrections of one point, each with finer returns or nearer to the branch than the last.
MAX_CORRECTIONS = 12
# Of the error estimate.
SAFETY = 3.0
# Farthest that a point moves, in units of its weights: farther away lies another branch.
FARTHEST = 0.1


class Polished(NamedTuple):
    """n points of a branch."""

    u: np.ndarray  # (n, 2) psi and G at the stress maximum
    parameter: np.ndarray  # (n,)
    tol: np.ndarray  # (n,) tolerance of the returns
    period: np.ndarray  # (n,)
    errors: np.ndarray  # (n, 4) of `sensitivity.LogMeasures` at this parameter


class Shape(NamedTuple):
    """The branch at each of n points, in the coordinates (psi, G, p)/weights."""

    weights: np.ndarray  # (n, 3)
    direction: np.ndarray  # (n, 3) of length 1
    curvature: np.ndarray  # (n,) |d/ds| of the direction's p component
    fixed_p: np.ndarray  # (n,) whether p is fixed

    def at(self, which):
        """The points with these numbers, or where this is true."""
        return Shape(*(values[which] for values in self))


class Correction(NamedTuple):
    """One step of Newton's method at n points, and the errors that it leaves."""

    step: np.ndarray  # (n, 3) of psi, G and p, onto the branch
    moved: np.ndarray  # (n, 4) changes of `sensitivity.LogMeasures`, at constant p, by the step
    error: np.ndarray  # (n, 4) the same by the errors of a return
    along: np.ndarray  # (n, 4) the same by a unit of length along the branch
    tol: np.ndarray  # (n,) tolerance that the returns kept
    period: np.ndarray  # (n,)

    def at(self, which):
        """The points with these numbers, or where this is true."""
        return Correction(*(values[which] for values in self))


def polished(family, points, exact):
    """`Polished` of a branch of a `family.Family`.

    points : list of `newton.Point`, in their order along the branch
    exact : special of a point -> the exact value of its parameter
    """
    p = np.array([point.p for point in points])
    U = np.array([point.u for point in points]).reshape(-1, 2)
    special = np.array([point.special for point in points], dtype=str)
    shape = _shape(family, points, U, p, np.isin(special, list(exact)))
    u, parameter = family.points(U, p), np.exp(p)
    for name, value in exact.items():
        parameter[special == name] = value
    last = family.tolerance(u, p)
    tol = np.maximum(FINER * last, tightest(family.sliders(parameter), u))
    period = np.array([point.measures["period"] for point in points])
    # A fold is where the branch turns back; its position along the branch has this error.
    located = np.where(special == "fold", [point.error for point in points], 0.0)
    errors, moved = np.full((len(p), 4), np.inf), np.full(len(p), np.inf)
    rows = np.arange(len(p))
    for number in range(MAX_CORRECTIONS):
        begin = (u[rows], tol[rows], last[rows], period[rows])
        correction = _correction(family, parameter[rows], begin, shape.at(rows))
        near = np.abs(correction.step / shape.weights[rows]).max(axis=1) < FARTHEST
        near &= np.isfinite(correction.moved + correction.error).all(axis=1)
        rows, correction = rows[near], correction.at(near)
        u[rows] += correction.step[:, :2]
        parameter[rows] *= 1.0 + correction.step[:, 2]
        period[rows] = correction.period
        finer = correction.tol / np.maximum(last[rows], correction.tol)
        errors[rows] = SAFETY * (finer[:, None] * correction.moved + correction.error)
        errors[rows] += located[rows, None] * correction.along
        # Correct again with finer returns; at the finest, as long as steps become shorter.  The
        # first step is longer than errors of returns: the branch was followed less closely.
        floor = tightest(family.sliders(parameter[rows]), u[rows])
        error, by_step = (values[:, :2].max(axis=1) for values in (errors[rows], correction.moved))
        converging = by_step < 0.5 * moved[rows]
        again = ((error > family.rtol) | (number == 0)) & ((tol[rows] > floor) | converging)
        moved[rows], last[rows] = by_step, tol[rows]
        rows, floor, error = rows[again], floor[again], error[again]
        if not len(rows):
            break
        tol[rows] = np.maximum(np.clip(family.rtol / error, 0.01, 0.3) * tol[rows], floor)
    return Polished(u, parameter, tol, period, errors)


def _shape(family, points, U, p, fixed_p):
    """`Shape` of the branch at these points, as it was followed."""
    weights = family.weights(U, p)
    direction = np.array([point.tangent for point in points]).reshape(-1, 3)
    direction = direction / np.column_stack([family.scale(U), np.ones(len(p))])
    position = np.column_stack([U / family.scale(U), p])
    curvature = np.zeros(len(p))
    if len(p) > 1:  # over both neighbours, of which one may be all but the same point
        length = np.linalg.norm(np.diff(position, axis=0), axis=1)
        change = np.abs(np.diff(direction[:, 2]))
        curvature = np.convolve(change, [1.0, 1.0]) / np.convolve(length, [1.0, 1.0])
    return Shape(weights, direction, curvature, fixed_p)


def _correction(family, parameter, begin, shape):
    """`Correction` of points with these values of the family's parameter (n,).

    begin : u (n, 2), tolerance (n,), that of the returns before (n,), and period (n,)
    """
    u, tol, last, period = begin
    system, n = family.sliders(parameter), len(parameter)
    once = np.ones(n, np.int64)
    cycles = CycleEstimates(np.full(n, FINISHED), u, tol, period, np.zeros(n), once)
    orbits = follow_period(system, cycles, tol)
    returns, reached = orbits.returns, effective_tolerance(orbits.returns, tol)
    coarse, finer = coarser_orbits(orbits, last)
    by_steps = difference(coarse, orbits)
    changed = family.sliders(parameter * (1.0 + parameter_change(tol)))
    by_p = parameter_derivatives(changed, orbits)
    by_K = by_p if family.parameter == "K" else stiffness_derivatives(orbits)
    gap = np.concatenate([returns.jacobian - np.eye(2), by_p.image[:, :, None]], axis=2)
    first, second = gap[:, 0], gap[:, 1]
    constant_p = np.array([0.0, 0.0, 1.0])
    normal = np.where(shape.fixed_p[:, None], constant_p, shape.direction) / shape.weights

    def solve(a, b):
        """(n, 3) vectors in the plane of `normal` that change the gap by (a, b)."""
        across = a[:, None] * np.cross(second, normal) + b[:, None] * np.cross(normal, first)
        return across / _dot(first, np.cross(second, normal))[:, None]

    def projected(vector, change=0.0):
        """(n, 4) changes of the measures by a vector, and then along the branch back to p.

        change : (n, 4) of the measures besides
        """
        across = change_along(by_u, vector) + change
        shift = np.abs(vector[:, 2])
        slope = np.abs(tangent[:, 2])
        steep = slope + np.sqrt(tangent[:, 2] ** 2 + 2.0 * shape.curvature * shift)
        back = np.where(shift > 0.0, np.minimum(2.0 * shift / steep, 1.0), 0.0)
        return np.abs(across) + back[:, None] * along

    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        by_u = np.concatenate([orbits.measures.by_u, by_p.values[:, :, None]], axis=2)
        tangent = np.cross(first, second) / shape.weights
        tangent /= np.linalg.norm(tangent, axis=1)[:, None]
        along = np.abs(change_along(by_u, tangent * shape.weights))
        step = solve(*(u - returns.image).T)
        # As beta psi and v all but cancel where b/a is near 1, errors of either weigh more there.
        equivalent = backward_error(system, reached * system.beta / (system.beta - 1.0))[:, None]
        error = projected(equivalent * solve(*-by_K.image.T), equivalent * by_K.values)
        # Errors that steps accumulate need not be equivalent to any change of K.
        finer = finer[:, None]
        error += projected(finer * solve(*-by_steps.image.T), finer * by_steps.values)
        period = returns.numbers["period"]
        return Correction(step, projected(step), error, along, reached, period)


def _dot(first, second):
    """(n,) products of vectors (n, 3)."""
    return np.einsum("ij,ij->i", first, second)
