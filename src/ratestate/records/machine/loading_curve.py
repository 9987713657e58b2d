"""Friction while the load point loads or unloads the spring, and its stiffness in it.

Quasi-static friction whose state stays as it is, mu = mu_1 + a ln(V/V_1), under dtau/dt =
K (V_lp - V) follows the load point's displacement x as

    mu(x) = mu_0 - a ln(r + (1 - r) exp(-k x/a)),   k = K/sigma,

with r = V/V_lp at x = 0, where mu = mu_0, the level before.  The slope there is k (1 - r): less
than k, for the fault creeps.  r is that of steady sliding at the speed before a step; at the end of
a hold V follows from the relaxation, dmu/dt = -k V; and with r = 0 this is a straight line.  Of a,
whose effect is hardly seen, it is assumed that it is typical of rocks and gouges, to a factor of
about two (Marone 1998 doi:10.1146/annurev.earth.26.1.643).
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..fitting.estimated_noise import estimated_noise
from ..fitting.noise import Noise

#: what is assumed of a, and the standard deviation of its logarithm
A, A_ERROR = 0.008, 0.6
#: how far ln k may be from that of a straight line; rounds of noise and fit
FACTOR, ROUNDS = 2.0, 3
#: chi-square of two more coefficients, a quadratic and a cubic one, that 1 of 1000 fits exceed
SIGNIFICANT = 13.82
#: step of a difference in a coordinate
STEP = 1e-5


class LoadingCurve(NamedTuple):
    """A fitted curve."""

    ln_k: float  # k [1/m]
    own_error: float  # by all that differs from slope to slope
    shared_error: float  # by what all slopes share: a, and a state that changes after all
    mu_0: float
    r: float
    a: float
    x_0: float  # where loading begins [m], beside where it is said to
    misfit: float  # fall of chi-square by a quadratic and a cubic beside the curve

    @property
    def k(self):
        """K over normal stress [1/m]."""
        return float(np.exp(self.ln_k))

    @property
    def k_error(self):
        """Its standard error."""
        return self.k * float(np.hypot(self.own_error, self.shared_error))

    def at(self, x):
        """Friction at displacements x [m]."""
        return curve(x - self.x_0, self.mu_0, self.k, self.a, self.r)

    @property
    def fits(self):
        """Whether the curve explains the samples."""
        return self.misfit < SIGNIFICANT


def curve(x, mu_0, k, a, r):
    """The equation above; mu_0 where x < 0."""
    spring = k * np.maximum(x, 0.0)
    return mu_0 + spring if r == 0.0 else mu_0 - a * np.log(r + (1.0 - r) * np.exp(-spring / a))


def fit_loading_curve(t, x, friction, r, *, creep=0.0, x_error=0.0, state_error=0.0):
    """`LoadingCurve` of friction (n,) at times t and displacements x [m]; None if k is not > 0.

    r : V/V_lp at x = 0; or creep : -dmu/dx there, of the relaxation, which is k r
    x_error : standard error of where loading begins [m]
    state_error : standard error of ln k by a state that does not stay as it is

    The noise is estimated from the residuals.
    """
    slope = float(np.polyfit(x[x >= 0.0], friction[x >= 0.0], 1)[0])
    slope = slope + creep if creep else slope / (1.0 - r)
    if not slope > 0.0:
        return None

    def ratio(p):
        return min(creep * np.exp(-p[1]), 0.9) if creep else r

    def model(p):
        return curve(x - x_error * p[3], p[0], np.exp(p[1]), np.exp(p[2]), ratio(p))

    def jacobian(p):
        steps = STEP * np.eye(4)
        return np.column_stack([(model(p + h) - model(p - h)) / (2.0 * STEP) for h in steps])

    point = np.array([friction[0], np.log(slope) + 0.1, np.log(A), 0.0])
    noise = Noise(float(np.ptp(friction)))
    reach = np.array([np.inf, FACTOR, 8.0 * A_ERROR, 8.0])
    bounds = point - reach, point + reach
    for _ in range(ROUNDS):
        point = least_squares(_whitened(noise, t, friction, model), point, bounds=bounds).x
        columns = jacobian(point)
        noise = estimated_noise(t, friction - model(point), columns)
    white, _ = noise.whiten(t, np.column_stack([friction - model(point), columns]))
    prior = np.diag([0.0, 0.0, A_ERROR**-2.0, 1.0])
    covariance = np.linalg.inv(white[:, 1:].T @ white[:, 1:] + prior)
    # (by what ln k moves where ln A does by its standard deviation)
    a_error = abs(covariance[1, 2]) / A_ERROR
    return LoadingCurve(
        float(point[1]),
        float(np.sqrt(covariance[1, 1] - a_error**2)),
        float(np.hypot(a_error, state_error)),
        float(point[0]),
        float(ratio(point)),
        float(np.exp(point[2])),
        float(x_error * point[3]),
        _misfit(noise, t, x, friction - model(point), columns),
    )


def _whitened(noise, t, friction, model):
    """The residuals, whitened, and those of a and of the start, as a function of a point."""
    return lambda p: np.concatenate(
        [noise.whiten(t, model(p) - friction)[0][:, 0], [(p[2] - np.log(A)) / A_ERROR, p[3]]]
    )


def _misfit(noise, t, x, residual, columns):
    """Fall of chi-square by a quadratic and a cubic in x beside the model's own columns."""
    u = np.maximum(x, 0.0) / x[-1]
    more = np.column_stack([columns, u**2, u**3])
    white, _ = noise.whiten(t, np.column_stack([residual, more]))
    sums = [
        white[:, 0] @ (q := np.linalg.qr(white[:, 1 : 1 + k])[0]) @ q.T @ white[:, 0]
        for k in (columns.shape[1], more.shape[1])
    ]
    return float(sums[1] - sums[0])
