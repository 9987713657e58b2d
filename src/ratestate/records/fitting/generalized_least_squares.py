"""Generalized least squares, those in the presence of correlated noise, from several starts.

The sum of squares is that of the residuals made white by the noise's own covariance, which is
estimated from the residuals of the fit before; the two alternate until the estimates converge.
Score tests tell, to first order and without a search, how chi-square would change with more
parameters (`gain_of`), or with fewer (`response`).
"""

from typing import NamedTuple

import numpy as np
from scipy.special import chdtri

from ..kit.estimated_noise import estimated_noise
from ..kit.noise import Noise
from ..messages import fitting as sentences
from .forward import Forward
from .problem import SAMPLES, Problem, search, starting_points
from .record import before_changes, record_of
from .unknowns import Unknowns, free_under, starts_of, unknowns_of

#: most starts of the least squares, and most rounds of noise and fit
STARTS, ROUNDS = 12, 4
#: error of the march itself, as a part of the range of friction
FLOOR = 1e-6
#: two searches that end at sums of squares no further apart agree
AGREE = 1e-3
#: most evaluations of a search, where the best of several is picked
SEARCH_EVALUATIONS = 25
#: largest move of an estimate, in its standard errors, that counts as converged
CONVERGED = 0.02
#: distance from a bound, in standard errors, up to which an estimate is at it
AT_BOUND = 1e-3
#: fall of chi-square by one more parameter (a lag, an unsteady start) that is not by chance
FALL = 12.0
#: probability below which a response is not taken for noise
CHANCE = 1e-4


class Solution(NamedTuple):
    """Result of the least squares, with m samples and k coordinates."""

    problem: Problem
    noise: Noise
    point: np.ndarray  # (k,)
    covariance: np.ndarray  # (k, k)
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
    def residual(self):
        """(m,) recorded less fitted friction."""
        return self.problem.observed - self.fitted_friction

    @property
    def at_bound(self):
        """(k,) whether a coordinate is at an end of its range, within `AT_BOUND` errors."""
        _, low, high = self.unknowns
        near = AT_BOUND * np.sqrt(np.diag(self.covariance))
        return np.minimum(abs(self.point - low), abs(high - self.point)) < near


def solutions_of(data, settings, loading=None):
    """list of `Solution`, one for each law, of a record (Dataset in SI) with checked `Settings`.

    loading : as of `fit`, whose errors are raised
    """
    record = record_of(
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
    """The `Solution` of a record under a slider's law; the noise is estimated if it is None.

    start : {"steady", "free", "auto"}; "auto" frees the state at the start if that fits far better

    ParameterError where no start of the search moves through the whole record.
    """
    unknowns = unknowns_of(record, slider, free, start=start == "free")
    problem = Problem(record, slider, unknowns)
    solution = solution_from(problem, _best_start(problem), noise)
    if start != "auto" or not _may_start_unsteady(solution):
        return solution
    unknowns = unknowns_of(record, slider, free, start=True)
    problem = Problem(record, slider, unknowns)
    steady = np.zeros(len(unknowns.names))  # with the new coordinates at 0
    steady[[unknowns.names.index(name) for name in solution.unknowns.names]] = solution.point
    unsteady = solution_from(problem, _best_start(problem, steady), noise)
    gain = unsteady.log_likelihood - solution.log_likelihood
    early_gain = _early_log_likelihood(unsteady) - _early_log_likelihood(solution)
    return unsteady if min(gain, early_gain) > 0.5 * FALL else solution


def _best_start(problem, *first):
    """The best point that a search on a thinned record reaches from these and several starts.

    Of equally good ones that with the distances in the order that they have in the slider.
    """
    thin = problem.record.thinned(max(problem.record.t.size // SAMPLES, 1))
    thin_problem = Problem(thin, problem.slider, problem.unknowns)
    points = [*first, *starting_points(thin_problem, STARTS)]
    noise = thin_problem.white_noise(points[0]) if points else None
    best, distances = None, problem.distances()
    searches: list = []
    for point in points:
        if result := search(thin_problem, point, noise, SEARCH_EVALUATIONS):
            searches = sorted([*searches, result], key=lambda one: one.cost)
            least = [one.x for one in searches if one.cost <= searches[0].cost * (1.0 + AGREE)]
            in_order = [x for x in least if (np.diff(x[distances]) >= 0.0).all()]
            best = [*in_order, *least][0]
            # a third start hardly finds less than the least sum that two starts have led to
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
    """The `Solution` from this point, with the noise given, or if None estimated in `ROUNDS`.

    ParameterError if the slider of this point does not move through the whole record.
    """
    t, observed = problem.t, problem.observed
    current = problem.white_noise(point) if noise is None else noise
    before = problem.forward.evaluations
    result, was_white = _checked_search(problem, point, current), True
    for _ in range(ROUNDS if noise is None else 0):
        friction, jacobian = problem.forward.jacobian(result.x)
        residual = friction - observed
        current = estimated_noise(t, residual, np.nan_to_num(jacobian), current)
        # the error of the march itself counts as noise: a record may have none
        current = current._replace(
            white=float(np.hypot(current.white, FLOOR * problem.record.scale))
        )
        if current.red == 0.0 and was_white:
            break  # all weights change by one factor: the minimum stays
        last, was_white = result.x, False
        result = _checked_search(problem, last, current)
        error = np.sqrt(np.diag(_covariance(result.jacobian)))
        if (np.abs(result.x - last) <= CONVERGED * error).all():
            break
    friction, jacobian = problem.forward.jacobian(result.x)
    jacobian = np.nan_to_num(jacobian)
    white, log_determinant = current.whiten(t, np.column_stack([friction - observed, jacobian]))
    chi2 = float(white[:, 0] @ white[:, 0])
    constant = t.size * np.log(2.0 * np.pi)
    return Solution(
        problem,
        current,
        result.x,
        _covariance(white[:, 1:]),
        friction,
        jacobian,
        chi2,
        -0.5 * (chi2 + log_determinant + constant),
        result.converged,
        problem.forward.evaluations - before,
    )


def _covariance(jacobian):
    """(k, k) inverse of the normal matrix; huge in directions that the record does not see.

    jacobian : (m, k), of whitened residuals
    """
    scale = np.linalg.norm(jacobian, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    _, s, vt = np.linalg.svd(jacobian / scale, full_matrices=False)
    root = vt.T / np.maximum(s, 1e-9)
    return root @ root.T / np.outer(scale, scale)


def _may_start_unsteady(solution):
    """Whether an unsteady start may fit better, by a score test.

    It is one in white noise as well: what such a start leaves may pass for correlated noise.
    """
    problem = solution.problem
    added = starts_of(problem.law)
    forward = Forward(problem.record, problem.slider, (*added, *problem.unknowns.names))
    jacobian = np.nan_to_num(forward.jacobian(np.append(np.zeros(len(added)), solution.point))[1])
    in_white_noise = solution._replace(noise=Noise(float(np.std(solution.residual))))
    both = (solution, in_white_noise) if solution.noise.red else (solution,)
    return any(gain_of(one, jacobian[:, : len(added)])[0] > FALL for one in both)


def _early_log_likelihood(solution):
    """ln(likelihood) of the samples before the first step, where the start has its effect.

    Later samples do not count: there a free start would only make up for a mass or another law.
    """
    record = solution.problem.record
    early = before_changes(record.loading, record.t)
    white, log_determinant = solution.noise.whiten(record.t[early], solution.residual[early])
    return -0.5 * (float(np.sum(white**2)) + log_determinant)


def gain_of(solution, added):
    """Fall of chi-square (float, >= 0) with more coordinates, and the values (p,) of these.

    To first order, with all other coordinates fitted again: a score test.

    added : (m, p) derivatives of friction by them
    """
    columns = np.column_stack([solution.residual, added, solution.jacobian])
    rest = projected(solution, columns, 1 + added.shape[1])
    moved = np.linalg.lstsq(rest[:, 1:], rest[:, 0], rcond=1e-6)[0]
    return float(np.sum((rest[:, 1:] @ moved) ** 2)), moved


def response(solution):
    """Fall of chi-square from level and trend alone to the solution, and parameters it takes.

    The fall is negative where these alone fit better.
    """
    record = solution.problem.record
    lines = [values / np.abs(values).max() for values in record.regressors().values()]
    columns = np.column_stack([record.friction, *lines])
    rest = projected(solution, columns, 1)[:, 0]
    return float(rest @ rest) - solution.chi2, len(solution.point) - columns.shape[1] + 1


def projected(solution, columns, count):
    """The first columns (m, count), whitened, less their projections on the other columns."""
    white, _ = solution.noise.whiten(solution.problem.record.t, columns)
    basis, _ = np.linalg.qr(white[:, count:])
    return white[:, :count] - basis @ (basis.T @ white[:, :count])


def responds(solution):
    """Whether friction responds to the steps by more than noise does by chance."""
    gain, free = response(solution)
    return bool(gain > chdtri(free, CHANCE))
