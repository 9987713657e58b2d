"""The noise of a record: its level and correlation, as given or estimated from residuals.

The noise is white noise plus a correlated part (engine/noise.py).  White noise comes from a load
cell's digits and electronics, correlated noise from filters, gouge, temperature and machine.  The
correlated part is one relaxation (an Ornstein-Uhlenbeck process).  For noise whose spectrum is a
power of frequency, such as 1/f, it is a sum of relaxations, about one per decade.

Noise is estimated by restricted maximum likelihood, which corrects for the part of the noise that
the fitted parameters absorb: Patterson & Thompson (1971) doi:10.1093/biomet/58.3.545.  The variance
has a closed form.  The shape belongs to one of two families, with two coordinates: the correlated
part's share in the variance, and its time or exponent.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import scipy

from ...engine.noise import whiten
from ...model.units import one_in_si
from ..messages import kit as sentences

#: least rise of ln(likelihood) for correlated noise, which has two more parameters
RISE = 3.0
#: bounds of ln(share/(1 - share)); shortest relaxation time divided by the sample spacing
LOG_ODDS, SHORTEST = (-8.0, 14.0), 0.2
#: bounds of the exponent of frequency, and the change of exponent that is one unit in the search
EXPONENTS, UNIT = (0.3, 2.3), 0.3
#: size of the first simplex, if the start is far from the mode or close to it
FAR, CLOSE = 1.0, 0.2


class Noise(NamedTuple):
    """Standard deviations of the white and the correlated part, and the correlation time [s].

    With an exponent, the spectrum of the correlated part is proportional to frequency to the power
    of -exponent above 1/time.  It is a sum of relaxations, about one per decade, with times from
    `time` down to the time between samples.
    """

    white: float
    red: float = 0.0
    time: float = 1.0
    exponent: float | None = None

    def relaxations(self, spacing):
        """Return variances (m,) and times (m,) [s] of relaxations for a sample spacing [s]."""
        if self.exponent is None:
            return np.array([self.red**2]), np.array([self.time])
        count = 1 + max(round(math.log10(self.time / spacing)), 1)
        times = np.geomspace(self.time, spacing, count)
        weights = (times / self.time) ** (self.exponent - 1.0)
        return self.red**2 * weights / weights.sum(), times

    def whiten(self, t, columns):
        """Transform columns (n, k) at times t (n,) to unit white noise; return ln det(cov) too."""
        columns = np.ascontiguousarray(np.reshape(columns, (t.size, -1)))
        dt = np.diff(t)
        return self.whiten_steps(dt, float(np.median(dt)) if self.red else 0.0, columns)

    def whiten_steps(self, dt, spacing, columns):
        """Do the same as `whiten` for steps dt (n - 1,) between samples [s].

        spacing : median of dt
        columns : (n, k), contiguous
        """
        if self.red == 0.0:
            return columns / self.white, 2.0 * len(columns) * math.log(self.white)
        variances, times = self.relaxations(spacing)
        return whiten(dt, self.white**2, variances, times, columns)

    @property
    def level(self):
        """Return the standard deviation of one sample."""
        return math.hypot(self.white, self.red)

    def times(self, factor):
        """Return noise of the same shape multiplied by a factor."""
        return self._replace(white=factor * self.white, red=factor * self.red)


#: white noise of unit variance
WHITE = Noise(1.0)


def given_noise(noise):
    """Return the `Noise` that the user gives, or None if it must be estimated.

    noise : None, a standard deviation of friction, or a dict of "white", "red" and "time".
        Anything else, "red" without "time", or no positive part raises ParameterError.
    """
    if noise is None:
        return None
    if not isinstance(noise, dict):
        return Noise(one_in_si("noise", noise))
    if not set(noise) <= {"white", "red", "time"} or not noise:
        raise sentences.refusal("noise.form", noise=noise)
    if "red" in noise and "time" not in noise:
        raise sentences.refusal("noise.no_time")
    white, red = (
        one_in_si("noise", noise.get(k, 0.0), label=f"noise {k}", bound=">= 0")
        for k in ("white", "red")
    )
    if not white + red > 0.0:
        raise sentences.refusal("noise.zero")
    time = one_in_si("t", noise.get("time", 1.0), label="noise time", bound="> 0")
    return Noise(white, red, time)


class Conditional(NamedTuple):
    """Results for noise of a given shape, in a fit with k coordinates."""

    log_likelihood: float  # restricted; -inf if the record does not determine the coordinates
    noise: Noise  # noise of this shape with the likeliest variance
    shift: np.ndarray  # (k,) first-order change of the estimates by generalized least squares
    root: np.ndarray  # (k, k) with root @ root.T the covariance of the estimates


class RestrictedLikelihood:
    """Restricted likelihood of the noise in residuals (m,), at times t (m,) [s].

    jacobian : (m, k) derivatives of the fitted curve by the coordinates.  A coordinate whose column
        is 0, because the record does not depend on it, has zero shift and covariance.
    """

    def __init__(self, t, residual, jacobian):
        self.size = jacobian.shape[1]
        self.seen = np.flatnonzero(jacobian.any(axis=0))
        self.scale = np.abs(jacobian[:, self.seen]).max(axis=0)
        columns = np.column_stack([residual, jacobian[:, self.seen] / self.scale])
        self.columns = np.ascontiguousarray(columns)  # as whitening requires
        self.degrees = residual.size - self.seen.size
        self.dt = np.diff(t)
        #: median time between samples, and length of the record [s]
        self.spacing, self.length = float(np.median(self.dt)), float(t[-1] - t[0])

    def at(self, shape=WHITE):
        """Return the `Conditional` for a `Noise` of this shape and any variance."""
        shift, root = np.zeros(self.size), np.zeros((self.size, self.size))
        impossible = Conditional(-math.inf, WHITE, shift, root)
        white, log_determinant = shape.whiten_steps(self.dt, self.spacing, self.columns)
        normal = white.T @ white
        try:
            factor = np.linalg.cholesky(normal[1:, 1:])
        except np.linalg.LinAlgError:  # the record does not depend on some combination
            return impossible
        inverse = np.linalg.inv(factor)
        projected = inverse @ normal[1:, 0]
        variance = max(normal[0, 0] - projected @ projected, 0.0) / self.degrees
        if not variance > 0.0:
            return impossible
        log_normal = 2.0 * np.log(factor.diagonal()).sum()
        minus = 0.5 * (self.degrees * math.log(variance) + log_determinant + log_normal)
        shift[self.seen] = (inverse.T @ projected) / self.scale
        root[np.ix_(self.seen, self.seen)] = math.sqrt(variance) * inverse.T / self.scale[:, None]
        return Conditional(-minus, shape.times(math.sqrt(variance)), shift, root)


class NoiseFamily(NamedTuple):
    """White noise and one relaxation, or white noise and a spectrum that is a power of frequency.

    The first coordinate of a shape is ln(share/(1 - share)).  The second is ln(time), or the
    exponent divided by `UNIT`.
    """

    likelihood: RestrictedLikelihood
    is_power: bool
    bounds: np.ndarray  # (2, 2) of the coordinates
    starts: list[np.ndarray]

    def shape(self, point):
        """Return the `Noise` of unit variance at a point (2,)."""
        white, red = (math.sqrt(1.0 / (1.0 + math.exp(x))) for x in (point[0], -point[0]))
        if self.is_power:
            return Noise(white, red, self.likelihood.length, UNIT * point[1])
        return Noise(white, red, math.exp(point[1]))

    def at(self, point):
        """Return the `Conditional` for the shape at a point (2,)."""
        return self.likelihood.at(self.shape(point))

    def point(self, noise):
        """Return the coordinates (2,) of a noise, perhaps infinite; None if of another family."""
        if noise.red > 0.0 and self.is_power == (noise.exponent is not None):
            second = noise.exponent / UNIT if self.is_power else math.log(noise.time)
            with np.errstate(divide="ignore"):
                return np.array([2.0 * np.log(np.float64(noise.red) / noise.white), second])


def families(likelihood):
    spacing, length = likelihood.spacing, likelihood.length
    times, exponents = np.log([SHORTEST * spacing, length]), np.array(EXPONENTS) / UNIT
    starts = [np.array([0.0, math.log(time)]) for time in (2.0 * spacing, 0.02 * length)]
    power = np.array([1.0, 1.0 / UNIT])
    return (
        NoiseFamily(likelihood, False, np.array([LOG_ODDS, times]), starts),
        NoiseFamily(likelihood, True, np.array([LOG_ODDS, exponents]), [power]),
    )


def estimated_noise(t, residual, jacobian, near=None):
    """Estimate the `Noise` of residuals (n,) of a fit with jacobian (n, k).

    The noise is white unless a correlated part raises ln(likelihood) by more than `RISE`.

    near : `Noise` of similar residuals, from which the search starts, or None
    """
    likelihood = RestrictedLikelihood(t, residual, jacobian)
    white = likelihood.at()
    pairs = [(one, family) for family in families(likelihood) for one in modes(family, near)]
    (highest, point), family = max(pairs, key=lambda pair: pair[0][0])
    if highest <= white.log_likelihood + RISE:
        return white.noise
    return family.at(point).noise


def modes(family, near=None):
    """Return the maxima (list) of ln(likelihood) and their points, one from each start of a family.

    near : as for `estimated_noise`
    """
    starts, size = family.starts, FAR
    if near is not None and (point := family.point(near)) is not None:
        starts, size = [point], CLOSE
    low, high = family.bounds.T
    maxima = []
    for start in starts:
        first = np.clip(start, low, high - size)
        # (SciPy's default simplex around a coordinate of 0 is so thin that it may never move)
        simplex = first + size * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        options: Any = {"initial_simplex": simplex, "xatol": 0.05, "fatol": 0.02, "maxfev": 150}
        result = scipy.optimize.minimize(
            lambda point: -family.at(point).log_likelihood,
            first,
            method="Nelder-Mead",
            bounds=family.bounds,
            options=options,
        )
        maxima.append((-result.fun, result.x))
    return maxima
