"""The restricted likelihood of a noise's shape, with the estimates that go with it.

The variance of the noise is estimated in closed form.  Restricted maximum likelihood allows for
what the fitted parameters have taken out of the residuals: Patterson & Thompson (1971)
doi:10.1093/biomet/58.3.545.
"""

import math
from typing import NamedTuple

import numpy as np

from .noise import WHITE, Noise


class Conditional(NamedTuple):
    """What holds if the noise has one shape, for the k coordinates of a fit."""

    log_likelihood: float  # restricted; -inf where the record does not see some coordinate
    noise: Noise  # of this shape, with the likeliest variance
    shift: np.ndarray  # (k,) of the estimates, by generalized least squares to first order
    root: np.ndarray  # (k, k) with root @ root.T the covariance of the estimates


class RestrictedLikelihood:
    """Restricted likelihood of the noise in residuals (m,), at times t (m,) [s].

    jacobian : (m, k) derivatives of the fitted curve by the coordinates.  One that the record does
        not see, whose column is all 0, does not count: it has no shift and no covariance.
    """

    def __init__(self, t, residual, jacobian):
        self.size = jacobian.shape[1]
        self.seen = np.flatnonzero(jacobian.any(axis=0))
        self.scale = np.abs(jacobian[:, self.seen]).max(axis=0)
        columns = np.column_stack([residual, jacobian[:, self.seen] / self.scale])
        self.columns = np.ascontiguousarray(columns)  # as they are made white
        self.degrees = residual.size - self.seen.size
        self.dt = np.diff(t)
        #: usual time between samples, and length of the record [s]
        self.spacing, self.length = float(np.median(self.dt)), float(t[-1] - t[0])

    def log_likelihood(self, shape):
        """The restricted ln(likelihood) of a `Noise` of this shape and any variance."""
        found = self._reduced(shape)
        return -math.inf if found is None else found[0]

    def at(self, shape=WHITE):
        """`Conditional` on a `Noise` of this shape and any variance."""
        found = self._reduced(shape)
        if found is None:
            nothing = np.zeros((self.size, self.size))
            return Conditional(-math.inf, WHITE, nothing[0], nothing)
        log_likelihood, variance, inverse, projected = found
        shift, root = np.zeros(self.size), np.zeros((self.size, self.size))
        shift[self.seen] = (inverse.T @ projected) / self.scale
        root[np.ix_(self.seen, self.seen)] = math.sqrt(variance) * inverse.T / self.scale[:, None]
        return Conditional(log_likelihood, shape.times(math.sqrt(variance)), shift, root)

    def _reduced(self, shape):
        """ln(likelihood), variance, and what gives the estimates; None if a shape is impossible."""
        white, log_determinant = shape.whiten_steps(self.dt, self.spacing, self.columns)
        normal = white.T @ white
        try:
            factor = np.linalg.cholesky(normal[1:, 1:])
        except np.linalg.LinAlgError:  # the record does not see some combination at all
            return None
        inverse = np.linalg.inv(factor)
        projected = inverse @ normal[1:, 0]
        variance = max(normal[0, 0] - projected @ projected, 0.0) / self.degrees
        if not variance > 0.0:
            return None
        log_normal = 2.0 * np.log(factor.diagonal()).sum()
        minus = 0.5 * (self.degrees * math.log(variance) + log_determinant + log_normal)
        return -minus, variance, inverse, projected
