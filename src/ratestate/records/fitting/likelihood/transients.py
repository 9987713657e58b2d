"""Transients that a fit leaves in the residuals after steps: a test of the friction law.

Whatever the law lacks, it lacks after the steps, while the noise is the same all along a record.
So decays after each step are fitted together with all coordinates, to first order, and their size
is compared with the noise.  This noise is estimated beside the decays: what the law lacks does not
count as noise, whose level and correlation then rest on all else.
"""

import numpy as np
from scipy.special import fdtrc

from ..record import changes
from ..restricted_likelihood import RestrictedLikelihood
from .noise_uncertainty import likely_shapes

#: lengths of the decays, over the distance over which friction evolves, and most steps with decays
LENGTHS, STEPS = (0.1, 0.3, 1.0, 3.0), 8
#: least size of what decays add to the columns of the jacobian, of which they have the size 1
LEAST, TINY = 1e-3, 1e-300
#: speed in a hold, over the largest
HOLD = 1e-3
#: residuals, over friction's range, too small to be a misfit
FINE = 1e-4


def chance_of_transients(solution, D):
    """Probability that noise alone leaves transients as large after the steps; 1 of a fine fit.

    D : distance [m] over which friction evolves

    It is a mean over likely shapes of the noise, which is estimated even if it was given.
    """
    record = solution.problem.record
    if np.sqrt(np.mean(solution.residual**2)) < FINE * record.scale:
        return 1.0
    added = _transients(record, D, solution.jacobian)
    jacobian, count = np.column_stack([added, solution.jacobian]), added.shape[1]
    if not count:
        return 1.0
    likelihood = RestrictedLikelihood(record.t, solution.residual, jacobian)
    shapes, weight = likely_shapes(likelihood)
    if not shapes:
        return 1.0
    chances = []
    for one in shapes:
        root = one.root[:count]  # of the covariance of the transients
        square = one.shift[:count] @ np.linalg.solve(root @ root.T, one.shift[:count])
        chances.append(fdtrc(count, likelihood.degrees, square / count))
    return float(weight @ np.array(chances))


def _transients(record, D, jacobian):
    """(m, p) what decays after the steps of a record add to the columns of a jacobian (m, k).

    If a record has more than `STEPS` steps, some of them stand for all.
    """
    loading, times = record.loading, changes(record.loading)
    durations = D / np.maximum(loading.V_load(times), HOLD * loading.V.max())
    some = np.unique(np.linspace(0, times.size - 1, min(STEPS, times.size)).round().astype(int))
    since = (record.t[:, None] - times[some]) / durations[some]
    decays = [np.where(since < 0.0, 0.0, np.exp(-np.abs(since) / length)) for length in LENGTHS]
    columns = np.concatenate(decays, axis=1)
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), TINY)
    basis = np.linalg.qr(jacobian[:, jacobian.any(axis=0)])[0]
    rest, sizes, _ = np.linalg.svd(columns - basis @ (basis.T @ columns), full_matrices=False)
    return rest[:, sizes > LEAST]


def longest_distance(estimates, slider):
    """Symbol of the longest distance over which a state evolves, its value, and the upper end of
    its 95 % interval; the slider's value if it was given.
    """
    found = []
    for symbol in slider.friction_law.states.values():
        given = float(getattr(slider, symbol))
        if symbol in estimates.names:
            estimate = estimates.of(symbol)
            found.append((estimate.value, float(estimate.interval[-1, 1]), symbol))
        else:
            found.append((given, given, symbol))
    value, high, symbol = max(found)
    return symbol, value, high
