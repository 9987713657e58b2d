"""Noise of a record made white: a Kalman filter for white noise plus a sum of relaxations.

The noise at sample i is w_i plus the sum of z_ki, with w_i independent of variance `white` and each
z_k a stationary Gaussian process (Ornstein-Uhlenbeck) of variance `variances[k]`, whose correlation
falls as exp(-|t|/times[k]).  The covariance Sigma of the noise factors as L L^T with L lower
triangular; L^-1 takes O(n), whatever the sampling times (a semi-separable matrix; Kalman 1960
doi:10.1115/1.3662552).
"""

import math

import numpy as np

from .jit import kernel


@kernel
def whiten(dt, white, variances, times, columns, out):
    """Put L^-1 applied to each column of `columns` into `out`; return ln det Sigma.

    Parameters
    ----------
    dt : (n - 1,) steps between the samples [s], >= 0
    white : variance of the white part, >= 0
    variances, times : (m,) variances of the relaxations, >= 0, and their times [s], > 0
    columns, out : (n, k), n >= 1; the result goes into `out`

    Not all variances are 0.  Nothing is checked here.
    """
    n, k = columns.shape
    m = variances.size
    log_determinant, last = 0.0, -1.0
    # the covariance of z and its mean, before the sample is seen
    covariance, predicted = np.diag(variances), np.zeros((m, k))
    gain, keep = np.zeros(m), np.zeros(m)
    for i in range(n):
        total = white
        for a in range(m):
            gain[a] = 0.0
            for b in range(m):
                gain[a] += covariance[a, b]
            total += gain[a]
        log_determinant += math.log(total)
        root = 1.0 / math.sqrt(total)
        if i + 1 < n and dt[i] != last:
            last = dt[i]
            for a in range(m):
                keep[a] = math.exp(-last / times[a])
        for j in range(k):
            innovation = columns[i, j]
            for a in range(m):
                innovation -= predicted[a, j]
            out[i, j] = innovation * root
            for a in range(m):
                predicted[a, j] = keep[a] * (predicted[a, j] + gain[a] / total * innovation)
        for a in range(m):
            for b in range(m):
                left = covariance[a, b] - gain[a] * gain[b] / total
                covariance[a, b] = keep[a] * keep[b] * left
            covariance[a, a] += variances[a] * (1.0 - keep[a] * keep[a])
    return log_determinant
