"""Noise between neighbouring samples of a series, and its resolution."""

import math
from typing import NamedTuple

import numpy as np
import scipy

#: ratio of the standard deviation of normal noise to its median size; of second differences to it
OF_MEDIAN, OF_SECOND = 1.4826, 6**0.5
#: standard deviation of rounding errors, as a fraction of the step between digits
OF_STEP = 12**-0.5
#: largest relative rounding error of floating-point numbers
ROUNDING = 1e-12
#: largest deviation of a rounded value from a multiple of the step, in steps
OFF = 0.05
#: least significant correlation in standard errors; largest correlation
KNOWN, MOST_CORRELATED = 3.0, 0.95


class SampleNoise(NamedTuple):
    """White noise of samples, or noise of first-order correlation."""

    sd: float
    correlation: float = 0.0  # of neighbouring samples

    @property
    def inflation(self):
        """Return the variance of a mean divided by its variance with white noise."""
        return (1.0 + self.correlation) / (1.0 - self.correlation)

    def draw(self, n, rng):
        """Return n random samples of this noise."""
        white = rng.standard_normal(n) * self.sd
        if self.correlation == 0.0:
            return white
        white[1:] *= np.sqrt(1.0 - self.correlation**2)
        return scipy.signal.lfilter([1.0], [1.0, -self.correlation], white)


def noise_of_residuals(residuals, parameters):
    """Return the `SampleNoise` of residuals (list of (n,)), given the parameters of each fit."""
    power = sum(float(rest @ rest) for rest in residuals)
    samples, fitted = sum(map(len, residuals)), parameters * len(residuals)
    pairs = samples - len(residuals)
    products = sum(float(rest[1:] @ rest[:-1]) for rest in residuals)
    # (to first order, a fit reduces the correlation by its parameters divided by the samples)
    correlation = products / power + fitted / pairs
    known = correlation > KNOWN / math.sqrt(pairs)
    correlation = min(correlation, MOST_CORRELATED) if known else 0.0
    return SampleNoise(math.sqrt(power / (samples - fitted)), correlation)


def sample_noise(values):
    """Return the standard deviation of white noise in values (n,) on a smooth curve, n > 2."""
    return float(np.median(np.abs(np.diff(values, 2)))) * OF_MEDIAN / OF_SECOND


def resolution(values):
    """Return the smallest difference between values (n,), or 0 if all are equal.

    Differences below `ROUNDING` times the values are floating-point errors and are ignored.
    """
    steps = np.diff(np.unique(values))
    return float(min(steps[steps > ROUNDING * np.abs(values).max()], default=0.0))


def digit_of(values):
    """Return the step between digits of values (n,), or 0 if they are not multiples of a step."""
    step = resolution(values)
    counts = (values - values.min()) / (step or 1.0)
    return step if (np.abs(counts - counts.round()) < OFF).all() else 0.0


def rounding(values):
    """Return the standard deviation of the rounding of values (n,) to their last digit."""
    return OF_STEP * resolution(values)
