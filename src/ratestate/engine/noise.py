"""Whiten the noise of a record: a Kalman filter for white noise plus relaxations.

The noise at sample i is w_i plus the sum of z_ki.  The w_i are independent with variance `white`.
Each z_k is a stationary Gaussian process (Ornstein-Uhlenbeck) with variance `variances[k]`, whose
correlation falls as exp(-|t|/times[k]).  The covariance Sigma of the noise factors as L L^T with L
lower triangular.  L^-1 takes O(n) operations at any sampling times (a semi-separable matrix; Kalman
1960 doi:10.1115/1.3662552).
"""

from typing import NamedTuple

import numpy as np

from ..friction.functions import exp, log, sqrt
from .programs import Program


class Filter(NamedTuple):
    """The record that `_filter` works on."""

    dt: np.ndarray  # (n - 1,) steps between the samples
    white: np.ndarray  # (1,)
    variances: np.ndarray  # (m,) of the relaxations
    times: np.ndarray  # (m,)
    columns: np.ndarray  # (n, k)
    out: np.ndarray  # (n, k)
    log_determinant: np.ndarray  # (1,)
    # covariance and mean of z, predicted before each sample
    covariance: np.ndarray  # (m, m)
    predicted: np.ndarray  # (m, k)
    gain: np.ndarray  # (m,)
    weight: np.ndarray  # (m,) gain divided by the variance of the innovation
    decay: np.ndarray  # (m,) decay of each relaxation from one sample to the next


def whiten(dt, white, variances, times, columns):
    """Return L^-1 applied to each column, and ln det Sigma.

    Parameters
    ----------
    dt : (n - 1,) steps between the samples [s], >= 0
    white : variance of the white part, >= 0
    variances, times : (m,) variances of the relaxations, >= 0, and their times [s], > 0
    columns : (n, k), n >= 1

    At least one variance must be positive.  The arguments are not checked.
    """
    n, m = len(columns), len(variances)
    inputs = (np.ascontiguousarray(x, float) for x in (dt, [white], variances, times, columns))
    shapes = columns.shape, (1,), (m, m), (m, columns.shape[1]), (m,), (m,), (m,)
    filter_ = Filter(*inputs, *(np.zeros(shape) for shape in shapes))
    filter_.covariance[...] = np.diag(variances)
    Program(_filter, filter_)(n)
    return filter_.out, float(filter_.log_determinant[0])


def _filter(run, n):
    gain, weight, decay = run.gain, run.weight, run.decay
    covariance, predicted = run.covariance, run.predicted
    k, m, log_determinant, last = run.columns.shape[1], gain.shape[0], 0.0, -1.0
    for i in range(n):
        variance = run.white[0]
        for a in range(m):
            gain[a] = 0.0
            for b in range(m):
                gain[a] += covariance[a, b]
            variance += gain[a]
        log_determinant += log(variance)
        root = 1.0 / sqrt(variance)
        for a in range(m):
            weight[a] = gain[a] / variance
        if i + 1 < n and run.dt[i] != last:
            last = run.dt[i]
            for a in range(m):
                decay[a] = exp(-last / run.times[a])
        for j in range(k):
            innovation = run.columns[i, j]
            for a in range(m):
                innovation -= predicted[a, j]
            run.out[i, j] = innovation * root
            for a in range(m):
                predicted[a, j] = decay[a] * (predicted[a, j] + weight[a] * innovation)
        for a in range(m):
            for b in range(m):
                posterior = covariance[a, b] - gain[a] * gain[b] / variance
                covariance[a, b] = decay[a] * decay[b] * posterior
            covariance[a, a] += run.variances[a] * (1.0 - decay[a] * decay[a])
    run.log_determinant[0] = log_determinant
    return True
