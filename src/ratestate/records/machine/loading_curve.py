"""Friction while the load point loads or unloads the spring, and its stiffness in it.

Quasi-static friction whose state stays as it is, mu = mu_1 + a ln(V/V_1), under dtau/dt =
K (V_lp - V) follows the load point's displacement x as

    mu(x) = mu_0 - a ln(r + (1 - r) exp(-k x/a)),   k = K/sigma,

with r = V/V_lp at x = 0, where mu = mu_0, the level before.  The slope there is k (1 - r): less
than k, for the fault creeps.  r is that of steady sliding at the speed before a step; at the end of
a hold V follows from the relaxation, dmu/dt = -k V; and with r = 0 this is a straight line.  The
relaxation is a quadratic in the logarithm of time: by a straight line V at the end would be a mean
over the times that are fitted, which is a few per cent too large.

A fault that has rested heals on while the spring loads: friction rises by h for each length of x,
so that the fault creeps less.  Then mu - h x follows the same curve, with k - h for k, and r k/(k -
h) for r.  As friction heals with the logarithm of time, h is its rate per e-fold over how far the
load point would have moved during the hold.

Of a and the rate of healing, whose effects are hardly seen, it is assumed that they are typical of
rocks and gouges, to a factor of about two: a is 0.008, and friction heals by 0.008 per decade
(Marone 1998 doi:10.1146/annurev.earth.26.1.643).
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..fitting.estimated_noise import estimated_noise
from ..fitting.noise import Noise

#: what is assumed of a and of healing per e-fold of time; standard deviation of their logarithms
A, HEALING, LOG_ERROR = 0.008, 0.0035, 0.6
#: largest part of k that healing is
MOST_HEALING = 0.5
#: how far ln k may be from that of a straight line; rounds of noise and fit
FACTOR, ROUNDS = 2.0, 3
#: chi-square of two more coefficients, a quadratic and a cubic one, that 1 of 1000 fits exceed
SIGNIFICANT = 13.82
#: smallest and largest r after a hold
CREEP = 1e-12, 0.9
#: number of coordinates: mu_0, ln k, ln a, x_0, ln of healing, creep, bend; step of a difference
PARAMETERS, STEP = 7, 1e-5


class LoadingCurve(NamedTuple):
    """A fitted curve."""

    ln_k: float  # k [1/m]
    own_error: float  # by all that differs from slope to slope
    shared_error: float  # by what all slopes share: a, healing, and slip's effect on the state
    mu_0: float
    r: float
    a: float
    healing: float  # h [1/m]
    relaxation: tuple  # other arguments of `relaxation`
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
        x = x - self.x_0
        loading = curve(x, self.mu_0, self.k, self.a, self.r, self.healing)
        return loading + relaxation(x, *self.relaxation)

    @property
    def fits(self):
        """Whether the curve explains the samples."""
        return self.misfit < SIGNIFICANT


def curve(x, mu_0, k, a, r, healing=0.0):
    """The equation above; mu_0 where x < 0."""
    x = np.maximum(x, 0.0)
    if r == 0.0:
        return mu_0 + k * x
    rest = k - healing
    r = r * k / rest
    return mu_0 + healing * x - a * np.log(r + (1.0 - r) * np.exp(-rest * x / a))


def relaxation(x, rested, creep, bend):
    """Friction over mu_0 in a hold, where x < 0; 0 elsewhere, and if there was no hold.

    rested : how far the load point would have moved during the hold [m]; 0 without one
    creep, bend : coefficients [1/m] of ln(1 + x/rested), at x = 0 -dmu/dx, and of its square
    """
    if not rested:
        return np.zeros(len(x))
    u = np.log1p(np.minimum(x, 0.0) / rested)
    return -rested * u * (creep + bend * u)


def fit_loading_curve(t, x, friction, r, *, rested=0.0, x_error=0.0, state_error=0.0):
    """`LoadingCurve` of friction (n,) at times t and displacements x [m]; None if k is not > 0.

    r : V/V_lp at x = 0; that of the relaxation if `rested`, as of `relaxation`, is not 0
    x_error : standard error of where loading begins [m]
    state_error : standard error of ln k by what slip does to the state

    The noise is estimated from the residuals.
    """
    slope = float(np.polyfit(x[x >= 0.0], friction[x >= 0.0], 1)[0]) / (1.0 - r)
    if not slope > 0.0:
        return None

    def of_hold(p):
        k = np.exp(p[1])
        if not rested:
            return r, 0.0, (0.0, 0.0, 0.0)
        healing = min(HEALING / rested * np.exp(p[4]), MOST_HEALING * k)
        return np.clip(p[5] * slope / k, *CREEP), healing, (rested, *(slope * p[5:]))

    def model(p):
        at, (ratio, healing, hold) = x - x_error * p[3], of_hold(p)
        k, a = np.exp(p[1:3])
        return curve(at, p[0], k, a, ratio, healing) + relaxation(at, *hold)

    def jacobian(p):
        steps = STEP * np.eye(PARAMETERS)
        return np.column_stack([(model(p + h) - model(p - h)) / (2.0 * STEP) for h in steps])

    level = friction[max(int(np.searchsorted(x, 0.0)) - 1, 0)]
    point = np.array([level, np.log(slope) + 0.1, np.log(A), 0.0, 0.0, 0.01, 0.0])
    free = 0.0 if rested else 1.0  # (what has no effect is held)
    priors = np.array([0.0, 0.0, 1.0 / LOG_ERROR, 1.0, 1.0 / LOG_ERROR, free, free])
    reach = np.array([np.inf, FACTOR, 8.0 * LOG_ERROR, 8.0, 8.0 * LOG_ERROR, np.inf, np.inf])
    noise = Noise(float(np.ptp(friction)))
    bounds, first = (point - reach, point + reach), point
    for _ in range(ROUNDS):
        residuals = _residuals(noise, t, friction, model, priors, first)
        point = least_squares(residuals, point, bounds=bounds, x_scale="jac").x
        columns = jacobian(point)
        noise = estimated_noise(t, friction - model(point), columns)
    white, _ = noise.whiten(t, np.column_stack([friction - model(point), columns]))
    covariance = np.linalg.inv(white[:, 1:].T @ white[:, 1:] + np.diag(priors**2))
    # (by what ln k moves where what is assumed does by its standard deviation)
    assumed = float(np.hypot(*covariance[1, [2, 4]])) / LOG_ERROR
    ratio, healing, hold = of_hold(point)
    return LoadingCurve(
        float(point[1]),
        float(np.sqrt(covariance[1, 1] - assumed**2)),
        float(np.hypot(assumed, state_error)),
        float(point[0]),
        float(ratio),
        float(np.exp(point[2])),
        float(healing),
        hold,
        float(x_error * point[3]),
        _misfit(noise, t, x, friction - model(point), columns),
    )


def _residuals(noise, t, friction, model, priors, first):
    """The residuals, whitened, and those of what is assumed, as a function of a point."""
    return lambda p: np.concatenate(
        [noise.whiten(t, model(p) - friction)[0][:, 0], priors * (p - first)]
    )


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
