"""The method of Levenberg and Marquardt, within bounds.

SciPy's `least_squares` asks for residuals and derivatives one after the other; here one march gives
both, for little more than the residuals alone.  Steps are damped in the scale of the derivatives
and clipped to the bounds; a coordinate stays at a bound beyond which the sum of squares would fall.
How the damping follows from the last step: Nielsen (1999), report IMM-REP-1999-05.
"""

from typing import NamedTuple

import numpy as np

#: damping of the first step, and the largest, over the squares of the scaled derivatives
FIRST, LARGEST = 1e-2, 1e12
#: relative fall of the sum of squares by the linear model within which its minimum is exact: with n
#: samples it is sqrt(n CONVERGED) standard errors away
CONVERGED = 1e-7
#: squares of scaled derivatives, along principal axes, from which on the record sees an axis
SEEN = 1e-13


class Minimum(NamedTuple):
    """Where a search has ended."""

    x: np.ndarray  # (k,)
    cost: float  # half the sum of squares
    jacobian: np.ndarray  # (m, k)
    converged: bool


def minimum(function, start, low, high, most):
    """The `Minimum` of a sum of squares; None where the residual at the start is not finite.

    function : of a point (k,): residual (m,), and jacobian (m, k), which is finite; the search
        does not go where the residual is not finite
    start, low, high : (k,) a point, moved within the bounds, and these
    most : evaluations
    """
    x = np.clip(start, low, high)
    residual, jacobian = function(x)
    cost = _half_square(residual)
    if not np.isfinite(cost):
        return None
    damping, growth, scale = FIRST, 2.0, np.zeros(x.size)
    for _ in range(most - 1):
        slope = jacobian.T @ residual
        free = ~(((x <= low) & (slope >= 0.0)) | ((x >= high) & (slope <= 0.0)))
        scale = np.maximum(scale, np.linalg.norm(jacobian, axis=0))
        size = np.where(scale > 0.0, scale, 1.0)[free]
        scaled = jacobian[:, free] / size
        squares, axes = np.linalg.eigh(scaled.T @ scaled)
        along = axes.T @ (slope[free] / size)
        step = np.zeros(x.size)
        step[free] = -(axes @ (along / (np.maximum(squares, 0.0) + damping))) / size
        trial = np.clip(x + step, low, high)
        step = trial - x
        expected = -float(slope @ step) - _half_square(jacobian @ step)
        seen = squares > SEEN
        if 0.5 * np.sum(along[seen] ** 2 / squares[seen]) <= CONVERGED * cost:
            return Minimum(trial, cost - max(expected, 0.0), jacobian, True)
        if damping > LARGEST:  # rounding is all that is left
            return Minimum(x, cost, jacobian, True)
        residual_there, jacobian_there = function(trial)
        fall = cost - _half_square(residual_there)
        if fall > 0.0 and expected > 0.0:
            x, cost = trial, cost - fall
            residual, jacobian = residual_there, jacobian_there
            damping *= max(1.0 / 10.0, 1.0 - (2.0 * fall / expected - 1.0) ** 3)
            growth = 2.0
        else:
            damping, growth = damping * growth, 2.0 * growth
    return Minimum(x, cost, jacobian, False)


def _half_square(x):
    return 0.5 * float(x @ x)
