"""The points of a branch to full accuracy, each with the parameter to which it belongs.

A branch is followed with turns only as fine as its shape needs.  Where amplitudes change much
faster than the parameter, as on a canard or beside a fold, a small error of a point is then a large
one of the cycle at its parameter.  So with finer turns point and parameter move together, at right
angles to the branch, and what may still be wrong is carried along the branch to that parameter:

    P(u, p) - u = 0,    n . d(u, p) = 0,    p the parameter's logarithm

where n has the branch's own direction, or that of p where p has to stay.
"""

from typing import NamedTuple

import numpy as np

from ...engine.model import FINISHED
from ..cycles.attraction import FINER
from ..cycles.attractor import Settled
from ..cycles.iterates import iterate
from ..cycles.sensitivity import (
    COARSER,
    defect,
    measured,
    parameter_change,
    slopes,
    stiffness_slopes,
)
from ..cycles.shooting import kept_tolerance, tightest

# Rounds, each with finer turns or nearer to the branch than the last, for one point.
MOST_ROUNDS = 12
# Of the error estimate.
SAFETY = 3.0
# Farthest that a point moves, in units of its weights: farther away lies another branch.
FARTHEST = 0.1


class Polished(NamedTuple):
    """n points of a branch."""

    u: np.ndarray  # (n, 2) psi and G at the stress maximum
    parameter: np.ndarray  # (n,)
    tol: np.ndarray  # (n,) tolerance of the turns
    period: np.ndarray  # (n,)
    errors: np.ndarray  # (n, 4) of `sensitivity.Measured` at this parameter


class Shape(NamedTuple):
    """The branch at each of n points, in the coordinates (psi, G, p)/weights."""

    weights: np.ndarray  # (n, 3)
    direction: np.ndarray  # (n, 3) of length 1
    bend: np.ndarray  # (n,) |d/ds| of the direction's p component
    stays: np.ndarray  # (n,) whether p has to

    def at(self, which):
        """The points with these numbers, or where this is true."""
        return Shape(*(values[which] for values in self))


class Closing(NamedTuple):
    """What one turn more says of n points."""

    step: np.ndarray  # (n, 3) of psi, G and p, onto the branch
    moved: np.ndarray  # (n, 4) changes of `sensitivity.Measured`, at constant p, by the step
    defect: np.ndarray  # (n, 4) the same by what the errors of a turn amount to
    along: np.ndarray  # (n, 4) the same by a unit of length along the branch
    tol: np.ndarray  # (n,) tolerance that the turn kept
    period: np.ndarray  # (n,)

    def at(self, which):
        """The points with these numbers, or where this is true."""
        return Closing(*(values[which] for values in self))


def polished(family, points, exact):
    """`Polished` of a branch of a `family.Family`.

    points : list of `newton.Point`, in their order along the branch
    exact : special of a point -> the value that its parameter has to keep
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
    # A fold is where the branch turns back, and how far along it is known to no more than this.
    located = np.where(special == "fold", [point.error for point in points], 0.0)
    errors, moved = np.full((len(p), 4), np.inf), np.full(len(p), np.inf)
    rows = np.arange(len(p))
    for number in range(MOST_ROUNDS):
        begin = (u[rows], tol[rows], last[rows], period[rows])
        found = _closing(family, parameter[rows], begin, shape.at(rows))
        near = np.abs(found.step / shape.weights[rows]).max(axis=1) < FARTHEST
        near &= np.isfinite(found.moved + found.defect).all(axis=1)
        rows, found = rows[near], found.at(near)
        u[rows] += found.step[:, :2]
        parameter[rows] *= 1.0 + found.step[:, 2]
        period[rows] = found.period
        finer = found.tol / np.maximum(last[rows], found.tol)
        errors[rows] = SAFETY * (finer[:, None] * found.moved + found.defect)
        errors[rows] += located[rows, None] * found.along
        # Once more with finer turns, or, where there are none, while that comes nearer.  The first
        # round moves points by more than errors of turns: the branch was followed less closely.
        floor = tightest(family.sliders(parameter[rows]), u[rows])
        error, by_step = (values[:, :2].max(axis=1) for values in (errors[rows], found.moved))
        nearer = by_step < 0.5 * moved[rows]
        again = ((error > family.rtol) | (number == 0)) & ((tol[rows] > floor) | nearer)
        moved[rows], last[rows] = by_step, tol[rows]
        rows, floor, error = rows[again], floor[again], error[again]
        if not len(rows):
            break
        tol[rows] = np.maximum(np.clip(family.rtol / error, 0.01, 0.3) * tol[rows], floor)
    return Polished(u, parameter, tol, period, errors)


def _shape(family, points, U, p, stays):
    """`Shape` of these points, as the branch was followed."""
    weights = family.weights(U, p)
    direction = np.array([point.tangent for point in points]).reshape(-1, 3)
    direction = direction / np.column_stack([family.scale(U), np.ones(len(p))])
    place = np.column_stack([U / family.scale(U), p])
    bend = np.zeros(len(p))
    if len(p) > 1:  # over both neighbours, of which one may be all but the same point
        length = np.linalg.norm(np.diff(place, axis=0), axis=1)
        turned = np.abs(np.diff(direction[:, 2]))
        bend = np.convolve(turned, [1.0, 1.0]) / np.convolve(length, [1.0, 1.0])
    return Shape(weights, direction, bend, stays)


def _closing(family, parameter, begin, shape):
    """`Closing` of points with these values of the family's parameter (n,).

    begin : u (n, 2), tolerance (n,), that of the turns before (n,), and period (n,)
    """
    u, tol, last, period = begin
    system, n = family.sliders(parameter), len(parameter)
    once = np.ones(n, np.int64)
    settled = Settled(np.full(n, FINISHED), u, tol, period, np.zeros(n), once)
    turns = iterate(system, u, tol, once, alone=False, period=period)
    cycle, kept = measured(turns), kept_tolerance(turns, tol)
    coarser = np.maximum(last, COARSER * kept)
    rough = iterate(system, u, coarser, once, alone=False, period=period)
    changed = family.sliders(parameter * (1.0 + parameter_change(tol)))
    by_p = slopes(changed, settled, turns, tol)
    by_K = by_p if family.parameter == "K" else stiffness_slopes(system, settled, turns, tol)
    gap = np.concatenate([turns.jacobian - np.eye(2), by_p.image[:, :, None]], axis=2)
    first, second = gap[:, 0], gap[:, 1]
    constant_p = np.array([0.0, 0.0, 1.0])
    normal = np.where(shape.stays[:, None], constant_p, shape.direction) / shape.weights

    def solve(a, b):
        """(n, 3) vectors in the plane of `normal` that change the gap by (a, b)."""
        aside = a[:, None] * np.cross(second, normal) + b[:, None] * np.cross(normal, first)
        return aside / _dot(first, np.cross(second, normal))[:, None]

    def carried(vector, held=0.0):
        """(n, 4) changes of what is measured by a vector, if p then returns along the branch."""
        across = (by_u @ vector[:, :, None])[:, :, 0] + held
        shift = np.abs(vector[:, 2])
        steep = np.abs(tangent[:, 2]) + np.sqrt(tangent[:, 2] ** 2 + 2.0 * shape.bend * shift)
        back = np.where(shift > 0.0, np.minimum(2.0 * shift / steep, 1.0), 0.0)
        return np.abs(across) + back[:, None] * along

    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        by_u = np.concatenate([cycle.by_u, by_p.values[:, :, None]], axis=2)
        tangent = np.cross(first, second) / shape.weights
        tangent /= np.linalg.norm(tangent, axis=1)[:, None]
        along = np.abs((by_u @ (tangent * shape.weights)[:, :, None])[:, :, 0])
        step = solve(*(u - turns.image).T)
        # As beta psi and v all but cancel where b/a is near 1, errors of either weigh more there.
        worth = defect(system, kept * system.beta / (system.beta - 1.0))[:, None]
        off, held = worth * solve(*-by_K.image.T), worth * by_K.values
        # What errors of steps add up to, told by a coarser turn, may be none that K would cause.
        part = (kept / coarser)[:, None]
        gathered = part * solve(*(turns.image - rough.image).T)
        by_steps = carried(gathered, part * (measured(rough).values - cycle.values))
        period = turns.numbers["period"]
        return Closing(step, carried(step), carried(off, held) + by_steps, along, kept, period)


def _dot(first, second):
    """(n,) products of vectors (n, 3)."""
    return np.einsum("ij,ij->i", first, second)
