"""The noise of a series from sample to sample, and its resolution."""

import numpy as np

#: standard deviation of normal noise over the median of its size, and of its second differences
OF_MEDIAN, OF_SECOND = 1.4826, 6**0.5
#: standard deviation of what digits cut off, as a fraction of their step
OF_STEP = 12**-0.5
#: largest relative error of rounding
ROUNDING = 1e-12


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
