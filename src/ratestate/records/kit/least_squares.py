"""The method of Levenberg and Marquardt, within bounds.

SciPy's `least_squares` finds the same minima in about the same time, if one march gives it both
residuals and derivatives.  But it may move a coordinate on which the residuals do not depend to a
bound, such as the initial velocity of a rigid machine.  Here steps are damped in the scale of the
derivatives and clipped to the bounds.  A coordinate is held at a bound if the sum of squares would
decrease beyond it.  The damping is updated as by Nielsen (1999), report IMM-REP-1999-05.
"""

import functools
from typing import Any, NamedTuple

import numpy as np
from threadpoolctl import ThreadpoolController

#: damping of the first step, and largest damping, relative to squares of scaled derivatives
FIRST, LARGEST = 1e-2, 1e12
#: relative fall of the sum of squares in the linear model at which the search has converged; with
#: n samples, the minimum is then within sqrt(n CONVERGED) standard errors
CONVERGED = 1e-7
#: least significant derivative along a principal axis, if derivatives by coordinates are 1
SEEN = 1e-8


class Minimum(NamedTuple):
    """The end of a search."""

    x: np.ndarray  # (k,)
    cost: float  # half the sum of squares
    jacobian: np.ndarray  # (m, k)
    converged: bool


def minimum(function, start, low, high, most, enough=0.0):
    """Find the `Minimum` of a sum of squares; None if the residual at the start is not finite.

    function : returns the residual (m,) and the finite jacobian (m, k) at a point (k,).  The search
        avoids points at which the residual is not finite.
    start, low, high : (k,) starting point, which is clipped to the bounds, and the bounds
    most : largest number of evaluations
    enough : fall of the sum of squares in the linear model at which the search also ends
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
        if damping > LARGEST:  # only rounding remains, or all steps are blocked
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
    """Linear model of the residuals about a point, with some coordinates held at bounds."""

    def __init__(self, x, residual, jacobian, low, high):
        self.jacobian, self.slope = jacobian, jacobian.T @ residual
        self.at_low, self.at_high = x <= low, x >= high
        self.free = ~self._held(self.slope)
        size = np.linalg.norm(jacobian[:, self.free], axis=0)
        self.size = np.where(size > 0.0, size, 1.0)
        # the R of a QR decomposition has the same inner products as the columns
        columns = np.column_stack([jacobian[:, self.free] / self.size, residual])
        triangle: Any = np.linalg.qr(columns, mode="r")
        self.columns, self.residual = triangle[:, :-1], triangle[:, -1]

    def _held(self, slope):
        """Return (k,) whether the sum of squares would decrease beyond a bound."""
        return (self.at_low & (slope >= 0.0)) | (self.at_high & (slope <= 0.0))

    @property
    def most_fall(self):
        """Return half the fall of the sum of squares to its minimum without bounds."""
        u, s, _ = np.linalg.svd(self.columns, full_matrices=False)
        return _half_square(u.T[s > SEEN] @ self.residual)

    def step(self, damping, scale):
        """Return the damped step (k,) of the free coordinates."""
        weights = np.diag(np.sqrt(damping) * scale[self.free] / self.size)
        target = np.concatenate([self.residual, np.zeros(len(weights))])
        moved = np.linalg.lstsq(np.concatenate([self.columns, weights]), -target, rcond=None)[0]
        step = np.zeros(self.free.size)
        step[self.free] = moved / self.size
        return step

    def fall(self, step):
        """Return half the fall of the sum of squares by a step (k,)."""
        return -float(self.slope @ step) - _half_square(self.jacobian @ step)

    def frees_by(self, step):
        """Return whether a held coordinate would become free after a step (k,)."""
        slope = self.slope + self.jacobian.T @ (self.jacobian @ step)
        return bool((~self.free & ~self._held(slope)).any())


def _half_square(x):
    return 0.5 * float(x @ x)


_thread_pools = functools.cache(ThreadpoolController)


def single_blas():
    """Return a context in which BLAS uses one thread, because more threads mostly wait."""
    return _thread_pools().limit(limits=1, user_api="blas")
