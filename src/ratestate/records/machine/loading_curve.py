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
"""

from typing import NamedTuple

import numpy as np

#: chi-square of two more coefficients, a quadratic and a cubic one, that 1 of 1000 fits exceed
SIGNIFICANT = 13.82


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
