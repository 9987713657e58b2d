"""Generalized least squares, which account for correlated noise, from several starts.

The sum of squares is of residuals whitened with the covariance of the noise.  That covariance
is estimated from the residuals of the fit before.  Both steps alternate until the estimates
converge.  Score tests give, to first order and without a search, the change of chi-square with
more parameters (`chi2_gain`) or with fewer (`response`).
"""

from typing import NamedTuple

import numpy as np
import scipy

from ..kit.noise import Noise, RestrictedLikelihood, estimated_noise
from ..messages import fitting as sentences
from .forward import Forward
from .problem import (
    SAMPLES,
    SamplesProblem,
    before_first_change,
    samples_of,
    search,
    starting_points,
)
from .systematic import least_noise, systematic_errors
from .unknowns import Unknowns, free_under, start_names, unknowns_of

#: most starts of the least squares, and most rounds of noise and fit
STARTS, ROUNDS = 12, 4
#: error of the march, as a fraction of the range of friction
FLOOR = 1e-6
#: relative difference of two sums of squares that counts as equal
AGREE = 1e-3
#: most evaluations of each of several searches
SEARCH_EVALUATIONS = 25
#: largest change of a converged estimate, in standard errors
CONVERGED = 0.02
#: distance from a bound, divided by the standard error or the range, of an estimate at the bound
NEAR = 1e-3
#: significant fall of chi-square with one more parameter (a lag, an unsteady start)
FALL = 12.0
#: significance level of the response to the steps
CHANCE = 1e-4


class Solution(NamedTuple):
    """Result of the least squares, with m samples and k coordinates."""

    problem: SamplesProblem
    noise: Noise
    point: np.ndarray  # (k,)
    peaks: list | None  # `modes` of each family of noise at the point; None: not known
    root: np.ndarray  # (k, k) with root @ root.T the covariance
    fitted_friction: np.ndarray  # (m,)
    jacobian: np.ndarray  # (m, k) of the fitted friction
    chi2: float  # of the whitened residuals
    log_likelihood: float
    converged: bool
    evaluations: int

    @property
    def unknowns(self) -> Unknowns:
        return self.problem.unknowns

    @property
    def covariance(self):
        return self.root @ self.root.T

    @property
    def errors(self):
        """Standard errors (k,) of the coordinates."""
        return np.linalg.norm(self.root, axis=1)

    def covariance_with(self, quantity):
        """Return the covariances (k,) of the coordinates with a `ReportedQuantity`."""
        return self.root @ (quantity.gradient(self.point) @ self.root)

    @property
    def residual(self):
        """Recorded less fitted friction (m,)."""
        return self.problem.observed - self.fitted_friction

    @property
    def noise_is_rounding(self):
        """Whether the white noise has the least size, which follows from the digits of friction."""
        return 0.0 < self.noise.white == least_noise(self.problem.record)

    @property
    def sides(self):
        """Name -> -1 or 1 if the coordinate is at its lower or upper bound, else 0.

        It is then as close as `NEAR` of its standard error and `NEAR` of its range.
        """
        near = NEAR * np.minimum(self.errors, self.unknowns.ranges)
        return self.unknowns.sides(self.point, near)

    @property
    def at_bound(self):
        """Names (list) of the coordinates at a bound."""
        return [name for name, side in self.sides.items() if side]


def solutions_of(data, settings, loading=None):
    """Return a `Solution` for each law (list) of a record (in SI), given `Settings`.

    loading : as for `fit`, whose errors are raised
    """
    record = samples_of(
        data, settings.sliders[0], loading=loading, trend=settings.trend, against=settings.against
    )
    if "alpha" in settings.free and record.loading.normal_stress is None:
        raise sentences.refusal("free.constant_sigma")
    solutions = []
    for slider in settings.sliders:
        has = free_under([slider.friction_law])
        free = tuple(name for name in settings.free if name in has)
        solutions.append(least_squares_fit(record, slider, free, settings.noise, settings.start))
    return solutions


def least_squares_fit(record, slider, free, noise, start):
    """Return the `Solution` of a record under a slider's law.

    noise : `Noise`, or None to estimate it
    start : {"steady", "free", "auto"}; "auto" frees the state at the start if that fits far better
    """
    unknowns = unknowns_of(record, slider, free, start=start == "free")
    problem = SamplesProblem(record, slider, unknowns)
    solution = solution_from(problem, _best_start(problem), noise)
    if start != "auto" or not _may_start_unsteady(solution):
        return solution
    unknowns = unknowns_of(record, slider, free, start=True)
    problem = SamplesProblem(record, slider, unknowns)
    steady = np.zeros(len(unknowns.names))  # with the new coordinates at 0
    steady[[unknowns.names.index(name) for name in solution.unknowns.names]] = solution.point
    unsteady = solution_from(problem, _best_start(problem, steady), noise)
    gain = unsteady.log_likelihood - solution.log_likelihood
    early_gain = _early_log_likelihood(unsteady) - _early_log_likelihood(solution)
    return unsteady if min(gain, early_gain) > 0.5 * FALL else solution


def _best_start(problem, *more_starts):
    """Return the best point that searches on a thinned record reach.

    Among equally good points, one with distances in the slider's order is preferred.
    """
    thin = problem.record.thinned(max(problem.record.t.size // SAMPLES, 1))
    thin_problem = SamplesProblem(thin, problem.slider, problem.unknowns)
    points = [*more_starts, *starting_points(thin_problem, STARTS)]
    noise = thin_problem.white_noise(points[0]) if points else None
    best, distances = None, problem.distances()
    searches: list = []
    for point in points:
        if result := search(thin_problem, point, noise, SEARCH_EVALUATIONS):
            searches = sorted([*searches, result], key=lambda end: end.cost)
            least = [end.x for end in searches if end.cost <= searches[0].cost * (1.0 + AGREE)]
            in_order = [x for x in least if (np.diff(x[distances]) >= 0.0).all()]
            best = [*in_order, *least][0]
            # a third start hardly improves on a minimum that two starts have found
            if len(least) > 1 and in_order:
                break
    if best is None:
        raise sentences.refusal("search.no_motion")
    return best


def _checked_search(problem, point, noise):
    if result := search(problem, point, noise):
        return result
    raise sentences.refusal("search.no_motion")


def solution_from(problem, point, noise):
    """Return the `Solution` from a point, with the noise given, or estimated if None.

    ParameterError if the slider at this point does not move through the whole record.
    """
    t = problem.t
    current = problem.white_noise(point) if noise is None else noise
    before = problem.forward.evaluations
    result, peaks, is_first = _checked_search(problem, point, current), None, True
    columns = problem.linearised(result.x)
    for _ in range(ROUNDS):
        if noise is None:
            more = problem.systematic, current.level
            likelihood = RestrictedLikelihood(t, columns[:, 0], columns[:, 1:], *more)
            current, peaks = estimated_noise(likelihood, current)
            # the error of the march counts as noise: a simulated record may have no other
            white = float(np.hypot(current.white, FLOOR * problem.record.scale))
            current = current._replace(white=max(white, least_noise(problem.record)))
        fitted = columns[:, 0] + problem.observed
        problem.systematic = systematic_errors(problem, result.x, fitted, current)
        if problem.systematic is None and (noise is not None or (current.red == 0.0 and is_first)):
            break  # all weights change by one factor, so the minimum does not move
        last, peaks, is_first = result.x, None, False
        result = _checked_search(problem, last, current)
        columns = problem.linearised(result.x)
        error = np.linalg.norm(root_of_covariance(result.jacobian), axis=1)
        if (np.abs(result.x - last) <= CONVERGED * error).all():
            break
    white, log_determinant = problem.whiten(columns, current)
    chi2 = float(white[:, 0] @ white[:, 0])
    constant = t.size * np.log(2.0 * np.pi)
    return Solution(
        problem,
        current,
        result.x,
        peaks,
        root_of_covariance(white[:, 1:]),
        columns[:, 0] + problem.observed,
        columns[:, 1:],
        chi2,
        -0.5 * (chi2 + log_determinant + constant),
        result.converged,
        problem.forward.evaluations - before,
    )


def root_of_covariance(jacobian):
    """Return R (k, k) with R R^T the inverse of the normal matrix; huge if undetermined.

    The covariance itself would lose the digits of what is determined beside what is not.

    jacobian : (m, k), of whitened residuals
    """
    scale = np.linalg.norm(jacobian, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    _, s, vt = np.linalg.svd(jacobian / scale, full_matrices=False)
    return vt.T / np.maximum(s, 1e-9) / scale[:, None]


def _may_start_unsteady(solution):
    """Return whether an unsteady start may fit better, by a score test.

    The test is repeated with white noise, because the effect of an unsteady start may have been
    estimated as correlated noise.
    """
    problem = solution.problem
    added = start_names(problem.law)
    forward = Forward(problem.record, problem.slider, (*added, *problem.unknowns.names))
    jacobian = np.nan_to_num(forward.jacobian(np.append(np.zeros(len(added)), solution.point))[1])
    in_white_noise = solution._replace(noise=Noise(float(np.std(solution.residual))))
    tested = (solution, in_white_noise) if solution.noise.red else (solution,)
    return any(chi2_gain(fit, jacobian[:, : len(added)])[0] > FALL for fit in tested)


def _early_log_likelihood(solution):
    """Return ln(likelihood) of the samples before the first step.

    Later samples do not count: there a free start would make up for a missing mass or wrong law.
    """
    record = solution.problem.record
    early = before_first_change(record.loading, record.t)
    white, log_determinant = solution.noise.whiten(record.t[early], solution.residual[early])
    return -0.5 * (float(np.sum(white**2)) + log_determinant)


def chi2_gain(solution, added):
    """Return the fall of chi-square (>= 0) with more coordinates, and their values.

    This is a score test: to first order, with all other coordinates fitted again.

    added : (m, p) derivatives of friction by the new coordinates
    """
    columns = np.column_stack([solution.residual, added, solution.jacobian])
    remainder = project_out(solution, columns, 1 + added.shape[1])
    moved = np.linalg.lstsq(remainder[:, 1:], remainder[:, 0], rcond=1e-6)[0]
    return float(np.sum((remainder[:, 1:] @ moved) ** 2)), moved


def response(solution):
    """Return the fall of chi-square from level and trend alone, and added parameters.

    The fall is negative if level and trend alone fit better.
    """
    record = solution.problem.record
    lines = [values / np.abs(values).max() for values in record.regressors().values()]
    columns = np.column_stack([record.friction, *lines])
    residual = project_out(solution, columns, 1)[:, 0]
    return float(residual @ residual) - solution.chi2, len(solution.point) - columns.shape[1] + 1


def project_out(solution, columns, count):
    """Return the first columns (m, count), whitened, without the others' span."""
    white, _ = solution.problem.whiten(columns, solution.noise)
    basis, _ = np.linalg.qr(white[:, count:])
    return white[:, :count] - basis @ (basis.T @ white[:, :count])


def responds(solution):
    """Return whether friction responds to the steps by more than noise may by chance."""
    gain, free = response(solution)
    return bool(gain > scipy.special.chdtri(free, CHANCE))
