"""Noise of a record made white: a Kalman filter for white noise plus an Ornstein-Uhlenbeck process.

The noise at sample i is w_i + z_i, with w_i independent of variance `white` and z a stationary
Gaussian process of variance `red` whose correlation falls as exp(-|t|/time).  Its covariance
Sigma factors as L L^T with L lower triangular; L^-1 takes O(n), whatever the sampling times
(a semi-separable matrix; Kalman 1960 doi:10.1115/1.3662552).
"""

import math

import numpy as np

from .jit import kernel


@kernel
def whiten(dt, white, red, time, columns, out):
    """Put L^-1 applied to each column of `columns` into `out`; return ln det Sigma.

    Parameters
    ----------
    dt : (n - 1,) steps between the samples [s], >= 0
    white, red : variances of the two parts, >= 0, not both 0
    time : correlation time [s], > 0
    columns, out : (n, k), n >= 1; the result goes into `out`

    Nothing is checked here.
    """
    n, k = columns.shape
    log_determinant = 0.0
    variance, predicted = red, np.zeros(k)  # of z, and its mean, before the sample is seen
    for i in range(n):
        total = variance + white
        log_determinant += math.log(total)
        root = 1.0 / math.sqrt(total)
        gain = variance / total
        keep = math.exp(-dt[i] / time) if i + 1 < n else 0.0
        for j in range(k):
            innovation = columns[i, j] - predicted[j]
            out[i, j] = innovation * root
            predicted[j] = keep * (predicted[j] + gain * innovation)
        variance = keep * keep * (variance * (1.0 - gain)) + red * (1.0 - keep * keep)
    return log_determinant
