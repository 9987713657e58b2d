"""From a solution to numbers with errors: covariance, profiles where needed, posterior if asked."""

from typing import NamedTuple

from ..result import Estimates, estimates
from ..score import responds
from ..solve import Solution, settled
from .posterior import Posterior, posterior, prior_of
from .profile import Better
from .profiles import profiles
from .reported import reported_of

#: kinds of intervals, as the user asks for them
ERRORS = ("auto", "covariance", "profile", "posterior")
#: how often a fit is made again from a better point that a profile has found
REFITS = 3


class Uncertain(NamedTuple):
    """A solution, and how well its numbers are known."""

    solution: Solution
    numbers: tuple  # `Reported`, as in `estimates`
    estimates: Estimates
    profiles: dict  # name -> `Profile`
    sampled: Posterior | None
    restless: bool  # profiles have found ever better points


def uncertain(solution, slider, noise, errors):
    """The `Uncertain` of a solution, without a posterior.

    A point of a profile that fits better than the solution becomes the solution.

    Parameters
    ----------
    solution : Solution
    slider : SpringSlider
    noise : Noise, or None where it is estimated
    errors : str, one of `ERRORS`
    """
    made, restless = {}, False
    numbers = reported_of(solution.problem, slider)
    # profiles of what is mere noise would lead anywhere
    wanted = errors != "covariance" and (errors != "auto" or responds(solution))
    for again in range(REFITS if wanted else 0):
        try:
            made = profiles(solution, numbers, errors == "profile")
            break
        except Better as better:
            solution = settled(solution.problem, better.point, noise)
            restless = again == REFITS - 1
    found = _estimates(solution, numbers)
    ends = {n.name: n.si(made[n.name].interval()) for n in numbers if n.name in made}
    return Uncertain(solution, numbers, found.with_intervals(ends, "profile"), made, None, restless)


def with_posteriors(known, laws):
    """Each `Uncertain` with its posterior, all under one prior."""
    reaches = [
        {
            number.name: one.profiles[number.name].interval()[-1]
            for number in one.numbers
            if number.name in one.profiles and number.plain
        }
        for one in known
    ]
    prior = prior_of([one.solution for one in known], reaches)
    found = []
    for one, law in zip(known, laws, strict=True):
        sampled = posterior(one.solution, prior, f"posterior of the {law} law")
        table = one.estimates
        if sampled.sound:
            ends = {number.name: number.si(sampled.interval(number)) for number in one.numbers}
            table = table.with_intervals(ends, "posterior")
        found.append(one._replace(estimates=table, sampled=sampled))
    return found


def _estimates(solution, numbers):
    """`Estimates` of the numbers, from the covariance."""
    names = solution.unknowns.names
    derived = [
        (number.name, number.value(solution.point), number.gradient(solution.point))
        for number in numbers
        if not number.plain
    ]
    found = estimates(names, solution.point, solution.covariance, derived)
    return found.only([number.name for number in numbers])
