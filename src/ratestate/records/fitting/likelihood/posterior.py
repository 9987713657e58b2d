"""The posterior of a fit, and its evidence, by nested sampling with dynesty.

Speagle (2020) doi:10.1093/mnras/staa278.
"""

import math
import warnings
from typing import NamedTuple

import numpy as np

from ....dynamics.progress import bar
from ....model.quantities import QUANTITIES
from ...messages import fitting as sentences
from ..estimates import LEVELS
from ..unknowns import LINEAR, parameter
from .marginal import LogLikelihood

LIVE, SEED = 400, 20190101
#: gain of ln(evidence) still possible when sampling ends; most evaluations
GAIN, MOST = 0.05, 300_000
#: samples of equal weight that are kept; effective samples below which they are not reliable
KEPT, FEWEST = 2000, 200
#: how far a prior reaches, in half widths of the 95 % interval, and in a logarithm
REACH, FARTHEST = 4.0, math.log(100.0)


class Posterior(NamedTuple):
    """Samples of equal weight, and measures of how reliable they are."""

    points: np.ndarray  # (KEPT, k), whole points: level and trend drawn as well
    prior: dict  # name -> (low, high) of the coordinate
    log_evidence: float
    log_evidence_error: float
    evaluations: int
    effective: float  # number of independent samples that would be worth as much
    efficiency: float  # samples over evaluations

    @property
    def complete(self):
        """Whether sampling ended by itself, and not at `MOST` evaluations."""
        return self.evaluations < MOST

    @property
    def reliable(self):
        """Whether the samples are worth `FEWEST` independent ones or more."""
        return self.effective >= FEWEST

    def interval(self, quantity):
        """(levels, sides) quantiles of the samples of a `ReportedQuantity`."""
        tails = 0.5 - 0.5 * np.array(LEVELS)
        ends = np.stack([tails, 1.0 - tails], axis=1)
        return np.quantile(quantity.values(self.points), ends)

    def truncated_side(self, quantity):
        """-1 or 1 if samples gather at the lower or upper end of the prior, else 0; 0 of a sum."""
        if not quantity.is_free:
            return 0
        low, high = self.prior[quantity.name]
        part = (quantity.values(self.points) - low) / (high - low)
        return -1 if np.mean(part < 0.05) > 0.01 else 1 if np.mean(part > 0.95) > 0.01 else 0


def common_prior(inferences):
    """name -> (low, high): one box for all laws, so that their evidences can be compared."""
    box: dict[str, tuple[float, float]] = {}
    for inference in inferences:
        solution, profiles = inference.solution, inference.profiles
        errors = 1.96 * np.sqrt(np.diag(solution.covariance))
        for name, low, high, estimate, error in zip(
            *solution.unknowns, solution.point.tolist(), errors.tolist(), strict=True
        ):
            if name in LINEAR:
                continue
            ends = estimate - error, estimate + error
            if name in profiles:
                ends = profiles[name].interval()[-1].tolist()
            lower, upper = np.clip(_prior_ends(name, estimate, *ends), low, high).tolist()
            others = box.get(name, (lower, upper))
            box[name] = (min(lower, others[0]), max(upper, others[1]))
    return box


def _prior_ends(name, estimate, lower, upper):
    """Ends of the prior of a coordinate, from its estimate and the ends of its 95 % interval.

    On an open side the estimate means nothing: a logarithm's prior then reaches from the other end.
    """
    is_log = parameter(name).is_log
    far = FARTHEST if is_log else math.inf
    below, above = REACH * (estimate - lower), REACH * (upper - estimate)
    if is_log and math.isinf(above) and math.isfinite(below):
        return lower - min(below, 1.0), lower + far
    if is_log and math.isinf(below) and math.isfinite(above):
        return upper - far, upper + min(above, 1.0)
    return estimate - min(below, far), estimate + min(above, far)


def prior_text(prior):
    """A sentence that describes the prior."""
    sides = []
    for name, (low, high) in prior.items():
        row = parameter(name)
        if row.is_log:
            sides.append(sentences("prior.log", name=name, low=math.exp(low), high=math.exp(high)))
        else:
            unit = "1" if row.group == "start" else QUANTITIES[name].unit
            unit = "" if unit == "1" else f" {unit}"
            sides.append(sentences("prior.plain", name=name, low=low, high=high, unit=unit))
    return sentences("prior.all", sides=", ".join(sides), linear=" and ".join(LINEAR))


def sample_posterior(solution, prior, label):
    """The `Posterior` of a solution, by nested sampling; ParameterError without dynesty.

    prior : name -> (low, high) of coordinates, as of `common_prior`; others are ignored
    label : of the progress bar
    """
    try:
        import dynesty
    except ImportError:
        raise sentences.refusal("search.no_dynesty") from None
    likelihood = LogLikelihood(solution.problem, solution.noise)
    prior = {name: prior[name] for name in likelihood.names if name in prior}
    low, high = np.array(list(prior.values())).T
    sampler = dynesty.NestedSampler(
        likelihood.at,
        lambda cube: low + (high - low) * cube,
        len(prior),
        nlive=LIVE,
        bound="multi",
        sample="unif",
        rstate=np.random.default_rng(SEED),
        blob=True,
    )
    with bar(label) as progress, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "The sampling was stopped short", UserWarning)
        for step, state in enumerate(
            sampler.sample(dlogz=GAIN, maxcall=MOST, add_live=False, save_bounds=False)
        ):
            if progress and math.isfinite(state.delta_logz):
                progress(step / (step + LIVE * state.delta_logz))
        for _ in sampler.add_live_points():
            pass
    results = sampler.results
    weights = results.importance_weights()
    rng = np.random.default_rng(SEED)
    ladder = (np.arange(KEPT) + rng.random()) / KEPT
    chosen = rng.permutation(np.searchsorted(np.cumsum(weights) / weights.sum(), ladder))
    points = np.zeros((KEPT, len(solution.point)))
    points[:, likelihood.moving] = results.samples[chosen]
    points[:, likelihood.linear] = likelihood.draw_linear(results.blob[chosen], rng)
    return Posterior(
        points,
        prior,
        float(results.logz[-1]),
        math.sqrt(max(float(results.information[-1]), 0.0) / LIVE),
        likelihood.evaluations,
        float(weights.sum() ** 2 / (weights @ weights)),
        len(weights) / likelihood.evaluations,
    )
