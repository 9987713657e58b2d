"""Estimates with errors and intervals from the best fit, and a test of the friction law.

Intervals come from the covariance, from profiles of a likelihood that is not Gaussian, and on
request from a posterior.

A wrong law leaves transients in the residuals after steps, while the noise is alike along the whole
record.  So the test adds friction that changes after each step, over several distances, and fits it
together with all coordinates, to first order.  Its size is compared with the noise.  The noise is
estimated together with the added friction, so that misfit by a wrong law does not count as noise.

The machine filters the added friction, and a soft machine oscillates.  Friction that falls by f
acts on the slider as a load point that moves by f sigma/K, so that one march gives the effect.
"""

import dataclasses
from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc

from ..kit.noise import RestrictedLikelihood
from .forward import Forward
from .noise_uncertainty import Inflation, LikelyNoise, Widening, likely_noise, likely_shapes
from .posterior import Posterior, common_prior, sample_posterior
from .problem import change_times
from .profile import LEAST_GAIN, BetterPoint, compute_profiles
from .quantities import Estimates, estimates_from, reported_quantities
from .solutions import Solution, responds, solution_from, solutions_of

#: how often a fit may start again from a better point on a profile
REFITS = 3
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


class Inference(NamedTuple):
    """A solution with the errors and intervals of its quantities."""

    solution: Solution
    likely_noise: LikelyNoise | None  # None if the noise was given
    quantities: tuple  # `ReportedQuantity`, as in `estimates`
    estimates: Estimates
    profiles: dict  # name -> `Profile`
    posterior: Posterior | None
    still_improving: bool  # whether a profile has a better point after `REFITS` restarts
    p_value: float  # of transients after the steps, from noise alone; NaN if not tested


def inferences_of(data, settings, loading=None):
    """Return an `Inference` for each law (list); arguments as for `solutions_of`."""
    noise, errors = settings.noise, settings.errors
    inferences = [infer(one, noise, errors) for one in solutions_of(data, settings, loading)]
    return with_posteriors(inferences) if errors == "posterior" else inferences


def infer(solution, noise, errors):
    """Return the `Inference` of a solution, without posterior; `errors` as for `fit`."""
    # profiles of a fit to noise alone are meaningless
    has_response = responds(solution)
    with_profiles = errors != "covariance" and (errors != "auto" or has_response)
    quantities = reported_quantities(solution.problem)
    inference = infer_quantities(solution, quantities, noise, with_profiles, errors == "profile")
    if not has_response:
        return inference
    _, D, _ = longest_distance(inference.estimates, solution.problem.slider)
    return inference._replace(p_value=transients_p_value(inference.solution, D))


def infer_quantities(solution, quantities, noise, with_profiles=True, all_profiles=False):
    """Return the `Inference` on `ReportedQuantity`s; the noise is estimated if None.

    with_profiles : whether to compute profiles of quantities with a likelihood that is not Gaussian
    all_profiles : whether to compute profiles of all quantities

    A better point on a profile becomes the solution, at most `REFITS` times.
    """
    profiles, still_improving = {}, False
    likely, widened = _noise_and_widening(solution, quantities, noise)
    for attempt in range(REFITS + 2 if with_profiles else 0):
        still_improving = attempt > REFITS
        gain = np.inf if still_improving else LEAST_GAIN
        try:
            profiles = compute_profiles(solution, quantities, all_profiles, widened.roots, gain)
            break
        except BetterPoint as better:
            if attempt < REFITS:
                solution = solution_from(solution.problem, better.point, noise)
                likely, widened = _noise_and_widening(solution, quantities, noise)
    point = solution.point
    root = np.array([q.gradient(point) for q in quantities]) @ solution.root
    estimates = estimates_from(
        tuple(q.name for q in quantities),
        np.array([q.value(point) for q in quantities]),
        root @ root.T * np.outer(widened.errors, widened.errors),
        np.array([q.is_log for q in quantities]),
        roots=widened.roots / widened.errors[:, None, None],
    )
    ends = {
        q.name: q.si(profiles[q.name].interval(own))
        for q, own in zip(quantities, widened.roots, strict=True)
        if q.name in profiles
    }
    estimates = estimates.with_intervals(ends, "profile")
    return Inference(
        solution, likely, quantities, estimates, profiles, None, still_improving, np.nan
    )


def _noise_and_widening(solution, quantities, noise):
    """Return the `LikelyNoise`, and the `Widening` of `ReportedQuantity`s by it.

    There is no widening if the noise is given, nor at a bound.  There chi-square has a slope, so
    that to first order another noise would move the estimate, and an end of its interval, beyond.
    """
    none, likely = Widening.none(len(quantities)), None
    if noise is not None or (likely := likely_noise(solution)) is None:
        return None, none
    widening = likely.widening(np.array([q.gradient(solution.point) for q in quantities]))
    at_bound = np.array([q.name in solution.at_bound for q in quantities])
    return likely, Widening(
        np.where(at_bound, none.errors, widening.errors),
        np.where(at_bound[:, None, None], none.roots, widening.roots),
    )


def inflation_of(inference, coordinates):
    """Return the `Inflation` of coordinates (list of int) that are not at a bound."""
    if inference.likely_noise is None:
        return Inflation()
    names, at_bound = inference.solution.unknowns.names, inference.solution.at_bound
    return inference.likely_noise.inflation([i for i in coordinates if names[i] not in at_bound])


def with_posteriors(inferences):
    """Return each `Inference` with its posterior (list); all have one prior.

    Intervals become quantiles of a posterior that is reliable.  ParameterError without dynesty.
    """
    prior = common_prior(inferences)
    completed = []
    for inference in inferences:
        label = f"posterior of the {inference.solution.problem.law.name} law"
        posterior = sample_posterior(inference.solution, prior, label)
        estimates = inference.estimates
        if posterior.reliable:
            ends = {q.name: q.si(posterior.interval(q)) for q in inference.quantities}
            estimates = estimates.with_intervals(ends, "posterior")
        completed.append(inference._replace(estimates=estimates, posterior=posterior))
    return completed


def transients_p_value(solution, D):
    """Return the probability that noise alone leaves such transients after the steps.

    D : distance [m] over which friction evolves

    The probability is a mean over likely shapes of the noise, which is estimated even if it was
    given.  It is 1 if the residuals are negligible.  It is NaN if nothing could be tested: without
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
    steps = zip(times[chosen].tolist(), once.tolist(), strict=True)
    effects = [_effect_of_fall(solution, t, x * unit) for t, unit in steps for x in LENGTHS]
    columns = np.reshape(effects, (-1, record.t.size)).T
    columns = columns[:, np.isfinite(columns).all(axis=0)]
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), TINY)
    basis = np.linalg.qr(jacobian[:, jacobian.any(axis=0)])[0]
    rest, sizes, _ = np.linalg.svd(columns - basis @ (basis.T @ columns), full_matrices=False)
    return rest[:, sizes > LEAST]


def _effect_of_fall(solution, start, duration):
    """Return the change of friction (m,) from an even fall of friction by 1.

    It is computed to first order.  The fall takes `duration` [s].  NaN without a motion.
    """
    problem, record = solution.problem, solution.problem.record
    point = solution.point[None]
    values = problem.forward.values(point)
    a, K, lag = (float(values[name][0]) for name in ("a", "K", "lag"))
    fall = SIZE * a
    loading = _with_extra_motion(record.loading, start, duration, fall * problem.slider.sigma / K)
    forward = Forward(record._replace(loading=loading), problem.slider, problem.unknowns.names)
    moved = forward.friction(point)[0] - solution.fitted_friction
    return moved / fall - np.clip((record.t - lag - start) / duration, 0.0, 1.0)


def _with_extra_motion(loading, start, duration, distance):
    """Return a loading with a distance [m] added evenly from start on."""
    end = start + duration
    t = np.union1d(loading.t, [start, end])
    speed = loading.speed.refined(t[t < loading.speed.until])
    push = np.where((speed.t >= start) & (speed.t < end), distance / duration, 0.0)
    pushed = dataclasses.replace(speed, start=speed.start + push, end=speed.end + push)
    return dataclasses.replace(loading, speed=pushed)


def longest_distance(estimates, slider):
    """Return the longest distance of a state: its symbol, value and upper limit.

    The limit is the upper end of the 95 % interval.  A distance that is not free has its value.
    """
    distances = []
    for symbol in slider.friction_law.lengths:
        given = float(getattr(slider, symbol))
        if symbol in estimates.names:
            estimate = estimates.of(symbol)
            distances.append((estimate.value, float(estimate.interval[-1, 1]), symbol))
        else:
            distances.append((given, given, symbol))
    value, high, symbol = max(distances)
    return symbol, value, high
