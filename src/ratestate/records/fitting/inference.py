"""Estimates with errors and intervals from the best fit.

Intervals come from the covariance, from profiles of a likelihood that is not Gaussian, and on
request from a posterior.
"""

from typing import NamedTuple

import numpy as np

from .noise_uncertainty import Inflation, LikelyNoise, Widening, likely_noise
from .posterior import Posterior, common_prior, sample_posterior
from .profile import LEAST_GAIN, BetterPoint, compute_profiles
from .quantities import Estimates, estimates_from, reported_quantities
from .solutions import Solution, responds, solution_from, solutions_of
from .transients import transients_p_value

#: how often a fit may start again from a better point on a profile
REFITS = 3


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
    solutions = solutions_of(data, settings, loading)
    inferences = [infer(solution, noise, errors) for solution in solutions]
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
                solution = solution_from(solution.problem, better.args[0], noise)
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

    There is no widening if the noise is given or is rounding, nor at a bound.  There chi-square has
    a slope, so that to first order another noise would move the estimate, and an end of its
    interval, beyond.
    """
    none, likely = Widening.none(len(quantities)), None
    is_known = noise is not None or solution.noise_is_rounding
    if is_known or (likely := likely_noise(solution)) is None:
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


def longest_distance(estimates, slider):
    """Return the longest distance of a state: its symbol, value and upper limit.

    The limit is the upper end of the 95 % interval.  A distance that is not free has its value.
    """
    distances = []
    for symbol in slider.friction_law.lengths:
        value = high = float(getattr(slider, symbol))
        if estimate := estimates.by_name.get(symbol):
            value, high = estimate.value, float(estimate.interval[-1, 1])
        distances.append((value, high, symbol))
    value, high, symbol = max(distances)
    return symbol, value, high
