"""Test of the friction law: transients that it leaves in the residuals after steps.

A wrong law leaves transients in the residuals after steps, while the noise is alike along the whole
record.  So the test adds friction that changes after each step, over several distances, and fits it
together with all coordinates, to first order.  Its size is compared with the noise.  The noise is
estimated together with the added friction, so that misfit by a wrong law does not count as noise.

The machine filters the added friction, and a soft machine oscillates.  Friction that falls by f
acts on the slider as a load point that moves by f sigma/K, so that one march gives the effect.
"""

import numpy as np
import scipy

from ..kit.noise import RestrictedLikelihood
from .forward import Forward
from .noise_uncertainty import likely_estimates
from .problem import change_times
from .solutions import chi2_gain

#: distances over which added friction changes, as multiples of the law's longest distance
LENGTHS = (0.1, 0.25, 0.6, 1.5, 4.0, 10.0, 25.0)
#: most steps with added friction; size of the added friction, divided by a
STEPS, SIZE = 4, 1e-2
#: least part of the effect of added friction that is beyond the span of the jacobian
LEAST, TINY = 1e-3, 1e-300
#: speed that stands for a hold, divided by the largest speed
HOLD = 1e-3
#: residuals, as a fraction of friction's range, that are too small for a misfit
FINE = 1e-4


def transients_p_value(solution, D):
    """Return the probability that noise alone leaves such transients after the steps.

    D : distance [m] over which friction evolves

    The probability is a mean over likely shapes of the noise, which is estimated even if it was
    given, unless the noise is rounding.  It is 1 if the residuals are negligible.  It is NaN if
    nothing could be tested: without steps, without a motion under any added friction, or without a
    possible noise.
    """
    record = solution.problem.record
    if np.sqrt(np.mean(solution.residual**2)) < FINE * record.scale:
        return 1.0
    added = _transients(solution, D)
    jacobian, count = np.column_stack([added, solution.jacobian]), added.shape[1]
    if not count:
        return np.nan
    if solution.noise_is_rounding:
        return float(scipy.special.chdtrc(count, chi2_gain(solution, added)[0]))
    more = solution.problem.systematic, solution.noise.level
    likelihood = RestrictedLikelihood(record.t, solution.residual, jacobian, *more)
    estimates, weight = likely_estimates(likelihood)
    if not estimates:
        return np.nan
    chances = []
    for shift, root in estimates:
        # root @ root.T is the covariance of the transients, which may be singular
        scaled = np.linalg.lstsq(root[:count], shift[:count])[0]
        chances.append(scipy.special.fdtrc(count, likelihood.degrees, scaled @ scaled / count))
    return float(weight @ np.array(chances))


def _transients(solution, D):
    """Return effects (m, p) of friction added after steps, beyond the jacobian.

    At most `STEPS` steps of a record are used.
    """
    record, jacobian = solution.problem.record, solution.jacobian
    loading, end = record.loading, record.t[-1]
    times = change_times(loading)
    times = times[times < end]
    chosen = np.unique(np.linspace(0, times.size - 1, min(STEPS, times.size)).round().astype(int))
    speeds = np.maximum(loading.V_load(times[chosen]), HOLD * loading.V.max())
    # the longest change ends with the record at the latest
    once = np.minimum(D / speeds, (end - times[chosen]) / LENGTHS[-1])
    starts = np.repeat(times[chosen], len(LENGTHS))
    columns = _effects_of_falls(solution, starts, np.outer(once, LENGTHS).ravel()).T
    columns = columns[:, np.isfinite(columns).all(axis=0)]
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), TINY)
    basis = np.linalg.qr(jacobian[:, jacobian.any(axis=0)])[0]
    effects, sizes, _ = np.linalg.svd(columns - basis @ (basis.T @ columns), full_matrices=False)
    return effects[:, sizes > LEAST]


def _effects_of_falls(solution, starts, durations):
    """Return the changes of friction (n, m) from even falls of friction by 1.

    They are computed to first order.  The falls start at times (n,) and take durations (n,) [s].
    NaN without a motion.
    """
    problem, record = solution.problem, solution.problem.record
    values = problem.forward.values(solution.point[None])
    a, K, lag = (float(values[name][0]) for name in ("a", "K", "lag"))
    fall, start, duration = SIZE * a, starts[:, None], durations[:, None]
    forward = Forward(record, problem.slider, problem.unknowns.names)
    forward.push(start, start + duration, fall * problem.slider.sigma / (K * duration))
    moved = forward.friction(np.tile(solution.point, (starts.size, 1))) - solution.fitted_friction
    return moved / fall - np.clip((record.t - lag - start) / duration, 0.0, 1.0)
