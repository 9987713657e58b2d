"""Least squares of the features of cycles, from many starts.

A point is the coordinates of the free parameters (space.py), and mu0, which only moves the level.
"""

from typing import NamedTuple

import numpy as np

from ...kit.least_squares import minimum
from ..unknowns import distinct
from .features import LEVEL
from .space import FAR

# Points of the cloud, most starts among them, and least distance between two starts.
CLOUD, STARTS, DISTANCE, SEED = 512, 4, 0.3, 20190117
# Least relative error of features in the choice of starts: the shape matters there, not digits.
ROUGH = 0.1
# Step of a difference in a coordinate.
STEP = 1e-3
# Most evaluations of a search, and the fall of chi-squared, by the linear model, at which it ends.
MOST_EVALUATIONS, ENOUGH = 50, 0.01

# Error of a coordinate, or of a combination, that no feature depends on.
WIDEST = 50.0
# Runs are distinct if they end more standard errors apart.
DISTINCT = 4.0


class Run(NamedTuple):
    """Where a least-squares search began and ended."""

    start: np.ndarray  # (k,) coordinates
    point: np.ndarray  # (k + 1,) coordinates at the end, and mu0
    chi2: float  # inf without a cycle
    status: str  # "converged", "at a bound", "no cycle" or "not converged"
    jacobian: np.ndarray  # (features, k + 1) of the whitened residual
    near: np.ndarray | None  # (segments, 2) the cycles at the end

    @property
    def end(self):
        """(k,) coordinates at the end."""
        return self.point[:-1]

    @property
    def mu0(self):
        return float(self.point[-1])

    @property
    def covariance(self):
        """(k + 1, k + 1) inverse of the normal matrix, errors being `WIDEST` at most."""
        _, size, axes = np.linalg.svd(self.jacobian, full_matrices=False)
        return (axes.T / np.maximum(size, 1.0 / WIDEST) ** 2) @ axes


def distinct_runs(runs, covariance):
    """Indices of the best run and of those that end away from it and from each other.

    covariance : (k + 1, k + 1) of a point, by which distances are measured
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
        self.near = None

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

    def linearized(self, point):
        """Residuals (features,) at a point (k + 1,), and their derivatives (features, k + 1).

        NaN without a cycle, and derivatives of 0; a derivative is one-sided where cycles end.
        """
        q, k = point[:-1], point.size - 1
        steps = STEP * np.concatenate([np.zeros((1, k)), np.eye(k), -np.eye(k)])
        residuals = self.residuals(q + steps)
        centre, up, down = residuals[0], residuals[1 : k + 1], residuals[k + 1 :]
        up_step, down_step = np.isfinite(up[:, :1]), np.isfinite(down[:, :1])
        width = STEP * (up_step.astype(float) + down_step)
        change = np.where(up_step, up, centre) - np.where(down_step, down, centre)
        columns = np.nan_to_num((change / np.maximum(width, STEP)).T)
        return centre + point[-1] * self.levels, np.column_stack([columns, self.levels])

    def with_best_mu0(self, q):
        """The point (k + 1,) at coordinates q (k,) whose mu0 fits best; NaN without a cycle."""
        residual = self.residuals(q[None])[0]
        return np.append(q, -(residual @ self.levels) / (self.levels @ self.levels))

    def value(self, name, point):
        """A reported quantity at a point (k + 1,): a logarithm, mu0, or a - b."""
        if name == "mu0":
            return float(point[-1])
        return float(self.space.value(name, point[None, :-1])[0])

    def gradient(self, name, point):
        """(k + 1,) derivative of `value` by the point."""
        if name == "mu0":
            return np.append(np.zeros(point.size - 1), 1.0)
        return np.append(self.space.gradient(name, point[:-1]), 0.0)

    def search(self, start):
        """`Run` of least squares from coordinates start (k,); ends there if there is no cycle."""
        self.near = None
        point = self.with_best_mu0(start)
        away = np.append(np.full(start.size, FAR), np.inf)
        found = None
        if np.isfinite(point).all():
            reach = point - away, point + away
            found = minimum(self.linearized, point, *reach, MOST_EVALUATIONS, ENOUGH)
        if found is None:
            nothing = np.zeros((self.levels.size, point.size))
            return Run(start, np.append(start, 0.0), np.inf, "no cycle", nothing, None)
        bound = np.any(np.abs(found.x[:-1] - start) > 0.999 * FAR)
        status = "at a bound" if bound else "converged" if found.converged else "not converged"
        return self.run(start, found.x, status)

    def run(self, start, point, status):
        """`Run` that ended at a point (k + 1,), which has a cycle near the last one."""
        residual, jacobian = self.linearized(point)
        return Run(start, point, float(residual @ residual), status, jacobian, self.near)


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
