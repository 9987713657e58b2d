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
        # the R of a QR decomposition has the same inner products as the columns
        triangle: Any = np.linalg.qr(np.column_stack([jacobian, residual]), mode="r")
        by_x, rest = triangle[:, :-1], triangle[:, -1]
        slope, size = by_x.T @ rest, np.linalg.norm(by_x, axis=0)
        free, scale = ~_is_held(x, slope, low, high), np.maximum(scale, size)
        size = np.where(size > 0.0, size, 1.0)[free]
        columns = by_x[:, free] / size
        weights = np.diag(np.sqrt(damping) * scale[free] / size)
        damped = np.concatenate([columns, weights]), np.append(rest, np.zeros(len(weights)))
        trial = x.copy()
        trial[free] -= np.linalg.lstsq(*damped, rcond=None)[0] / size
        trial = np.clip(trial, low, high)
        change = by_x @ (trial - x)
        expected = -float(slope @ (trial - x)) - _half_square(change)
        u, s, _ = np.linalg.svd(columns, full_matrices=False)
        most_fall = _half_square(u.T[s > SEEN] @ rest)  # to the minimum without bounds
        frees = ~free & ~_is_held(x, slope + by_x.T @ change, low, high)
        if most_fall <= CONVERGED * cost + 0.5 * enough and not frees.any():
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


def _is_held(x, slope, low, high):
    """Return (k,) whether the sum of squares would decrease beyond a bound."""
    return ((x <= low) & (slope >= 0.0)) | ((x >= high) & (slope <= 0.0))


def _half_square(x):
    return 0.5 * float(x @ x)


_thread_pools = functools.cache(ThreadpoolController)


def single_blas():
    """Return a context in which BLAS uses one thread, because more threads mostly wait."""
    return _thread_pools().limit(limits=1, user_api="blas")
