"""Noise of a record made white: a Kalman filter for white noise plus a sum of relaxations.

The noise at sample i is w_i plus the sum of z_ki, with w_i independent of variance `white` and each
z_k a stationary Gaussian process (Ornstein-Uhlenbeck) of variance `variances[k]`, whose correlation
falls as exp(-|t|/times[k]).  The covariance Sigma of the noise factors as L L^T with L lower
triangular; L^-1 takes O(n), whatever the sampling times (a semi-separable matrix; Kalman 1960
doi:10.1115/1.3662552).
"""

from typing import NamedTuple

import numpy as np

from ..friction.functions import exp, log, sqrt
from .programs import Program


class Filter(NamedTuple):
    """What `_filter` works on."""

    dt: np.ndarray  # (n - 1,) steps between the samples
    white: np.ndarray  # (1,)
    variances: np.ndarray  # (m,) of the relaxations
    times: np.ndarray  # (m,)
    columns: np.ndarray  # (n, k)
    out: np.ndarray  # (n, k)
    log_determinant: np.ndarray  # (1,)
    # the covariance of z and its mean, before the sample is seen
    covariance: np.ndarray  # (m, m)
    predicted: np.ndarray  # (m, k)
    gain: np.ndarray  # (m,)
    part: np.ndarray  # (m,) of the innovation: the gain divided by its variance
    keep: np.ndarray  # (m,)


def whiten(dt, white, variances, times, columns):
    """L^-1 applied to each column, and ln det Sigma.

    Parameters
    ----------
    dt : (n - 1,) steps between the samples [s], >= 0
    white : variance of the white part, >= 0
    variances, times : (m,) variances of the relaxations, >= 0, and their times [s], > 0
    columns : (n, k), n >= 1

    Not all variances are 0.  Nothing is checked here.
    """
    n, m = len(columns), len(variances)
    given = (np.ascontiguousarray(x, float) for x in (dt, [white], variances, times, columns))
    shapes = columns.shape, (1,), (m, m), (m, columns.shape[1]), (m,), (m,), (m,)
    filter_ = Filter(*given, *(np.zeros(shape) for shape in shapes))
    filter_.covariance[...] = np.diag(variances)
    Program(_filter, filter_)(n)
    return filter_.out, float(filter_.log_determinant[0])


def _filter(run, n):
    gain, part, keep = run.gain, run.part, run.keep
    covariance, predicted = run.covariance, run.predicted
    k, m, log_determinant, last = run.columns.shape[1], gain.shape[0], 0.0, -1.0
    for i in range(n):
        total = run.white[0]
        for a in range(m):
            gain[a] = 0.0
            for b in range(m):
                gain[a] += covariance[a, b]
            total += gain[a]
        log_determinant += log(total)
        root = 1.0 / sqrt(total)
        for a in range(m):
            part[a] = gain[a] / total
        if i + 1 < n and run.dt[i] != last:
            last = run.dt[i]
            for a in range(m):
                keep[a] = exp(-last / run.times[a])
        for j in range(k):
            innovation = run.columns[i, j]
            for a in range(m):
                innovation -= predicted[a, j]
            run.out[i, j] = innovation * root
            for a in range(m):
                predicted[a, j] = keep[a] * (predicted[a, j] + part[a] * innovation)
        for a in range(m):
            for b in range(m):
                left = covariance[a, b] - gain[a] * gain[b] / total
                covariance[a, b] = keep[a] * keep[b] * left
            covariance[a, a] += run.variances[a] * (1.0 - keep[a] * keep[a])
    run.log_determinant[0] = log_determinant
    return True
