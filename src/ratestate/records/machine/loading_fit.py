"""Fits of a loading curve (loading_curve.py) to a record.

Of a and the rate of healing, whose effects are hardly seen, it is assumed that they are typical of
rocks and gouges, to a factor of about two: a is 0.008, and friction heals by 0.008 per decade
(Marone 1998 doi:10.1146/annurev.earth.26.1.643).
"""

from typing import NamedTuple

import numpy as np

from ..kit.estimated_noise import estimated_noise
from ..kit.least_squares import minimum
from ..kit.noise import Noise
from .loading_curve import LoadingCurve, curve, relaxation

#: what is assumed of a and of healing per e-fold of time; standard deviation of their logarithms
A, HEALING, LOG_ERROR = 0.008, 0.0035, 0.6
#: largest part of k that healing is
MOST_HEALING = 0.5
#: how far ln k may be from that of a straight line; rounds of noise and fit; most evaluations
FACTOR, ROUNDS, EVALUATIONS = 2.0, 3, 100
#: smallest and largest r after a hold
CREEP = 1e-12, 0.9
#: number of coordinates p: mu_0, ln k, ln a, x_0, ln of healing, creep, bend; step of a difference
PARAMETERS, STEP = 7, 1e-5


class _Model(NamedTuple):
    """Friction at displacements x by the coordinates p, with what is known beforehand."""

    slope: float  # of a straight line, over 1 - r [1/m]
    r: float  # V/V_lp at x = 0, unless a relaxation gives it
    rested: float  # as of `relaxation`
    x_error: float  # standard error of where loading begins [m]

    def of_hold(self, p):
        """r, healing [1/m], and all but x of the arguments of `relaxation`."""
        if not self.rested:
            return self.r, 0.0, (0.0, 0.0, 0.0)
        k = np.exp(p[1])
        healing = min(HEALING / self.rested * np.exp(p[4]), MOST_HEALING * k)
        return np.clip(p[5] * self.slope / k, *CREEP), healing, (self.rested, *(self.slope * p[5:]))

    def friction(self, x, p):
        """(n,) at displacements x (n,)."""
        at, (r, healing, hold) = x - self.x_error * p[3], self.of_hold(p)
        k, a = np.exp(p[1:3])
        return curve(at, p[0], k, a, r, healing) + relaxation(at, *hold)

    def jacobian(self, x, p):
        """(n, PARAMETERS) its derivatives, central differences."""
        steps = STEP * np.eye(PARAMETERS)
        above, below = ([self.friction(x, p + sign * h) for h in steps] for sign in (1.0, -1.0))
        return (np.array(above) - np.array(below)).T / (2.0 * STEP)

    def start(self, level):
        """Coordinates to start from, where friction begins at a level: each (PARAMETERS,).

        With the inverse of each one's standard deviation before the record is seen, and how far it
        may move.
        """
        free = 0.0 if self.rested else 1.0  # (what has no effect is held)
        point = np.array([level, np.log(self.slope) + 0.1, np.log(A), 0.0, 0.0, 0.01, 0.0])
        priors = np.array([0.0, 0.0, 1.0 / LOG_ERROR, 1.0, 1.0 / LOG_ERROR, free, free])
        far = 8.0 * LOG_ERROR
        return point, priors, np.array([np.inf, FACTOR, far, 8.0, far, np.inf, np.inf])


def fit_loading_curve(t, x, friction, r, *, rested=0.0, x_error=0.0, state_error=0.0):
    """`LoadingCurve` of friction (n,) at times t and displacements x [m].

    None if k is not > 0, and where the search does not converge.

    r : V/V_lp at x = 0; that of the relaxation if `rested`, as of `relaxation`, is not 0
    x_error : standard error of where loading begins [m]
    state_error : standard error of ln k by what slip does to the state

    The noise is estimated from the residuals.
    """
    slope = float(np.polyfit(x[x >= 0.0], friction[x >= 0.0], 1)[0]) / (1.0 - r)
    spread = float(np.ptp(friction))
    if not (slope > 0.0 and spread > 0.0):
        return None
    model = _Model(slope, r, rested, x_error)
    first, priors, reach = model.start(friction[max(int(np.searchsorted(x, 0.0)) - 1, 0)])
    point, noise = first, Noise(spread)
    for _ in range(ROUNDS):
        residuals = _residuals(noise, t, x, friction, model, priors, first)
        found = minimum(residuals, point, first - reach, first + reach, EVALUATIONS)
        if found is None or not found.converged:
            return None
        point = found.x
        residual, columns = friction - model.friction(x, point), model.jacobian(x, point)
        noise = estimated_noise(t, residual, columns)
    white, _ = noise.whiten(t, columns)
    covariance = np.linalg.inv(white.T @ white + np.diag(priors**2))
    # (by what ln k moves where what is assumed does by its standard deviation)
    assumed = float(np.hypot(*covariance[1, [2, 4]])) / LOG_ERROR
    r, healing, hold = model.of_hold(point)
    return LoadingCurve(
        float(point[1]),
        float(np.sqrt(covariance[1, 1] - assumed**2)),
        float(np.hypot(assumed, state_error)),
        float(point[0]),
        float(r),
        float(np.exp(point[2])),
        float(healing),
        hold,
        float(x_error * point[3]),
        _misfit(noise, t, x, residual, columns),
    )


def _residuals(noise, t, x, friction, model, priors, first):
    """Residuals, whitened, and those of what is assumed, with derivatives: function of a point."""

    def of_point(p):
        residual = model.friction(x, p) - friction
        white, _ = noise.whiten(t, np.column_stack([residual, model.jacobian(x, p)]))
        assumed = np.column_stack([priors * (p - first), np.diag(priors)])
        both = np.concatenate([white, assumed])
        return both[:, 0], both[:, 1:]

    return of_point


def _misfit(noise, t, x, residual, columns):
    """Fall of chi-square by a quadratic and a cubic in x beside the model's own columns."""
    u = np.maximum(x, 0.0) / x[-1]
    columns = columns[:, columns.any(axis=0)]  # (without those of what has no effect)
    more = np.column_stack([columns, u**2, u**3])
    white, _ = noise.whiten(t, np.column_stack([residual, more]))
    sums = [
        white[:, 0] @ (q := np.linalg.qr(white[:, 1 : 1 + k])[0]) @ q.T @ white[:, 0]
        for k in (columns.shape[1], more.shape[1])
    ]
    return float(sums[1] - sums[0])
