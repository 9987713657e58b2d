"""Transients that a fit leaves in the residuals after steps: a test of the friction law.

A law that lacks something lacks it after the steps, while the noise is the same all along a record.
So friction is added that changes after each step, over several distances, and is fitted together
with all coordinates, to first order.  Its size is compared with the noise.  The noise is estimated
together with the added friction, so the effect of a wrong law does not count as noise.

The machine filters the added friction: a soft one oscillates.  For the slider, friction that falls
by f is a load point that moves f sigma/K further, so one march gives the effect.
"""

import dataclasses

import numpy as np
from scipy.special import fdtrc

from ....model.history import History
from ...kit.estimated_noise import RestrictedLikelihood
from ..forward import Forward
from ..record import changes
from .noise_uncertainty import likely_shapes

#: distances over which added friction changes, divided by the longest distance of the law
LENGTHS = (0.1, 0.25, 0.6, 1.5, 4.0, 10.0, 25.0)
#: most steps with added friction; its size, divided by a
STEPS, SIZE = 4, 1e-2
#: least size of what added friction changes beyond the columns of the jacobian, out of 1
LEAST, TINY = 1e-3, 1e-300
#: speed in a hold, over the largest
HOLD = 1e-3
#: residuals, over friction's range, too small to be a misfit
FINE = 1e-4


def chance_of_transients(solution, D):
    """Return the probability that noise alone leaves transients as large after the steps.

    D : distance [m] over which friction evolves

    The probability is a mean over likely shapes of the noise, which is estimated even if it was
    given.  It is 1 if the residuals are negligible, and NaN if nothing could be tested: without
    steps, without a motion under any added friction, or without a possible noise.
    """
    record = solution.problem.record
    if np.sqrt(np.mean(solution.residual**2)) < FINE * record.scale:
        return 1.0
    added = _transients(solution, D)
    jacobian, count = np.column_stack([added, solution.jacobian]), added.shape[1]
    if not count:
        return np.nan
    likelihood = RestrictedLikelihood(record.t, solution.residual, jacobian)
    shapes, weight = likely_shapes(likelihood)
    if not shapes:
        return np.nan
    chances = []
    for one in shapes:
        # root @ root.T is the covariance of the transients, which may be singular
        scaled = np.linalg.lstsq(one.root[:count], one.shift[:count])[0]
        chances.append(fdtrc(count, likelihood.degrees, scaled @ scaled / count))
    return float(weight @ np.array(chances))


def _transients(solution, D):
    """(m, p) what friction added after the steps changes, beyond the columns of the jacobian.

    If a record has more than `STEPS` steps, some of them stand for all.
    """
    record, jacobian = solution.problem.record, solution.jacobian
    loading, end = record.loading, record.t[-1]
    times = changes(loading)
    times = times[times < end]
    some = np.unique(np.linspace(0, times.size - 1, min(STEPS, times.size)).round().astype(int))
    speeds = np.maximum(loading.V_load(times[some]), HOLD * loading.V.max())
    # even if D is larger than what the record shows, the longest change ends with the record
    once = np.minimum(D / speeds, (end - times[some]) / LENGTHS[-1])
    steps = zip(times[some].tolist(), once.tolist(), strict=True)
    effects = [_effect(solution, t, length * unit) for t, unit in steps for length in LENGTHS]
    columns = np.reshape(effects, (-1, record.t.size)).T
    columns = columns[:, np.isfinite(columns).all(axis=0)]
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), TINY)
    basis = np.linalg.qr(jacobian[:, jacobian.any(axis=0)])[0]
    rest, sizes, _ = np.linalg.svd(columns - basis @ (basis.T @ columns), full_matrices=False)
    return rest[:, sizes > LEAST]


def _effect(solution, start, duration):
    """(m,) change of friction if friction falls by 1, evenly, from `start` for `duration` [s].

    To first order; NaN without a motion.
    """
    problem, record = solution.problem, solution.problem.record
    point = solution.point[None]
    values = problem.forward.values(point)
    a, K, lag = (float(values[name][0]) for name in ("a", "K", "lag"))
    fall = SIZE * a
    loading = _moved_further(record.loading, start, duration, fall * problem.slider.sigma / K)
    forward = Forward(record._replace(loading=loading), problem.slider, problem.unknowns.names)
    moved = forward.friction(point)[0] - solution.fitted_friction
    return moved / fall - np.clip((record.t - lag - start) / duration, 0.0, 1.0)


def _moved_further(loading, start, duration, distance):
    """A loading whose load point moves a distance [m] further, from start for a duration [s]."""
    end = start + duration
    until = loading.speed.until
    t = np.union1d(loading.t, [start, end])
    t = t[t < until]
    k = np.searchsorted(loading.t, t, side="right") - 1
    last = np.append(t[1:], until if np.isfinite(until) else t[-1])  # (constant if it is inf)
    push = np.where((t >= start) & (t < end), distance / duration, 0.0)
    first, final = (loading.V[k] + loading.rate[k] * (x - loading.t[k]) + push for x in (t, last))
    return dataclasses.replace(loading, speed=History(t, first, final, until))


def longest_distance(estimates, slider):
    """Symbol of the longest distance over which a state evolves, its value, and the upper end of
    its 95 % interval; the slider's value if it was given.
    """
    found = []
    for symbol in slider.friction_law.lengths:
        given = float(getattr(slider, symbol))
        if symbol in estimates.names:
            estimate = estimates.of(symbol)
            found.append((estimate.value, float(estimate.interval[-1, 1]), symbol))
        else:
            found.append((given, given, symbol))
    value, high, symbol = max(found)
    return symbol, value, high
