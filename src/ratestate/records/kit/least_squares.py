"""The method of Levenberg and Marquardt, within bounds.

SciPy's `least_squares` reaches the same minima in as much time, if one march gives it residuals and
derivatives.  But it may move a coordinate that the residuals do not depend on, such as the velocity
at the start of a rigid machine, to a bound.  Steps are damped in the scale of the derivatives and
clipped to the bounds; a coordinate stays at a bound beyond which the sum of squares would fall.
How the damping follows from the last step: Nielsen (1999), report IMM-REP-1999-05.
"""

import functools
from typing import Any, NamedTuple

import numpy as np
from threadpoolctl import ThreadpoolController

#: damping of the first step, and the largest, over the squares of the scaled derivatives
FIRST, LARGEST = 1e-2, 1e12
#: relative fall of the sum of squares by the linear model within which its minimum is exact: with n
#: samples it is sqrt(n CONVERGED) standard errors away
CONVERGED = 1e-7
#: least derivative along a principal axis, where those by coordinates are 1, that a record sees
SEEN = 1e-8


class Minimum(NamedTuple):
    """Where a search has ended."""

    x: np.ndarray  # (k,)
    cost: float  # half the sum of squares
    jacobian: np.ndarray  # (m, k)
    converged: bool


def minimum(function, start, low, high, most, enough=0.0):
    """The `Minimum` of a sum of squares; None where the residual at the start is not finite.

    function : of a point (k,): residual (m,), and jacobian (m, k), which is finite; the search
        does not go where the residual is not finite
    start, low, high : (k,) a point, moved within the bounds, and these
    most : evaluations
    enough : fall of the sum of squares, by the linear model, at which the search ends too
    """
    x = np.clip(start, low, high)
    residual, jacobian = function(x)
    cost = _half_square(residual)
    if not np.isfinite(cost):
        return None
    damping, growth, scale, blocked = FIRST, 2.0, np.zeros(x.size), False
    for _ in range(most - 1):
        linear = _Linear(x, residual, jacobian, low, high)
        scale = np.maximum(scale, np.linalg.norm(jacobian, axis=0))
        trial = np.clip(x + linear.step(damping, scale), low, high)
        expected = linear.fall(trial - x)
        converged = linear.most_fall <= CONVERGED * cost + 0.5 * enough
        if converged and not linear.frees_by(trial - x):
            better = expected > 0.0  # clipped, a step may lead up
            return Minimum(trial if better else x, cost - max(expected, 0.0), jacobian, True)
        if damping > LARGEST:  # rounding is all that is left, or a region without motion
            return Minimum(x, cost, jacobian, not blocked)
        residual_there, jacobian_there = function(trial)
        fall = cost - _half_square(residual_there)
        if fall > 0.0 and expected > 0.0:
            x, cost, blocked = trial, cost - fall, False
            residual, jacobian = residual_there, jacobian_there
            damping *= max(1.0 / 10.0, 1.0 - (2.0 * fall / expected - 1.0) ** 3)
            growth = 2.0
        else:
            blocked = blocked or not np.isfinite(fall)
            damping, growth = damping * growth, 2.0 * growth
    return Minimum(x, cost, jacobian, False)


class _Linear:
    """The linear model of the residuals about a point, with some coordinates held at bounds."""

    def __init__(self, x, residual, jacobian, low, high):
        self.jacobian, self.slope = jacobian, jacobian.T @ residual
        self.at_low, self.at_high = x <= low, x >= high
        self.free = ~self._held(self.slope)
        size = np.linalg.norm(jacobian[:, self.free], axis=0)
        self.size = np.where(size > 0.0, size, 1.0)
        # of a QR decomposition, R has the same inner products as the columns
        columns = np.column_stack([jacobian[:, self.free] / self.size, residual])
        triangle: Any = np.linalg.qr(columns, mode="r")
        self.columns, self.residual = triangle[:, :-1], triangle[:, -1]

    def _held(self, slope):
        """(k,) whether a coordinate is at a bound beyond which the sum of squares would fall."""
        return (self.at_low & (slope >= 0.0)) | (self.at_high & (slope <= 0.0))

    @property
    def most_fall(self):
        """Half the fall of the sum of squares to its minimum, were there no bounds."""
        u, s, _ = np.linalg.svd(self.columns, full_matrices=False)
        return _half_square(u.T[s > SEEN] @ self.residual)

    def step(self, damping, scale):
        """(k,) the damped step, of the free coordinates."""
        weights = np.diag(np.sqrt(damping) * scale[self.free] / self.size)
        target = np.concatenate([self.residual, np.zeros(len(weights))])
        moved = np.linalg.lstsq(np.concatenate([self.columns, weights]), -target, rcond=None)[0]
        step = np.zeros(self.free.size)
        step[self.free] = moved / self.size
        return step

    def fall(self, step):
        """Half the fall of the sum of squares by a step (k,)."""
        return -float(self.slope @ step) - _half_square(self.jacobian @ step)

    def frees_by(self, step):
        """Whether after a step (k,) some coordinate would leave the bound at which it is held."""
        slope = self.slope + self.jacobian.T @ (self.jacobian @ step)
        return bool((~self.free & ~self._held(slope)).any())


def _half_square(x):
    return 0.5 * float(x @ x)


_thread_pools = functools.cache(ThreadpoolController)


def single_blas():
    """A context in which BLAS uses one thread: more spin longer than they work."""
    return _thread_pools().limit(limits=1, user_api="blas")
