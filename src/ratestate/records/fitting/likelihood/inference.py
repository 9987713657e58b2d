"""Estimates with errors and intervals from the best fit.

The best fit under each law, and its noise, are found in generalized_least_squares.py.  Errors and
intervals follow from its covariance, from profiles of the likelihood if that is not Gaussian, and
from a posterior on request.
"""

from typing import NamedTuple

import numpy as np

from ..estimates import Estimates, estimates_from
from ..generalized_least_squares import Solution, responds, solution_from, solutions_of
from .noise_uncertainty import Inflation, LikelyNoise, Widening, likely_noise
from .posterior import Posterior, common_prior, sample_posterior
from .profile import BetterPoint, compute_profiles
from .quantities import reported_quantities
from .transients import chance_of_transients, longest_distance

#: how often a fit starts again from a better point on a profile
REFITS = 3


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


def inferences_of(data, settings, loading=None):
    """list of `Inference`, for each law; arguments and errors as of `solutions_of`."""
    solutions = solutions_of(data, settings, loading)
    inferences = [infer(solution, settings.noise, settings.errors) for solution in solutions]
    return with_posteriors(inferences) if settings.errors == "posterior" else inferences


def infer(solution, noise, errors):
    """The `Inference` of a solution, without a posterior; `errors` is as of `fit`."""
    # profiles of a fit to mere noise would lead anywhere
    has_response = responds(solution)
    wanted = errors != "covariance" and (errors != "auto" or has_response)
    quantities = reported_quantities(solution.problem)
    inference = infer_quantities(solution, quantities, noise, wanted, errors == "profile")
    if not has_response:
        return inference
    _, D, _ = longest_distance(inference.estimates, solution.problem.slider)
    return inference._replace(chance=chance_of_transients(inference.solution, D))


def infer_quantities(solution, quantities, noise, wanted=True, everything=False):
    """The `Inference` on some `ReportedQuantity`s; the noise is estimated if it is None.

    wanted : whether profiles are, of quantities along which the likelihood is not Gaussian
    everything : whether profiles of all quantities are

    A point of a profile that fits better than the solution becomes the solution, `REFITS` times at
    most.
    """
    profiles, still_improving = {}, False
    likely, widened = _noise_and_widening(solution, quantities, noise)
    for attempt in range(REFITS + 1 if wanted else 0):
        try:
            profiles = compute_profiles(solution, quantities, everything, widened.roots)
            break
        except BetterPoint as better:
            if still_improving := attempt == REFITS:
                profiles = compute_profiles(solution, quantities, everything, widened.roots, np.inf)
                break
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
    return Inference(
        solution, likely, quantities, estimates, profiles, None, still_improving, np.nan
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
    bound = dict(zip(solution.unknowns.names, solution.at_bound, strict=True))
    at_bound = np.array([bound.get(q.name, False) for q in quantities])
    return likely, Widening(
        np.where(at_bound, none.errors, found.errors),
        np.where(at_bound[:, None, None], none.roots, found.roots),
    )


def inflation_of(inference, coordinates):
    """The `Inflation` of coordinates (list of int) by the noise; none of those at a bound."""
    if inference.likely_noise is None:
        return Inflation()
    bound = inference.solution.at_bound
    return inference.likely_noise.inflation([i for i in coordinates if not bound[i]])


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
