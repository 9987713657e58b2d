"""What a fit reports, as functions of the coordinates in which it moves, with errors and intervals.

Most are coordinates themselves (unknowns.py).  The rate dependence of steady friction and mu0 are
not, but each can replace one coordinate: a least-squares fit with such a quantity constrained has
one coordinate less.  Errors and intervals are those of the solution's covariance, from profiles of
the likelihood where these do not do, and from a posterior on request.
"""

import operator
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ....friction.linear_stability import linearisation
from ..estimates import Estimates, estimates_from
from ..forward import Forward
from ..generalized_least_squares import Solution, responds, solution_from, solutions_of
from ..unknowns import LINEAR, parameter, starts_of, to_coordinate, to_value
from .noise_uncertainty import Inflation, LikelyNoise, Widening, likely_noise
from .posterior import Posterior, common_prior, sample_posterior
from .profile import BetterPoint, compute_profiles
from .transients import chance_of_transients, longest_distance

#: steps of Newton's method, of which one is enough where a quantity is linear
NEWTON = 3
#: derivative of the rate dependence by a coordinate that is rounding
ROUNDING = 1e-9
#: how often a fit starts again from a better point on a profile
REFITS = 3


class ReportedQuantity(NamedTuple):
    """A quantity as a function of the coordinates: one of them, or computed from their values."""

    name: str
    names: tuple  # of the coordinates
    eliminated: int  # the coordinate that a constraint on this quantity eliminates
    forward: Forward
    function: Callable | None = None  # of name -> (n,) values [SI]; None: it is the coordinate

    @property
    def is_coordinate(self):
        """Whether it is one of the coordinates."""
        return self.function is None

    @property
    def is_log(self):
        """Whether `value` is a logarithm."""
        return self.is_coordinate and parameter(self.name).is_log

    def values(self, points):
        """(n,) the quantity at points (n, k): its coordinate, with logarithms; else in SI."""
        if self.function is None:
            return points[:, self.eliminated]
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self.function(self.forward.values(points))

    def value(self, point):
        """The quantity at a point (k,), as of `values`."""
        return float(self.values(point[None])[0])

    def gradient(self, point):
        """(k,) derivatives of `value` by the coordinates."""
        if self.is_coordinate:
            return np.eye(len(self.names))[self.eliminated]
        above, below = self.forward.neighbours(point)
        return (self.values(above) - self.values(below)) / np.diag(above - below)

    def constrained(self, point, value):
        """A copy of the point (k,), its eliminated coordinate set so that this is the value.

        NaN where only a negative value of what moves as its logarithm would do.
        """
        point, i = point.copy(), self.eliminated
        if self.is_coordinate:
            point[i] = value
            return point
        is_log = parameter(self.names[i]).is_log
        with np.errstate(invalid="ignore", divide="ignore"):
            for _ in range(NEWTON):
                change = (value - self.value(point)) / self.gradient(point)[i]
                # in the parameter itself, in which most quantities are linear
                point[i] += np.log1p(change) if is_log else change
        return point

    def si(self, value):
        """A value of the quantity in SI."""
        return to_value(self.name, value) if self.is_coordinate else value

    def standard_error(self, point, covariance):
        """Standard error of the value at a point (k,), from the covariance (k, k).

        NaN where rounding has made the covariance of what is hardly determined indefinite.
        """
        gradient = self.gradient(point)
        variance = float(gradient @ covariance @ gradient)
        return variance**0.5 if variance >= 0.0 else np.nan


def reported_quantities(problem):
    """tuple of `ReportedQuantity`: free parameters, mu0, the rate dependence if any of them has an
    effect on it, the trend.
    """
    names, law, forward = problem.unknowns.names, problem.law, problem.forward
    V0, V = float(problem.slider.V0), forward.V0
    friction = problem.slider.replace(damping=0.0).friction_law

    def mu0(values):
        return forward.mu0(values | {"V0": np.full_like(values["a"], V0)}, values["level"])

    def rate_dependence(values):
        """d mu_ss/d ln V at `V`; a - b, unless the law has more states or friction of its own."""
        linear = linearisation(friction, friction.coefficient_arrays(V, values))
        return values["a"] * (linear.direct - linear.evolution.sum(axis=-1))

    aside = (*starts_of(law), "lag", *LINEAR)
    moving = [name for name in names if name not in aside]

    def quantity(name, replaced, function=None):
        return ReportedQuantity(name, names, names.index(replaced), forward, function)

    sums = [quantity("mu0", "level", mu0)]
    own = {name: to_coordinate(name, getattr(problem.slider, name)) for name in moving}
    begin = np.array([own.get(name, 0.0) for name in names])
    for name in sorted(moving, key=lambda name: name != "b"):
        rate = quantity("a_minus_b", name, rate_dependence)
        if abs(rate.gradient(begin)[rate.eliminated]) > ROUNDING:
            sums.append(rate)
            break
    if "trend" in names:
        symbol = parameter("trend").reported_as.format(along=problem.record.trend)
        sums.append(quantity(symbol, "trend", operator.itemgetter("trend")))
    free = [name for name in names if parameter(name).group in ("slider", "record")]
    return (*(quantity(name, name) for name in free), *sums)


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
    """The `Inference` of a solution, without a posterior; `errors` is as of `fit`.

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
            profiles = compute_profiles(solution, quantities, errors == "profile", widened.roots)
            break
        except BetterPoint as better:
            if still_improving := attempt == REFITS:
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
    bound = solution.at_bound
    at_bound = np.array([q.is_coordinate and bound[q.eliminated] for q in quantities])
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
