"""The noise that residuals show, by restricted maximum likelihood.

Restricted maximum likelihood allows for what the fitted parameters have taken out of the residuals:
Patterson & Thompson (1971) doi:10.1093/biomet/58.3.545.  The variance of the noise is estimated in
closed form.

Noise has a shape of one of two families: white noise and one relaxation, or white noise and noise
whose spectrum is a power of frequency.  A shape has two coordinates: ln(share/(1 - share)), of the
correlated part's share in the variance, and that of the family.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize

from .noise import WHITE, Noise

#: least rise of ln(likelihood) for correlated noise, which has two more parameters
RISE = 3.0
#: bounds of ln(share/(1 - share)); shortest time of a relaxation over that between samples
LOG_ODDS, SHORTEST = (-8.0, 14.0), 0.2
#: bounds of the exponent of frequency, and its change that counts as 1
EXPONENTS, UNIT = (0.3, 2.3), 0.3
#: size of the first simplex, from a start far from the mode or close to it
FAR, CLOSE = 1.0, 0.2


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


class Relaxation:
    """White noise and one relaxation; its coordinate is ln(time)."""

    def __init__(self, likelihood):
        shortest = SHORTEST * likelihood.spacing
        self.bounds = np.array([LOG_ODDS, np.log([shortest, likelihood.length])])
        times = 2.0 * likelihood.spacing, 0.02 * likelihood.length
        self.starts = [np.array([0.0, math.log(time)]) for time in times]

    def shape(self, point):
        """`Noise` of unit variance at a point (2,)."""
        return Noise(*_parts(point[0]), time=math.exp(point[1]))

    def point(self, noise):
        """(2,) coordinates of a noise; None if it is of another family."""
        if noise.red > 0.0 and noise.exponent is None:
            return np.array([_log_odds(noise), math.log(noise.time)])


class PowerLaw:
    """White noise and a spectrum that is a power of frequency; its coordinate is the exponent."""

    def __init__(self, likelihood):
        self.bounds = np.array([LOG_ODDS, np.array(EXPONENTS) / UNIT])
        self.starts = [np.array([1.0, 1.0 / UNIT])]
        self.time = likelihood.length

    def shape(self, point):
        """`Noise` of unit variance at a point (2,)."""
        return Noise(*_parts(point[0]), time=self.time, exponent=UNIT * point[1])

    def point(self, noise):
        """(2,) coordinates of a noise; None if it is of another family."""
        if noise.red > 0.0 and noise.exponent is not None:
            return np.array([_log_odds(noise), noise.exponent / UNIT])


def families(likelihood):
    """Both families of noise for a `RestrictedLikelihood`."""
    return Relaxation(likelihood), PowerLaw(likelihood)


def _parts(log_odds: float) -> tuple[float, float]:
    """Standard deviations of the white and the correlated part of unit variance."""
    return math.sqrt(1.0 / (1.0 + math.exp(log_odds))), math.sqrt(1.0 / (1.0 + math.exp(-log_odds)))


def _log_odds(noise):
    """ln(share/(1 - share)) of the correlated part of a noise; it may be infinite."""
    with np.errstate(divide="ignore"):
        return 2.0 * np.log(np.float64(noise.red) / noise.white)


def estimated_noise(t, residual, jacobian, near=None):
    """`Noise` by restricted maximum likelihood: of residuals (n,) with a fit's jacobian (n, k).

    near : `Noise` of almost the same residuals, from which the search then starts; None for none

    White, unless a correlated part raises ln(likelihood) by more than `RISE`.  A column that is all
    0, of what the record does not see, does not count.
    """
    likelihood = RestrictedLikelihood(t, residual, jacobian)
    white = likelihood.at()
    found = [mode for family in families(likelihood) for mode in modes(likelihood, family, near)]
    mode = max(found, key=lambda one: one.log_likelihood)
    if mode.log_likelihood <= white.log_likelihood + RISE:
        return white.noise
    return likelihood.at(mode.shape).noise


class Mode(NamedTuple):
    """A maximum of the restricted likelihood."""

    point: np.ndarray  # (2,) coordinates of the noise's shape
    shape: Noise
    log_likelihood: float


def modes(likelihood, family, near=None):
    """`Mode`s (list) of a `RestrictedLikelihood` in a family, from each of the family's starts.

    near : as of `estimated_noise`
    """
    starts, size = family.starts, FAR
    if near is not None and (point := family.point(near)) is not None:
        starts, size = [point], CLOSE
    low, high = family.bounds.T
    found = []
    for start in starts:
        first = np.clip(start, low, high - size)
        # (SciPy's own simplex about a coordinate of 0 is so thin that it may never move)
        simplex = first + size * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        options: Any = {"initial_simplex": simplex, "xatol": 0.05, "fatol": 0.02, "maxfev": 150}
        result = minimize(
            lambda point: -likelihood.log_likelihood(family.shape(point)),
            first,
            method="Nelder-Mead",
            bounds=family.bounds,
            options=options,
        )
        found.append(Mode(result.x, family.shape(result.x), -result.fun))
    return found
