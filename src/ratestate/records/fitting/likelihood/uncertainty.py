"""Errors and intervals of what is reported, from the solution's covariance (`Solution`).

Profiles of the likelihood where these do not do, and a posterior on request.
"""

from typing import NamedTuple

import numpy as np

from ..estimates import Estimates, estimates_from
from ..generalized_least_squares import Solution, solution_from
from ..score import responds
from .noise_uncertainty import Inflation, LikelyNoise, Widening, likely_noise
from .posterior import Posterior, common_prior, sample_posterior
from .profile import BetterPoint
from .profiles import compute_profiles
from .quantities import reported_quantities
from .transients import chance_of_transients, longest_distance

#: kinds of intervals that a user may choose
ERRORS = ("auto", "covariance", "profile", "posterior")
#: how often a fit starts again from a better point on a profile
REFITS = 3
#: distance from a bound, in standard errors, up to which an estimate is at it
AT_BOUND = 1e-3


class Inference(NamedTuple):
    """A solution with the errors and intervals of its quantities."""

    solution: Solution
    likely_noise: LikelyNoise | None  # None where the noise was given
    quantities: tuple  # `ReportedQuantity`, as in `estimates`
    estimates: Estimates
    profiles: dict  # name -> `Profile`
    posterior: Posterior | None
    still_improving: bool  # even after `REFITS` a profile has a better point
    chance: float  # that noise alone leaves such transients after the steps; NaN if not tested


def infer(solution, noise, errors):
    """The `Inference` of a solution, without a posterior; `errors` is one of `ERRORS`.

    A point of a profile that fits better than the solution becomes the solution: `REFITS` times at
    most, after which there are no profiles.
    """
    profiles, still_improving = {}, False
    quantities = reported_quantities(solution.problem)
    likely, widened = _noise_and_widening(solution, quantities, noise)
    # profiles of a fit to mere noise would lead anywhere
    wanted = errors != "covariance" and (errors != "auto" or responds(solution))
    for attempt in range(REFITS + 1 if wanted else 0):
        try:
            roots = widened.roots
            profiles = compute_profiles(solution, quantities, errors == "profile", roots)
            break
        except BetterPoint as better:
            still_improving = attempt == REFITS
            if not still_improving:
                solution = solution_from(solution.problem, better.point, noise)
                likely, widened = _noise_and_widening(solution, quantities, noise)
    point = solution.point
    gradients = np.array([q.gradient(point) for q in quantities])
    estimates = estimates_from(
        tuple(q.name for q in quantities),
        np.array([q.value(point) for q in quantities]),
        gradients @ solution.covariance @ gradients.T * np.outer(widened.errors, widened.errors),
        np.array([q.is_log for q in quantities]),
        roots=widened.roots / widened.errors[:, None, None],
    )
    ends = {
        q.name: q.si(profiles[q.name].interval(own))
        for q, own in zip(quantities, widened.roots, strict=True)
        if q.name in profiles
    }
    estimates = estimates.with_intervals(ends, "profile")
    _, D, _ = longest_distance(estimates, solution.problem.slider)
    chance = chance_of_transients(solution, D) if responds(solution) else np.nan
    return Inference(
        solution, likely, quantities, estimates, profiles, None, still_improving, chance
    )


def _noise_and_widening(solution, quantities, noise):
    """`LikelyNoise`, and the `Widening` of `ReportedQuantity`s by it; none if the noise is given.

    None of an estimate at a bound either: chi-square slopes there, so that to first order other
    noise would move the estimate out of its bounds, and one end of its interval with it.
    """
    none = Widening.none(len(quantities))
    likely = likely_noise(solution) if noise is None else None
    if likely is None:
        return None, none
    found = likely.widening(np.array([q.gradient(solution.point) for q in quantities]))
    bound = _at_bound(solution)
    at_bound = np.array([q.is_coordinate and bound[q.eliminated] for q in quantities])
    return likely, Widening(
        np.where(at_bound, none.errors, found.errors),
        np.where(at_bound[:, None, None], none.roots, found.roots),
    )


def inflation_of(inference, coordinates):
    """The `Inflation` of coordinates (list of int) by the noise; none of those at a bound."""
    if inference.likely_noise is None:
        return Inflation()
    bound = _at_bound(inference.solution)
    return inference.likely_noise.inflation([i for i in coordinates if not bound[i]])


def _at_bound(solution):
    """(k,) whether a coordinate of a solution is at an end of its range."""
    _, low, high = solution.unknowns
    near = AT_BOUND * np.sqrt(np.diag(solution.covariance))
    return np.minimum(abs(solution.point - low), abs(high - solution.point)) < near


def with_posteriors(inferences):
    """Each `Inference` with its posterior (list), under one prior; ParameterError without dynesty.

    Its intervals are those of the posterior only if that is reliable.
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
