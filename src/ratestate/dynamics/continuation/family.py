"""A family of sliders along one parameter, and the map whose fixed points are its limit cycles.

The parameter enters as p, its natural logarithm, so that its values stay positive and steps are
relative.  The points of the section are taken as U = (psi, G eta/(1 + eta)), with a psi less its
steady value for each state of the law: in these the errors of a return are of one size, however
small eta is.

A branch is followed with returns only as fine as its shape needs.  If amplitudes change much faster
than the parameter, as on a canard or beside a fold, a small error of a point is then a large error
of the cycle at its parameter.  So finer returns correct point and parameter together afterwards, at
right angles to the branch, and the remaining error is projected along the branch back to the
parameter:

    P(u, p) - u = 0,    n . d(u, p) = 0,

where n is the direction of the branch, or of p at a point where p is fixed.
"""

import dataclasses
from typing import NamedTuple

import numpy as np

from ...friction.composition import composed_law
from ..cycles.attractor import FINER, single_returns
from ..cycles.measure import (
    backward_error,
    coarser_orbits,
    difference,
    measure,
    orbits_of_one_period,
    parameter_derivatives,
    stiffness_derivatives,
)
from ..cycles.shooting import change_along, effective_tolerance, return_map, solve_each
from ..cycles.system import (
    TIGHTEST,
    is_slaved,
    select,
    slaved_G,
    small_amplitude,
    state,
    system_of,
    tightest,
)
from .arclength import follow_branch
from .bifurcations import FixedPointProblem

#: parameters along which a family may be followed, beside those that a law has alone
PARAMETERS = ("V_lp", "K", "M", "sigma", "a", "b", "Dc")
# Sizes of psi and of G's part of U above which steps and errors along a branch are relative.  The
# error of psi is absolute, the tolerance of a return; at large eta psi is small and matters little.
SCALE_PSI, SCALE_G = 0.02, 1e-3
# Divided by rtol: the tolerance of a return, and its error in units of SCALE.
TOLERANCE, NOISE = 0.002, 0.1
# Systems that a family keeps: a step along a branch needs each of a few several times.
CACHED_SYSTEMS = 8
# Corrections of one point, each with finer returns or nearer to the branch than the last.
MAX_CORRECTIONS = 12
# Of the error estimate.
SAFETY = 3.0
# Farthest that a correction moves a point, in its weights: farther away lies another branch.
FARTHEST = 0.1


class MapValues(NamedTuple):
    """The return map of m sliders, as `arclength.follow_branch` needs it; all dimensionless."""

    image: np.ndarray  # (m, k) the next U; NaN where not ok
    jacobian: np.ndarray  # (m, k, k) d image/d U; means nothing where not ok
    ok: np.ndarray  # (m,) whether the orbit came back to the section
    measures: dict  # "period" and "tol", (m,)


@dataclasses.dataclass(frozen=True)
class CycleFamily:
    """Sliders that differ in one parameter; nothing is checked here (see `checked_family`)."""

    law: str
    values: dict  # symbol -> float [SI], V_lp among them; the value of the parameter is not used
    parameter: str
    rtol: float
    #: bytes of p -> `System`, the last ones that `system` returned
    systems: dict = dataclasses.field(default_factory=dict, repr=False, compare=False)

    def sliders(self, parameter):
        """Return the `System` of the sliders with these values (m,) of the parameter [SI]."""
        m = len(parameter)
        columns = {symbol: np.full(m, value) for symbol, value in self.values.items()}
        with np.errstate(over="ignore"):  # beyond physical values no orbit comes back
            return system_of(self.law, **columns | {self.parameter: parameter})

    def system(self, p):
        """Return the `System` of the sliders at p, (m,) or float, which counts as (1,)."""
        p = np.atleast_1d(np.asarray(p, float))
        key = p.tobytes()
        if key not in self.systems:
            with np.errstate(over="ignore"):
                self.systems[key] = self.sliders(np.exp(p))
            if len(self.systems) > CACHED_SYSTEMS:
                del self.systems[next(iter(self.systems))]
        return self.systems[key]

    @property
    def smallest(self):
        """(k,) size of U above which distances from it are relative."""
        return np.append(np.full(len(composed_law(self.law).states), SCALE_PSI), SCALE_G)

    def margin(self, p):
        """Return (K - K_c) Dc/(a sigma) at one p: negative if steady sliding is unstable."""
        return float(self.system(p).margin[0])

    def amplitude(self, U, p):
        """Return the amplitude of ln V of a small cycle through U (k,) at p."""
        return float(small_amplitude(self.system(p), self.points(U[None], p))[0])

    def points(self, U, p):
        """Return u (m, k) of the section's points U (m, k)."""
        system, u = self.system(p), U.copy()
        with np.errstate(divide="ignore", invalid="ignore"):  # without mass
            free = U[:, -1] / _scale(system)
        u[:, -1] = np.where(_is_slaved(system, U), slaved_G(system, U[:, :-1]), free)
        return u

    def chart(self, u, p):
        """Return U (m, k) of the section's points u (m, k)."""
        return np.column_stack([u[:, :-1], _scale(self.system(p)) * u[:, -1]])

    def tolerance(self, u, p):
        """Return the tolerance of a step at u (m, k); a return changes a small r by some r^3."""
        system = self.system(p)
        r = np.minimum(1.0, np.abs(small_amplitude(system, u)))
        return np.maximum(TOLERANCE * self.rtol * r**3, tightest(system, u))

    def return_map(self, U, p):
        """Return the `MapValues` of m sliders at U (m, k), p (m,).

        They are not ok if there can be no cycle, or G <= 0.
        """
        system, u = self.system(p), self.points(U, p)
        tol = self.tolerance(u, p)
        usable = system.may_cycle & (u[:, -1] > 0.0) & np.isfinite(u).all(axis=1)
        u[~usable] = np.nan
        returns = return_map(system, state(system, u), tol)
        scale = _scale(system)
        jacobian = returns.jacobian.copy()
        jacobian[:, -1, :] *= scale[:, None]
        jacobian[:, :, -1] *= np.where(_is_slaved(system, U), 0.0, 1.0 / scale)[:, None]
        image = np.column_stack([returns.image[:, :-1], scale * returns.image[:, -1]])
        measures = {"period": returns.numbers["period"], "tol": tol}
        return MapValues(image, jacobian, usable & returns.has_returned, measures)

    def branch(self, U, p, *, stop, **options):
        """Return the `Branch` from U (k,) at p to stop; options as of `follow_branch`."""
        # At large eta the stress is large, and its rounding too: in stick-slip tau/(a sigma) varies
        # by some sqrt(kappa eta).
        system = self.system(np.array([p, stop]))
        amplitude = np.sqrt(np.max(np.maximum(1.0, system.kappa * system.eta)))
        noise = max(NOISE * self.rtol, TIGHTEST * amplitude / SCALE_PSI)
        problem = FixedPointProblem(self.return_map, self.smallest, self.rtol, noise)
        return follow_branch(problem, U, p, stop, **options)

    def measures(self, points, exact):
        """Return the measures of a branch's points, as by `measure`: name -> (n,) or (n, k).

        They include "parameter", its values (n,) [SI] to which the measures belong.

        points : list of n `BranchPoint`s
        exact : special of a point -> the exact value of its parameter
        """
        points = _polished(self, points, exact)
        # An error > 0 keeps `measure` from correcting the cycle at constant p.
        error = points.errors[:, :2].max(axis=1) + 1e-16
        cycles = single_returns(points.u, points.tol, points.period, error)
        values = measure(self.sliders(points.parameter), cycles)
        for name, of_speed in zip(("v_max_error", "v_min_error"), points.errors.T[2:], strict=True):
            values[name] = np.maximum(values[name], of_speed)
        return values | {"parameter": points.parameter}


def _scale(system):
    return system.eta / (1.0 + system.eta)


def _is_slaved(system, U):
    return is_slaved(system, U[:, :-1] + system.steady, U[:, -1] * (1.0 + system.eta))


# The points of a branch to full accuracy


class _Points(NamedTuple):
    """n points of a branch; arrays change in place."""

    u: np.ndarray  # (n, k) psi and G at the stress maximum
    parameter: np.ndarray  # (n,) [SI]
    tol: np.ndarray  # (n,) tolerance of the returns
    last_tol: np.ndarray  # (n,) tolerance of the previous returns
    period: np.ndarray  # (n,)
    #: (n, 4) of `measure.Orbits.measures` at this parameter; inf before the first correction
    errors: np.ndarray


class _Shape(NamedTuple):
    """The branch at each of n points, in the coordinates (psi, G, p)/weights."""

    weights: np.ndarray  # (n, k + 1)
    direction: np.ndarray  # (n, k + 1) of length 1
    curvature: np.ndarray  # (n,) |d/ds| of the direction's p component
    fixed_p: np.ndarray  # (n,) whether p is fixed


class _Correction(NamedTuple):
    """One step of Newton's method at n points, and the errors that it leaves."""

    step: np.ndarray  # (n, k + 1) of psi, G and p, onto the branch; not finite if there is none
    changes: np.ndarray  # (n, 4) changes of the measures, at constant p, by the step
    error: np.ndarray  # (n, 4) the same by the errors of a return
    along: np.ndarray  # (n, 4) the same by a unit of length along the branch
    tol: np.ndarray  # (n,) tolerance that the returns kept
    period: np.ndarray  # (n,)


def _polished(family, points, exact):
    """Return the `_Points` of a branch from its `BranchPoint`s.

    exact : as in `CycleFamily.measures`

    A point whose next correction is not finite, or too long, stays as it is, with the errors found
    so far.
    """
    special = np.array([point.special for point in points], dtype=str)
    polished, shape = _as_followed(family, points, special, exact)
    # A fold is where the branch turns back; its position along the branch has this error.
    located = np.where(special == "fold", [point.error for point in points], 0.0)
    rows, last_change = np.arange(len(points)), np.full(len(points), np.inf)
    for number in range(MAX_CORRECTIONS):
        correction = _correction(family, select(polished, rows), select(shape, rows))
        is_near = np.abs(correction.step / shape.weights[rows]).max(axis=1) < FARTHEST
        is_near &= np.isfinite(correction.changes + correction.error).all(axis=1)
        rows, correction = rows[is_near], select(correction, is_near)
        polished.u[rows] += correction.step[:, :-1]
        polished.parameter[rows] *= 1.0 + correction.step[:, -1]
        polished.period[rows] = correction.period
        finer = correction.tol / np.maximum(polished.last_tol[rows], correction.tol)
        errors = SAFETY * (finer[:, None] * correction.changes + correction.error)
        polished.errors[rows] = errors + located[rows, None] * correction.along
        # Correct again with finer returns; at the finest, as long as steps become shorter.  The
        # first step is longer than errors of returns: the branch was followed less closely.
        floor = tightest(family.sliders(polished.parameter[rows]), polished.u[rows])
        error = polished.errors[rows, :2].max(axis=1)
        by_step = correction.changes[:, :2].max(axis=1)
        converging = by_step < 0.5 * last_change[rows]
        unfinished = (error > family.rtol) | (number == 0)
        unfinished &= (polished.tol[rows] > floor) | converging
        last_change[rows], polished.last_tol[rows] = by_step, polished.tol[rows]
        rows, floor, error = rows[unfinished], floor[unfinished], error[unfinished]
        if not len(rows):
            break
        finer = np.clip(family.rtol / error, 0.01, 0.3) * polished.tol[rows]
        polished.tol[rows] = np.maximum(finer, floor)
    return polished


def _as_followed(family, points, special, exact):
    """Return `_Points` and `_Shape` of the branch as it was followed, with exact parameters."""
    p = np.array([point.p for point in points])
    k = len(family.smallest)
    U = np.array([point.u for point in points]).reshape(-1, k)
    scale, ones = family.smallest + np.abs(U), np.ones(len(p))
    direction = np.array([point.tangent for point in points]).reshape(-1, k + 1)
    direction = direction / np.column_stack([scale, ones])
    curvature = np.zeros(len(p))
    if len(p) > 1:  # over both neighbours, of which one may be all but the same point
        position = np.column_stack([U / scale, p])
        length = np.linalg.norm(np.diff(position, axis=0), axis=1)
        change = np.abs(np.diff(direction[:, -1]))
        curvature = np.convolve(change, [1.0, 1.0]) / np.convolve(length, [1.0, 1.0])
    u, parameter = family.points(U, p), np.exp(p)
    last = family.tolerance(u, p)
    scale[:, -1] /= _scale(family.system(p))
    fixed_p = np.isin(special, list(exact))
    shape = _Shape(np.column_stack([scale, ones]), direction, curvature, fixed_p)
    for name, value in exact.items():
        parameter[special == name] = value
    tol = np.maximum(FINER * last, tightest(family.sliders(parameter), u))
    period = np.array([point.measures["period"] for point in points])
    return _Points(u, parameter, tol, last, period, np.full((len(p), 4), np.inf)), shape


def _correction(family, points, shape):
    """Return the `_Correction` of `_Points` of this shape, from the linearised branch."""
    u, tol, system = points.u, points.tol, family.sliders(points.parameter)
    orbits = orbits_of_one_period(system, single_returns(u, tol, points.period), tol)
    coarse, finer = coarser_orbits(orbits, points.last_tol)
    by_steps, finer = difference(coarse, orbits), finer[:, None]
    by_p = parameter_derivatives(orbits, lambda factor: family.sliders(points.parameter * factor))
    by_K = by_p if family.parameter == "K" else stiffness_derivatives(orbits)
    returns, reached = orbits.returns, effective_tolerance(orbits.returns, tol)
    k = u.shape[1]
    gap = np.concatenate([returns.jacobian - np.eye(k), by_p.image[:, :, None]], axis=2)
    normal = np.where(shape.fixed_p[:, None], np.eye(k + 1)[-1], shape.direction) / shape.weights
    matrix = np.concatenate([gap, normal[:, None, :]], axis=1)
    gradients = np.concatenate([orbits.by_u, by_p.measures[:, :, None]], axis=2)

    def closing(gap):
        """Return the vectors in the plane that change P(u, p) - u by `gap`; NaN if none."""
        return solve_each(matrix, np.pad(gap, [(0, 0), (0, 1)]))

    def at_p(vector, change=0.0):
        """Return sizes of what a vector and `change` do to the measures, back at constant p."""
        across = change_along(gradients, vector) + change
        shift = np.abs(vector[:, -1])
        steep = slope + np.sqrt(slope**2 + 2.0 * shape.curvature * shift)
        distance = np.where(shift > 0.0, np.minimum(2.0 * shift / steep, 1.0), 0.0)
        return np.abs(across) + distance[:, None] * along

    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        tangent = _null_vectors(gap * shape.weights[:, None, :])
        slope = np.abs(tangent[:, -1])
        along = np.abs(change_along(gradients, tangent * shape.weights))
        step = closing(u - returns.image)
        # As the effects of v and psi all but cancel at b/a near 1, errors weigh more there.
        equivalent = backward_error(system, reached * system.cancellation)[:, None]
        error = at_p(equivalent * closing(-by_K.image), equivalent * by_K.measures)
        # Errors that steps accumulate need not be equivalent to any change of K.
        error += at_p(finer * closing(-by_steps.image), finer * by_steps.measures)
        changes, period = at_p(step), returns.numbers["period"]
    return _Correction(step, changes, error, along, reached, period)


def _null_vectors(matrices):
    """Return unit vectors (n, k + 1) that matrices (n, k, k + 1) map to 0; NaN if not finite."""
    finite = np.isfinite(matrices).all(axis=(1, 2))
    rows = np.where(finite[:, None, None], matrices, 0.0)
    size = np.abs(rows).max(axis=2, keepdims=True)  # multipliers spread the rows over decades
    vectors = np.linalg.svd(rows / np.where(size > 0.0, size, 1.0))[2][:, -1]
    return np.where(finite[:, None], vectors, np.nan)
