"""Whiten the noise of a record: a Kalman filter for white noise plus relaxations.

The noise at sample i is w_i plus the sum of z_ki.  The w_i are independent with variance `white`.
Each z_k is a stationary Gaussian process (Ornstein-Uhlenbeck) with variance `variances[k]`, whose
correlation falls as exp(-|t|/times[k]).  The covariance Sigma of the noise factors as L L^T with L
lower triangular.  L^-1 takes O(n) operations at any sampling times (a semi-separable matrix; Kalman
1960 doi:10.1115/1.3662552).
"""

from collections import namedtuple

import numpy as np

from ..friction.functions import exp, log, sqrt
from .code import VECTOR
from .programs import Program

#: relative differences up to which steps between samples are equal, and gains have converged
EQUAL, CONVERGED = 1e-8, 1e-13
MOST = 4 * VECTOR  # relaxations

#: the record that `_filter` works on
Filter = namedtuple(
    "Filter",
    "dt columns out count white log_determinant variances times previous gain weight decay"
    " covariance added predicted",
)


class Whitening:
    """Whitens the same columns (n, k), n >= 1, for any noise.

    dt : (n - 1,) steps between the samples [s], >= 0
    """

    def __init__(self, dt, columns):
        n, k = columns.shape
        padded = np.zeros((n, k + -k % VECTOR))
        padded[:, :k] = columns
        numbers = np.zeros(1, np.int64), np.zeros(1), np.zeros(1)
        # covariance of z predicted before a sample, its increase meanwhile, and mean of z
        tables = np.zeros((MOST, MOST)), np.zeros((MOST, MOST)), np.zeros((MOST, padded.shape[1]))
        fields = np.ascontiguousarray(dt, float), padded, np.empty_like(padded), *numbers
        self._filter = Filter._make([*fields, *np.zeros((6, MOST)), *tables])
        self._program = Program(_filter, self._filter)

    def __call__(self, white, variances, times):
        """Return L^-1 applied to each column, and ln det Sigma.

        Columns of zeros are added, up to whole vectors.  The array is overwritten by the next call,
        so two threads must not share a `Whitening`.

        white : variance of the white part, >= 0
        variances, times : (m,) variances of the relaxations, >= 0, and their times [s], > 0

        At least one variance must be positive.  The arguments are not checked.
        """
        run, m = self._filter, len(variances)
        run.count[0], run.white[0], run.variances[:m], run.times[:m] = m, white, variances, times
        run.covariance[...], run.predicted[...], run.previous[...] = 0.0, 0.0, 0.0
        np.fill_diagonal(run.covariance[:m, :m], variances)
        self._program(len(run.columns))
        return run.out, float(run.log_determinant[0])


def _filter(run, n):
    gain, previous, weight, decay = run.gain, run.previous, run.weight, run.decay
    covariance, predicted, columns, out = run.covariance, run.predicted, run.columns, run.out
    added, k, m = run.added, columns.shape[1], run.count[0]
    root, log_variance, is_steady, last, log_determinant = 1.0, 0.0, False, -1.0, 0.0
    for i in range(n):
        if not is_steady:
            for b in range(0, m, VECTOR):
                total = covariance[0, b : b + VECTOR]
                for a in range(1, m):
                    total = total + covariance[a, b : b + VECTOR]
                gain[b : b + VECTOR] = total
            variance, change = run.white[0], 0.0
            for a in range(m):
                variance += gain[a]
                change += abs(gain[a] - previous[a])
                previous[a] = gain[a]
            # (at one time step gains approach their limit: n samples drift by n CONVERGED at most)
            is_steady = change <= CONVERGED * variance
            inverse, log_variance = 1.0 / variance, log(variance)
            root = sqrt(inverse)
            for b in range(0, m, VECTOR):
                weight[b : b + VECTOR] = inverse * gain[b : b + VECTOR]
        log_determinant += log_variance
        if i + 1 < n and abs(run.dt[i] - last) > EQUAL * last:
            last, is_steady = run.dt[i], False
            for a in range(m):
                decay[a] = exp(-last / run.times[a])
                added[a, a] = run.variances[a] * (1.0 - decay[a] * decay[a])
        for j in range(0, k, VECTOR):
            innovation = columns[i, j : j + VECTOR]
            for a in range(m):
                innovation = innovation - predicted[a, j : j + VECTOR]
            out[i, j : j + VECTOR] = root * innovation
            for a in range(m):
                updated = predicted[a, j : j + VECTOR] + weight[a] * innovation
                predicted[a, j : j + VECTOR] = decay[a] * updated
        if not is_steady:
            for a in range(m):
                for b in range(0, m, VECTOR):
                    rest = covariance[a, b : b + VECTOR] - gain[a] * weight[b : b + VECTOR]
                    kept = decay[a] * decay[b : b + VECTOR] * rest
                    covariance[a, b : b + VECTOR] = kept + added[a, b : b + VECTOR]
    run.log_determinant[0] = log_determinant
    return True
