"""Least squares of the features of cycles, from many starts."""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..unknowns import distinct
from .features import LEVEL
from .space import FAR

# Points of the cloud, most starts among them, and least distance between two starts.
CLOUD, STARTS, DISTANCE, SEED = 512, 4, 0.3, 20190117
# Least relative error of features in the choice of starts: the shape matters there, not digits.
ROUGH = 0.1
# Step of a difference in a coordinate.
STEP = 1e-3
# Residual of each feature where there is no cycle: far above any other, but finite.
NO_CYCLE = 1e8
MOST_EVALUATIONS = 50
# A constant residual, and the relative fall of the sum of squares at which the search ends:
# together a fall of chi-squared by 0.01.
FLOOR, FTOL = 3.0, 1e-3

# Error of a coordinate, or of a combination, that no feature depends on.
WIDEST = 50.0
# Runs are distinct if they end more standard errors apart.
DISTINCT = 4.0
# No penalty: a residual of 0, its derivatives by the coordinates, and by mu0.
NO_PENALTY = (0.0, 0.0, 0.0)


class Run(NamedTuple):
    """Where a least-squares search began and ended."""

    start: np.ndarray  # (k,) coordinates
    end: np.ndarray  # (k,)
    mu0: float
    chi2: float
    status: str  # "converged", "at a bound", "no cycle" or "not converged"
    jacobian: np.ndarray  # (features, k + 1) of the whitened residual; mu0 last
    near: np.ndarray | None  # (segments, 2) the cycles at the end

    @property
    def covariance(self):
        """(k + 1, k + 1) inverse of the normal matrix, errors being `WIDEST` at most."""
        _, size, axes = np.linalg.svd(self.jacobian, full_matrices=False)
        return (axes.T / np.maximum(size, 1.0 / WIDEST) ** 2) @ axes


def distinct_runs(runs, covariance):
    """Indices of the best run and of those that end away from it and from each other.

    covariance : (k + 1, k + 1) of the coordinates, by which distances are measured, and mu0
    """
    # (coordinate by coordinate: along a curved valley the covariance at one end misleads)
    errors = np.sqrt(np.diag(covariance)[:-1])
    return distinct([run.end for run in runs], DISTINCT * errors)


class Problem:
    """Whitened residuals of the features that a record resolves, and their derivatives."""

    def __init__(self, space, model, measured):
        self.space, self.model, self.measured = space, model, measured
        covariances = [one.covariance[np.ix_(one.used, one.used)] for one in measured]
        self.whiten = [np.linalg.inv(np.linalg.cholesky(one)) for one in covariances]
        levels = [np.flatnonzero(one.used) == LEVEL for one in measured]
        self.levels = np.concatenate([w @ x for w, x in zip(self.whiten, levels, strict=True)])
        self.begin_at(None)

    def begin_at(self, near):
        """Start the next search for cycles from these (segments, 2), whatever came before."""
        self.near = near
        self._last: tuple = (np.array([]), None)  # coordinates, and what `linearized` gives there

    def residuals(self, q):
        """(n, features) fitted less measured over error, with mu0 = 0; NaN without a cycle.

        The search for a cycle starts from the last one, which is near; where cycles coexist with
        steady sliding, it so stays on the cycle.
        """
        values = self.space.values(q)
        features, points, _ = self.model.features(values, self.near)
        if self.near is not None and not np.isfinite(features[0]).all():
            features, points, _ = self.model.features(values)
        if np.isfinite(features[0]).all():
            self.near = points[0]
        parts = [
            (features[:, j, one.used] - one.values[one.used]) @ w.T
            for j, (w, one) in enumerate(zip(self.whiten, self.measured, strict=True))
        ]
        return np.concatenate(parts, axis=1)

    def linearized(self, q):
        """Residuals (features,) with mu0 = 0, and their derivatives (features, k), at q (k,).

        NaN without a cycle; a derivative is one-sided where cycles end.
        """
        if not np.array_equal(self._last[0], q):
            k = q.size
            steps = STEP * np.concatenate([np.zeros((1, k)), np.eye(k), -np.eye(k)])
            residuals = self.residuals(q + steps)
            centre, up, down = residuals[0], residuals[1 : k + 1], residuals[k + 1 :]
            # one-sided where cycles end
            up_step, down_step = np.isfinite(up[:, :1]), np.isfinite(down[:, :1])
            width = STEP * (up_step.astype(float) + down_step)
            change = np.where(up_step, up, centre) - np.where(down_step, down, centre)
            self._last = (q.copy(), (centre, (change / np.maximum(width, STEP)).T))
        return self._last[1]

    def has_cycle(self, q):
        """Whether there are cycles, at all speeds, at coordinates q (k,)."""
        return np.isfinite(self.linearized(q)[0]).all()

    def best_mu0(self, q, penalty=NO_PENALTY):
        """The mu0 that fits best at coordinates q (k,)."""
        levels = np.append(self.levels, penalty[2])
        residual = np.append(np.nan_to_num(self.linearized(q)[0]), penalty[0])
        return -float(residual @ levels / (levels @ levels))

    def value(self, name, q):
        """A reported quantity at coordinates q (k,): a logarithm, the best mu0, or a - b."""
        if name == "mu0":
            return self.best_mu0(q)
        return float(self.space.value(name, q[None])[0])

    def gradient(self, name, q):
        """(k,) derivative of `value` by the coordinates."""
        if name == "mu0":
            columns = np.nan_to_num(self.linearized(q)[1])
            return -self.levels @ columns / (self.levels @ self.levels)
        return self.space.gradient(name, q)

    def _without_level(self, vectors, penalty):
        """Residuals, or columns of them (features + 1, k), with the best mu0 taken out."""
        levels = np.append(self.levels, penalty[2])
        unit = levels / np.linalg.norm(levels)
        return vectors - np.multiply.outer(unit, unit @ vectors)

    def residual(self, q, penalty=NO_PENALTY):
        """(features + 2,) at coordinates q (k,) and the best mu0; `FLOOR` last.

        penalty : one more residual, its derivatives by the coordinates, and by mu0
        """
        residual = np.append(self.linearized(q)[0], penalty[0])
        if np.isfinite(residual).all():
            residual = self._without_level(residual, penalty)
        else:
            residual = np.full(residual.size, NO_CYCLE)
        return np.append(residual, FLOOR)

    def jacobian(self, q, penalty=NO_PENALTY):
        """(features + 2, k) of `residual`."""
        columns = np.nan_to_num(self.linearized(q)[1])
        columns = np.vstack([columns, np.broadcast_to(penalty[1], q.size)])
        return np.vstack([self._without_level(columns, penalty), np.zeros(q.size)])

    def search(self, start):
        """`Run` of least squares from coordinates start (k,); ends there if there is no cycle."""
        self.begin_at(None)
        if not self.has_cycle(start):
            return self.run(start, start, "no cycle")
        result = least_squares(
            self.residual,
            start,
            self.jacobian,
            bounds=(start - FAR, start + FAR),
            x_scale="jac",
            ftol=FTOL,
            xtol=1e-6,
            gtol=1e-8,
            max_nfev=MOST_EVALUATIONS,
        )
        bound = np.any(np.abs(result.x - start) > 0.999 * FAR)
        status = "at a bound" if bound else "converged" if result.status > 0 else "not converged"
        return self.run(start, result.x, status)

    def run(self, start, end, status):
        """`Run` that ended at coordinates end (k,); its chi2 is inf if there is no cycle."""
        residual, jacobian = self.linearized(end)
        chi2 = np.inf
        if np.isfinite(residual).all():
            chi2 = float(np.sum(self._without_level(np.append(residual, 0.0), NO_PENALTY) ** 2))
        full = np.column_stack([np.nan_to_num(jacobian), self.levels])
        return Run(start, end, self.best_mu0(end), chi2, status, full, self.near)


def starts(space, model, measured):
    """(m, k) coordinates to search from, the best of a cloud, all distinct; m <= `STARTS`, or 0."""
    first = measured[0]
    amplitude, period = np.exp(first.values[:2])
    q = space.cloud(CLOUD, amplitude, period, first.segment.V_lp, SEED)
    features = model.features(space.values(q))[0]
    misfit = np.zeros(len(q))
    for j, one in enumerate(measured):
        shape = one.used.copy()
        shape[LEVEL] = False  # mu0 can still adjust it
        error = np.diag(one.covariance)[shape] + ROUGH**2
        misfit += np.sum((features[:, j, shape] - one.values[shape]) ** 2 / error, axis=1)
    best = q[np.argsort(misfit, kind="stable")[: np.isfinite(misfit).sum()]]
    return best[distinct(best, DISTANCE, STARTS)]
