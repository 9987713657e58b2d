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

from ...engine.noise import Whitening
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
        times = self.time * (spacing / self.time) ** np.linspace(0.0, 1.0, count)
        weights = (times / self.time) ** (self.exponent - 1.0)
        return self.red**2 * weights / weights.sum(), times

    def whiten(self, t, columns):
        """Transform columns (n, k) at times t (n,) to unit white noise; return ln det(cov) too."""
        columns, dt = np.ascontiguousarray(np.reshape(columns, (t.size, -1))), np.diff(t)
        if self.red == 0.0:
            return columns / self.white, 2.0 * len(columns) * math.log(self.white)
        parts = self.white**2, *self.relaxations(float(np.median(dt)))
        white, log_determinant = Whitening(dt, columns)(*parts)
        return white[:, : columns.shape[1]], log_determinant

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
    """Results for noise of a given shape."""

    log_likelihood: float  # restricted; -inf if the record does not determine the coordinates
    noise: Noise  # noise of this shape with the likeliest variance
    #: Cholesky factor of the products of columns whitened with this noise; None if impossible
    factor: np.ndarray | None


class RestrictedLikelihood:
    """Restricted likelihood of the noise in residuals (m,), at times t (m,) [s].

    jacobian : (m, k) derivatives of the fitted curve by the coordinates.  A coordinate whose column
        is 0, because the record does not depend on it, has zero shift and covariance.
    systematic : (m, r) systematic errors (fitting/systematic.py), or None
    level : approximate standard deviation of the noise, if there are systematic errors
    """

    def __init__(self, t, residual, jacobian, systematic=None, level=1.0):
        self.size, dt = jacobian.shape[1], np.diff(t)
        self.seen = np.flatnonzero(jacobian.any(axis=0))
        self.scale = np.abs(jacobian[:, self.seen]).max(axis=0)
        systematic = np.zeros((residual.size, 0)) if systematic is None else systematic
        #: of the unit normal prior of systematic errors, relative to the noise
        self.prior = np.repeat([0.0, level**2, 0.0], [self.seen.size, systematic.shape[1], 1])
        columns = np.column_stack([jacobian[:, self.seen] / self.scale, systematic, residual])
        self.degrees, self._whitened = residual.size - self.seen.size, Whitening(dt, columns)
        #: median time between samples, and length of the record [s]
        self.spacing, self.length = float(np.median(dt)), float(t[-1] - t[0])

    def at(self, shape=WHITE):
        """Return the `Conditional` for a `Noise` of this shape and any variance."""
        parts, count = shape.relaxations(self.spacing), self.prior.size
        white, log_determinant = self._whitened(shape.white**2, *parts)
        try:
            products = (white.T @ white)[:count, :count] + np.diag(self.prior)
            factor = np.linalg.cholesky(products)
        except np.linalg.LinAlgError:  # no residual, or a combination without any effect
            factor = np.zeros((1, 1))
        if self.degrees < 1 or not factor[-1, -1] > 0.0:
            return Conditional(-math.inf, shape, None)
        deviation = float(factor[-1, -1]) / self.degrees**0.5
        log_normal = float(np.log(factor.diagonal()[:-1]).sum())
        minus = self.degrees * math.log(deviation) + 0.5 * log_determinant + log_normal
        return Conditional(-minus, shape.times(deviation), factor / deviation)

    def shift_and_root(self, factor):
        """Return changes (k,) of the estimates, and R (k, k + r) with R R^T their covariance.

        The changes are by generalized least squares, to first order.

        factor : of `Conditional`
        """
        k, seen = self.size, self.seen.size
        shift, root = np.zeros(k), np.zeros((k, k + self.prior.size - seen - 1))
        if factor is not None:
            inverse = np.linalg.inv(factor[:-1, :-1]).T[:seen] / self.scale[:, None]
            shift[self.seen] = inverse @ factor[-1, :-1]
            root[np.ix_(self.seen, [*self.seen, *range(k, root.shape[1])])] = inverse
        return shift, root


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


def estimated_noise(likelihood, near=None):
    """Return the likeliest `Noise` under a `RestrictedLikelihood`, and the `modes` of each family.

    The noise is white unless a correlated part raises ln(likelihood) by more than `RISE`.

    near : `Noise` of similar residuals, from which the search starts, or None
    """
    white, kinds = likelihood.at(), families(likelihood)
    peaks = [modes(family, near) for family in kinds]
    pairs = [(mode, family) for family, found in zip(kinds, peaks, strict=True) for mode in found]
    (highest, point), family = max(pairs, key=lambda pair: pair[0][0])
    likeliest = family.at(point) if highest > white.log_likelihood + RISE else white
    return likeliest.noise, peaks


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
