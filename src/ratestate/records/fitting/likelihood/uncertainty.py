"""Errors of a solution's quantities: covariance, profiles where needed, posterior on request."""

from typing import NamedTuple

from ..estimates import Estimates, estimates_from
from ..score import responds
from ..solve import Solution, solution_from
from .posterior import Posterior, common_prior, sample_posterior
from .profile import BetterPoint
from .profiles import compute_profiles
from .quantities import reported_quantities

#: kinds of intervals that a user may choose
ERRORS = ("auto", "covariance", "profile", "posterior")
#: how often a fit starts again from a better point on a profile
REFITS = 3


class Inference(NamedTuple):
    """A solution with the errors and intervals of its quantities."""

    solution: Solution
    quantities: tuple  # `ReportedQuantity`, as in `estimates`
    estimates: Estimates
    profiles: dict  # name -> `Profile`
    posterior: Posterior | None
    still_improving: bool  # even after `REFITS` a profile has a better point


def infer(solution, slider, noise, errors):
    """The `Inference` of a solution, without a posterior.

    A point of a profile that fits better than the solution becomes the solution.

    Parameters
    ----------
    solution : Solution
    slider : SpringSlider
    noise : Noise, or None where it is estimated
    errors : str, one of `ERRORS`
    """
    profiles, still_improving = {}, False
    quantities = reported_quantities(solution.problem, slider)
    # profiles of a fit to mere noise would lead anywhere
    wanted = errors != "covariance" and (errors != "auto" or responds(solution))
    for attempt in range(REFITS if wanted else 0):
        try:
            profiles = compute_profiles(solution, quantities, errors == "profile")
            break
        except BetterPoint as better:
            solution = solution_from(solution.problem, better.point, noise)
            still_improving = attempt == REFITS - 1
    ends = {q.name: q.si(profiles[q.name].interval()) for q in quantities if q.name in profiles}
    estimates = _covariance_estimates(solution, quantities).with_intervals(ends, "profile")
    return Inference(solution, quantities, estimates, profiles, None, still_improving)


def with_posteriors(inferences, laws):
    """Each `Inference` with its posterior, all under one prior."""
    reaches = [
        {
            q.name: inference.profiles[q.name].interval()[-1]
            for q in inference.quantities
            if q.name in inference.profiles and q.is_coordinate
        }
        for inference in inferences
    ]
    prior = common_prior([inference.solution for inference in inferences], reaches)
    completed = []
    for inference, law in zip(inferences, laws, strict=True):
        posterior = sample_posterior(inference.solution, prior, f"posterior of the {law} law")
        estimates = inference.estimates
        if posterior.reliable:
            ends = {q.name: q.si(posterior.interval(q)) for q in inference.quantities}
            estimates = estimates.with_intervals(ends, "posterior")
        completed.append(inference._replace(estimates=estimates, posterior=posterior))
    return completed


def _covariance_estimates(solution, quantities):
    """`Estimates` of the quantities, from the covariance."""
    derived = [
        (q.name, q.value(solution.point), q.gradient(solution.point))
        for q in quantities
        if not q.is_coordinate
    ]
    names = solution.unknowns.names
    estimates = estimates_from(names, solution.point, solution.covariance, derived)
    return estimates.only([q.name for q in quantities])
