"""The noise of a series from sample to sample, and its resolution."""

import math
from typing import NamedTuple

import numpy as np

#: standard deviation of normal noise over the median of its size, and of its second differences
OF_MEDIAN, OF_SECOND = 1.4826, 6**0.5
#: standard deviation of what digits cut off, as a fraction of their step
OF_STEP = 12**-0.5
#: largest relative error of rounding
ROUNDING = 1e-12
#: standard errors from which a correlation counts; the largest
KNOWN, MOST_CORRELATED = 3.0, 0.95


class SampleNoise(NamedTuple):
    """White noise of samples, or noise of first-order correlation."""

    sd: float
    correlation: float = 0.0  # of neighbouring samples

    @property
    def inflation(self):
        """Variance of a mean divided by that with white noise."""
        return (1.0 + self.correlation) / (1.0 - self.correlation)


def noise_of_residuals(residuals, parameters):
    """The `SampleNoise` in residuals (list of (n,)) of fits with so many parameters each."""
    power = sum(float(rest @ rest) for rest in residuals)
    samples, taken = sum(map(len, residuals)), parameters * len(residuals)
    pairs = samples - len(residuals)
    products = sum(float(rest[1:] @ rest[:-1]) for rest in residuals)
    # (a fit takes some correlation out: by its parameters over the samples, to first order)
    correlation = products / power + taken / pairs
    known = correlation > KNOWN / math.sqrt(pairs)
    correlation = min(correlation, MOST_CORRELATED) if known else 0.0
    return SampleNoise(math.sqrt(power / (samples - taken)), correlation)


def sample_noise(values):
    """Standard deviation of the white noise in values (n,), n > 2, on a smooth curve."""
    return float(np.median(np.abs(np.diff(values, 2)))) * OF_MEDIAN / OF_SECOND


def resolution(values):
    """Smallest difference between values (n,), which their digits show; 0 if all are the same.

    Smaller ones than `ROUNDING` times the values are of rounding in a computer.
    """
    steps = np.diff(np.unique(values))
    return float(min(steps[steps > ROUNDING * np.abs(values).max()], default=0.0))


def rounding(values):
    """Return the standard deviation of the rounding of values (n,) to their last digit."""
    return OF_STEP * resolution(values)
