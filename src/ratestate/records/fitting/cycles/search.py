"""Least squares of the features of cycles, from many starts."""

from typing import NamedTuple

import numpy as np

from .features import LEVEL
from .space import FAR

# Points of the cloud, the best of which are starts; their least distance from each other.
CLOUD, STARTS, APART, SEED = 512, 4, 0.3, 20190117
# In the cloud features count as no better known than this (of 1): shape first, digits later.
ROUGH = 0.1
# Step of a difference in a coordinate.
STEP = 1e-3
# Residual of each feature where there is no cycle: far above any other, but finite.
NO_CYCLE = 1e8
MOST_EVALUATIONS = 50
# A residual that never changes, and the part of the sum of squares that is too little to go on
# for: together a fall of chi-squared by 0.01.
FLOOR, FTOL = 3.0, 1e-3

# Error of a coordinate, or a combination of some, that no feature tells.
WIDEST = 50.0
# A residual that is none, its derivatives by the coordinates, and by mu0.
NO_PULL = (0.0, 0.0, 0.0)


class Run(NamedTuple):
    """Where a least-squares search began and ended."""

    start: np.ndarray  # (k,) coordinates
    end: np.ndarray  # (k,)
    mu0: float
    chi2: float
    status: str  # "converged", "at a bound", "no cycle" or "not converged"
    jacobian: np.ndarray  # (features, k + 1) of the whitened residual; mu0 last

    @property
    def covariance(self):
        """(k + 1, k + 1) inverse of the normal matrix; of what no feature tells, `WIDEST`."""
        _, size, axes = np.linalg.svd(self.jacobian, full_matrices=False)
        return (axes.T / np.maximum(size, 1.0 / WIDEST) ** 2) @ axes


class Problem:
    """Whitened residuals of the features that a record resolves, and their derivatives."""

    def __init__(self, space, model, measured):
        self.space, self.model, self.measured = space, model, measured
        self.used = np.array([found.used for found in measured])
        self.whiten = [
            np.linalg.inv(np.linalg.cholesky(found.covariance[np.ix_(found.used, found.used)]))
            for found in measured
        ]
        self.levels = np.concatenate(
            [w @ (np.flatnonzero(found.used) == LEVEL) for w, found in self._each()]
        )
        self.known: tuple = (np.array([]), None)
        self.near = None

    def _each(self):
        return zip(self.whiten, self.measured, strict=True)

    def residuals(self, q):
        """(n, features) fitted less measured over error, with mu0 = 0; NaN without a cycle.

        Cycles are sought from the last one found, which is near and, where a cycle coexists with
        steady sliding, stays on it.
        """
        values = self.space.values(q)
        fitted, points = self.model.features(values, self.near)
        if self.near is not None and not np.isfinite(fitted[0]).all():
            fitted, points = self.model.features(values)
        if np.isfinite(fitted[0]).all():
            self.near = points[0]
        parts = [
            (fitted[:, j, found.used] - found.values[found.used]) @ w.T
            for j, (w, found) in enumerate(self._each())
        ]
        return np.concatenate(parts, axis=1)

    def at(self, q):
        """Residuals (features,) with mu0 = 0, and their derivatives (features, k), at q (k,)."""
        if not np.array_equal(self.known[0], q):
            k = q.size
            steps = STEP * np.concatenate([np.zeros((1, k)), np.eye(k), -np.eye(k)])
            found = self.residuals(q + steps)
            here, up, down = found[0], found[1 : k + 1], found[k + 1 :]
            # one-sided where cycles end
            up_step, down_step = np.isfinite(up[:, :1]), np.isfinite(down[:, :1])
            width = STEP * (up_step.astype(float) + down_step)
            change = np.where(up_step, up, here) - np.where(down_step, down, here)
            self.known = (q.copy(), (here, (change / np.maximum(width, STEP)).T))
        return self.known[1]

    def best_mu0(self, q, pull=NO_PULL):
        """The mu0 that fits best at coordinates q (k,)."""
        levels = np.append(self.levels, pull[2])
        return -float(np.append(np.nan_to_num(self.at(q)[0]), pull[0]) @ levels / (levels @ levels))

    def best_mu0_gradient(self, q):
        """(k,) derivative of `best_mu0` without a pull."""
        return -self.levels @ np.nan_to_num(self.at(q)[1]) / (self.levels @ self.levels)

    def _without_level(self, vectors, pull):
        """Residuals, or columns of them (features + 1, k), with the best mu0 taken out."""
        levels = np.append(self.levels, pull[2])
        unit = levels / np.linalg.norm(levels)
        return vectors - np.multiply.outer(unit, unit @ vectors)

    def residual(self, q, pull=NO_PULL):
        """(features + 2,) at coordinates q (k,) and the best mu0; `FLOOR` last.

        pull : a residual more, its derivatives by the coordinates, and by mu0
        """
        found = np.append(self.at(q)[0], pull[0])
        whole = np.isfinite(found).all()
        found = self._without_level(found, pull) if whole else np.full(found.size, NO_CYCLE)
        return np.append(found, FLOOR)

    def jacobian(self, q, pull=NO_PULL):
        """(features + 2, k) of `residual`."""
        found = np.vstack([np.nan_to_num(self.at(q)[1]), np.broadcast_to(pull[1], q.size)])
        return np.vstack([self._without_level(found, pull), np.zeros(q.size)])

    def search(self, start):
        """`Run` of least squares from coordinates start (k,)."""
        from scipy.optimize import least_squares

        self.near = None
        if not np.isfinite(self.at(start)[0]).all():
            return self.run(start, start, "no cycle")
        found = least_squares(
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
        bound = np.any(np.abs(found.x - start) > 0.999 * FAR)
        status = "at a bound" if bound else "converged" if found.status > 0 else "not converged"
        return self.run(start, found.x, status)

    def run(self, start, end, status):
        """`Run` that has come to coordinates end (k,)."""
        residual, jacobian = self.at(end)
        chi2 = np.inf
        if np.isfinite(residual).all():
            chi2 = float(np.sum(self._without_level(np.append(residual, 0.0), NO_PULL) ** 2))
        full = np.column_stack([np.nan_to_num(jacobian), self.levels])
        return Run(start, end, self.best_mu0(end), chi2, status, full)


def starts(space, model, measured, sigma):
    """(m, k) coordinates to search from: the best of a cloud, apart from each other."""
    first = measured[0]
    amplitude, period = np.exp(first.values[:2])
    q = space.cloud(CLOUD, amplitude, period, first.segment.V_lp, sigma, SEED)
    fitted, _ = model.features(space.values(q))
    misfit = np.zeros(len(q))
    for j, found in enumerate(measured):
        shape = found.used.copy()
        shape[LEVEL] = False  # which mu0 may yet move
        error = np.diag(found.covariance)[shape] + ROUGH**2
        misfit += np.sum((fitted[:, j, shape] - found.values[shape]) ** 2 / error, axis=1)
    order = np.argsort(misfit, kind="stable")
    chosen: list = []
    for i in order[: np.isfinite(misfit).sum()]:
        if all(np.abs(q[i] - q[j]).max() > APART for j in chosen):
            chosen.append(i)
        if len(chosen) == STARTS:
            break
    return q[chosen]
