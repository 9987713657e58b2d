"""Least squares in the presence of correlated noise, from several starts.

The sum of squares is that of the residuals made white by the noise's own covariance, which is
estimated from the residuals of the fit before; both are repeated until the estimates stand still.
"""

from typing import NamedTuple

import numpy as np

from ...errors import ParameterError
from .forward import Forward
from .noise import Noise, estimated_noise
from .problem import Problem, search
from .score import FALL, gain_of
from .starts import SAMPLES, starting_points, unknowns_of
from .unknowns import NEAR, START, Unknowns

#: most starts of the least squares, and rounds of noise and fit
STARTS, ROUNDS = 12, 4
#: what the march itself leaves unsure, as a part of the range of friction
FLOOR = 1e-6
#: two searches that end at sums of squares no further apart agree
AGREE = 1e-3
#: most evaluations of a search from which the best is picked
FEW = 25
#: estimates stand still where none moves by more, in its standard error
STILL = 0.02

NO_MOTION = (
    "no slider of any size near these moves through the whole record without instability; without "
    "inertia (M = 0) sliding at K < K_c_qs ends: fix fewer parameters, give other ones to start "
    "from, or give the slider its mass M"
)


class Solution(NamedTuple):
    """Where least squares have come to, with m samples and k coordinates."""

    problem: Problem
    noise: Noise
    point: np.ndarray  # (k,)
    covariance: np.ndarray  # (k, k)
    fitted: np.ndarray  # (m,) friction
    jacobian: np.ndarray  # (m, k) of the fitted friction
    chi2: float  # of the whitened residuals
    log_likelihood: float
    converged: bool
    evaluations: int

    @property
    def unknowns(self) -> Unknowns:
        return self.problem.unknowns

    def at_bound(self, name):
        """-1 or 1 if a coordinate has run to its lower or upper bound, else 0."""
        i = self.unknowns.place(name)
        low, high = self.unknowns.low[i], self.unknowns.high[i]
        if not np.isfinite(high - low):
            return 0
        part = (self.point[i] - low) / (high - low)
        return -1 if part < NEAR else 1 if part > 1.0 - NEAR else 0


def solve(record, slider, law, free, noise, start):
    """The `Solution` of a record under one law.

    Parameters
    ----------
    record : Record
    slider : SpringSlider, starting values and what is not free
    law : int, code
    free : tuple of str
    noise : Noise, or None to estimate it
    start : {"steady", "free", "auto"}
    """
    unknowns = unknowns_of(record, free, start=start == "free", sigma=slider.sigma)
    problem = Problem(record, slider, law, unknowns)
    solution = settled(problem, _best_start(problem, slider, law), noise)
    if start != "auto" or not _may_start_unsteady(solution, slider, law):
        return solution
    # Correlated noise may have taken the blame: so the search begins anew.
    unknowns = unknowns_of(record, free, start=True, sigma=slider.sigma)
    problem = Problem(record, slider, law, unknowns)
    begins = (_widened(solution, unknowns), _best_start(problem, slider, law))
    others = [settled(problem, begin, noise) for begin in begins]
    best = max(others, key=lambda one: one.log_likelihood)
    gains = best.log_likelihood - solution.log_likelihood, _early(best) - _early(solution)
    return best if min(gains) > 0.5 * FALL else solution


def _best_start(problem, slider, law):
    """The best point that a thinned record leads to, from several starts."""
    thin = problem.record.every(max(problem.record.t.size // SAMPLES, 1))
    rough = Problem(thin, slider, law, problem.unknowns)
    points = starting_points(rough, slider)[:STARTS]
    if not points:
        raise ParameterError(NO_MOTION)
    plain = rough.plain_noise(points[0])
    found: list = []
    for point in points:
        one = search(rough, point, plain, FEW)
        found = sorted([*found, *([one] if one else [])], key=lambda one: one.cost)
        # a least sum that two starts have led to is not passed by a third
        if len(found) > 1 and found[1].cost <= found[0].cost * (1.0 + AGREE):
            break
    if not found:
        raise ParameterError(NO_MOTION)
    return found[0].x


def _searched(problem, point, noise):
    """What `search` finds from this point; ParameterError if that is nothing."""
    found = search(problem, point, noise)
    if not found:
        raise ParameterError(NO_MOTION)
    return found


def settled(problem, point, noise):
    """The `Solution` from this point, with noise as given or estimated until nothing moves."""
    record = problem.record
    guess = problem.plain_noise(point) if noise is None else noise
    before = problem.forward.evaluations
    found, was_white = _searched(problem, point, guess), True
    for _ in range(ROUNDS if noise is None else 0):
        fitted, jacobian = problem.forward.jacobian(found.x)
        guess = estimated_noise(record.t, fitted - record.friction, np.nan_to_num(jacobian))
        # what the march itself leaves unsure counts as noise: a record may have none
        guess = guess._replace(white=float(np.hypot(guess.white, FLOOR * record.scale)))
        if guess.red == 0.0 and was_white:
            break  # other weights, all alike, are no other sum of squares
        last, was_white = found.x, False
        found = _searched(problem, last, guess)
        error = np.sqrt(np.diag(_covariance(found.jac)))
        if (np.abs(found.x - last) <= STILL * error).all():
            break
    noise = guess
    fitted, jacobian = problem.forward.jacobian(found.x)
    jacobian = np.nan_to_num(jacobian)
    white, log_determinant = noise.whiten(
        record.t, np.column_stack([fitted - record.friction, jacobian])
    )
    chi2 = float(white[:, 0] @ white[:, 0])
    constant = record.t.size * np.log(2.0 * np.pi)
    return Solution(
        problem,
        noise,
        found.x,
        _covariance(white[:, 1:]),
        fitted,
        jacobian,
        chi2,
        -0.5 * (chi2 + log_determinant + constant),
        found.status > 0,
        problem.forward.evaluations - before,
    )


def _covariance(jacobian):
    """(k, k) inverse of the normal matrix; a direction that is not seen at all has no end."""
    scale = np.linalg.norm(jacobian, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    _, s, vt = np.linalg.svd(jacobian / scale, full_matrices=False)
    spread = vt.T / np.maximum(s, 1e-9)
    return spread @ spread.T / np.outer(scale, scale)


def _widened(solution, unknowns):
    """A point of more coordinates, the new ones at 0."""
    point = np.zeros(len(unknowns.names))
    for i, name in enumerate(solution.unknowns.names):
        point[unknowns.place(name)] = solution.point[i]
    return point


def _may_start_unsteady(solution, slider, law):
    """Whether a start out of steady sliding may fit better: by a score test, or red misfit."""
    if solution.noise.red:
        return True
    forward = Forward(solution.problem.record, slider, law, (*START, *solution.unknowns.names))
    jacobian = np.nan_to_num(forward.jacobian(np.append([0.0, 0.0], solution.point))[1])
    return gain_of(solution, jacobian[:, : len(START)])[0] > FALL


def _early(solution):
    """ln(likelihood) of what was recorded before the first step, where a start shows.

    What comes later a start can only spoil: it must not stand in for mass, or another law.
    """
    record = solution.problem.record
    early = record.t < record.loading.t[1]
    residual = (record.friction - solution.fitted)[early]
    white, log_determinant = solution.noise.whiten(record.t[early], residual)
    return -0.5 * (float(np.sum(white**2)) + log_determinant)
