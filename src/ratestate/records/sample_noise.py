"""The noise of a series from sample to sample."""

import numpy as np

#: standard deviation of normal noise over the median of its size, and of its second differences
OF_MEDIAN, OF_SECOND = 1.4826, 6**0.5


def sample_noise(values):
    """Standard deviation of the white noise in values (n,), n > 2, on a smooth curve."""
    return float(np.median(np.abs(np.diff(values, 2)))) * OF_MEDIAN / OF_SECOND
