"""Friction while the load point loads or unloads the spring: the curve, its fit, its stiffness.

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

The coordinates p of a curve are mu_0, ln k, ln a, x_0 (where loading begins beside where it is said
to, over the standard error of that), ln of healing over what is assumed, and after a hold those of
its relaxation, creep and bend.
"""

from typing import NamedTuple

import numpy as np

from ..kit.estimated_noise import estimated_noise
from ..kit.least_squares import minimum
from ..kit.noise import Noise
from ..kit.regression import central_differences, fall_of_chi2

#: chi-square of two more coefficients, a quadratic and a cubic one, that 1 of 1000 fits exceed
SIGNIFICANT = 13.82
#: what is assumed of a and of healing per e-fold of time; standard deviation of their logarithms
A, HEALING, LOG_ERROR = 0.008, 0.0035, 0.6
#: largest part of k that healing is
MOST_HEALING = 0.5
#: how far ln k may be from that of a straight line; rounds of noise and fit; most evaluations
FACTOR, ROUNDS, EVALUATIONS = 2.0, 3, 100
#: smallest and largest r after a hold
CREEP = 1e-12, 0.9
#: number of coordinates p; step of a difference
PARAMETERS, STEP = 7, 1e-5


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


class Model(NamedTuple):
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
        """(n, PARAMETERS) its derivatives."""
        return central_differences(lambda q: self.friction(x, q), p, np.full(PARAMETERS, STEP))

    def start(self, level):
        """Coordinates to start from, if friction begins at a level: each (PARAMETERS,).

        With the inverse of each one's standard deviation before the record is seen, and how far it
        may move.
        """
        free = 0.0 if self.rested else 1.0  # (what has no effect is held)
        point = np.array([level, np.log(self.slope) + 0.1, np.log(A), 0.0, 0.0, 0.01, 0.0])
        priors = np.array([0.0, 0.0, 1.0 / LOG_ERROR, 1.0, 1.0 / LOG_ERROR, free, free])
        far = 8.0 * LOG_ERROR
        return point, priors, np.array([np.inf, FACTOR, far, 8.0, far, np.inf, np.inf])


class LoadingCurve(NamedTuple):
    """A fitted curve."""

    model: Model
    point: np.ndarray  # (PARAMETERS,) coordinates
    own_error: float  # of ln k, by all that differs from slope to slope
    shared_error: float  # by what all slopes share: a, healing, and slip's effect on the state
    misfit: float  # fall of chi-square by a quadratic and a cubic beside the curve

    @property
    def k(self):
        """K over normal stress [1/m]."""
        return float(np.exp(self.point[1]))

    @property
    def k_error(self):
        """Its standard error."""
        return self.k * float(np.hypot(self.own_error, self.shared_error))

    @property
    def r(self):
        """V/V_lp where loading begins."""
        return float(self.model.of_hold(self.point)[0])

    def at(self, x):
        """Friction at displacements x [m]."""
        return self.model.friction(x, self.point)

    @property
    def fits(self):
        """Whether the curve explains the samples."""
        return self.misfit < SIGNIFICANT


def fit_loading_curve(t, x, friction, r, *, rested=0.0, x_error=0.0, state_error=0.0):
    """`LoadingCurve` of friction (n,) at times t and displacements x [m].

    None if k is not > 0, and if the search does not converge.

    r : V/V_lp at x = 0; that of the relaxation if `rested`, as of `relaxation`, is not 0
    x_error : standard error of where loading begins [m]
    state_error : standard error of ln k by what slip does to the state

    The noise is estimated from the residuals.
    """
    slope = float(np.polyfit(x[x >= 0.0], friction[x >= 0.0], 1)[0]) / (1.0 - r)
    spread = float(np.ptp(friction))
    if not (slope > 0.0 and spread > 0.0):
        return None
    model = Model(slope, r, rested, x_error)
    first, priors, reach = model.start(friction[max(int(np.searchsorted(x, 0.0)) - 1, 0)])

    def residuals(p):
        """Residuals, whitened, and those of what is assumed, with derivatives."""
        white, _ = noise.whiten(
            t, np.column_stack([model.friction(x, p) - friction, model.jacobian(x, p)])
        )
        assumed = np.column_stack([priors * (p - first), np.diag(priors)])
        both = np.concatenate([white, assumed])
        return both[:, 0], both[:, 1:]

    point, noise = first, Noise(spread)
    for _ in range(ROUNDS):
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
    return LoadingCurve(
        model,
        point,
        float(np.sqrt(covariance[1, 1] - assumed**2)),
        float(np.hypot(assumed, state_error)),
        _misfit(noise, t, x, residual, columns),
    )


def _misfit(noise, t, x, residual, columns):
    """Fall of chi-square by a quadratic and a cubic in x beside the model's own columns."""
    u = np.maximum(x, 0.0) / x[-1]
    columns = columns[:, columns.any(axis=0)]  # (without those of what has no effect)
    return fall_of_chi2(t, residual, np.column_stack([columns, u**2, u**3]), 2, noise)
