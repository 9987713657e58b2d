"""The noise that residuals show, by restricted maximum likelihood."""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from .noise import Noise
from .restricted_likelihood import RestrictedLikelihood

#: least rise of ln(likelihood) for correlated noise, which has two more parameters
RISE = 3.0
#: bounds of ln(share/(1 - share)) of the correlated part; least time over that between samples
LOG_ODDS, SHORTEST = (-8.0, 14.0), 0.2
#: size of the first simplex, from a start far from the mode or close to it
FAR, CLOSE = 1.0, 0.2


def estimated_noise(t, residual, jacobian, near=None):
    """`Noise` by restricted maximum likelihood: of residuals (n,) with a fit's jacobian (n, k).

    near : `Noise` of almost the same residuals, from which the search then starts; None for none

    White, unless a red part raises ln(likelihood) by more than `RISE`.  A column that is all 0, of
    what the record does not see, does not count.
    """
    likelihood = RestrictedLikelihood(t, residual, jacobian)
    white = likelihood.at(0.0, 1.0)
    mode = max(modes(likelihood, near), key=lambda one: one.log_likelihood)
    if mode.log_likelihood <= white.log_likelihood + RISE:
        return Noise(math.sqrt(white.variance))
    share, time = shape_of(mode.point)
    variance = likelihood.at(share, time).variance
    return Noise(math.sqrt((1.0 - share) * variance), math.sqrt(share * variance), time)


class Mode(NamedTuple):
    """A maximum of the restricted likelihood."""

    point: np.ndarray  # (2,) coordinates of the noise's shape, as of `shape_of`
    log_likelihood: float


def bounds_of(likelihood):
    """Bounds of both coordinates: of ln(share/(1 - share)), and of ln(time)."""
    times = SHORTEST * likelihood.spacing, likelihood.length
    return LOG_ODDS, (math.log(times[0]), math.log(times[1]))


def shape_of(point):
    """Share of the correlated part in the variance, and its time [s], from their coordinates."""
    return 1.0 / (1.0 + math.exp(-point[0])), math.exp(point[1])


def point_of(noise):
    """(2,) coordinates of a noise with a correlated part; ln(share/(1 - share)) may be infinite."""
    with np.errstate(divide="ignore"):
        return np.array([2.0 * np.log(np.float64(noise.red) / noise.white), math.log(noise.time)])


def modes(likelihood, near=None):
    """`Mode`s (list) of a `RestrictedLikelihood`, from a short and a long time as a start.

    near : as of `estimated_noise`
    """
    bounds = bounds_of(likelihood)
    times = np.log([2.0 * likelihood.spacing, 0.02 * likelihood.length])
    starts, size = [np.array([0.0, time]) for time in times], FAR
    if near is not None and near.red > 0.0:
        starts, size = [point_of(near)], CLOSE
    low, high = np.array(bounds).T
    found = []
    for start in starts:
        first = np.clip(start, low, high - size)
        # (SciPy's own simplex about a coordinate of 0 is so thin that it may never move)
        simplex = first + size * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        result = minimize(
            lambda point: -likelihood.at(*shape_of(point)).log_likelihood,
            first,
            method="Nelder-Mead",
            bounds=bounds,
            options={"initial_simplex": simplex, "xatol": 0.05, "fatol": 0.02, "maxfev": 150},
        )
        found.append(Mode(result.x, -result.fun))
    return found
