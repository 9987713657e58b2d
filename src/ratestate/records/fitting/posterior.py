"""The posterior of a fit, and its evidence, by nested sampling with dynesty.

Speagle (2020) doi:10.1093/mnras/staa278.
"""

import math
import warnings
from typing import NamedTuple

import numpy as np

from ...dynamics.progress import bar
from ...model.quantities import QUANTITIES
from ..messages import fitting as sentences
from .marginal import LogLikelihood
from .quantities import LEVELS
from .unknowns import LINEAR, parameter

LIVE, SEED = 400, 20190101
#: possible gain of ln(evidence) at which sampling ends; most evaluations
GAIN, MOST = 0.05, 300_000
#: number of samples of equal weight; fewest effective samples that are reliable
KEPT, FEWEST = 2000, 200
#: largest half width of a prior, in half widths of the 95 % interval, and of a logarithm
REACH, FARTHEST = 4.0, math.log(100.0)


class Posterior(NamedTuple):
    """Samples of equal weight, and measures of their reliability."""

    points: np.ndarray  # (KEPT, k), including level and trend
    prior: dict  # name -> (low, high) of the coordinate
    log_evidence: float
    log_evidence_error: float
    evaluations: int
    effective: float  # effective number of independent samples
    efficiency: float  # samples per evaluation

    @property
    def complete(self):
        """Whether sampling ended before `MOST` evaluations."""
        return self.evaluations < MOST

    @property
    def reliable(self):
        """Whether there are enough effective samples."""
        return self.effective >= FEWEST

    def interval(self, quantity):
        """Return quantiles (levels, sides) of the samples of a `ReportedQuantity`."""
        tails = 0.5 - 0.5 * np.array(LEVELS)
        ends = np.stack([tails, 1.0 - tails], axis=1)
        return np.quantile(quantity.values(self.points), ends)

    def truncated_side(self, quantity):
        """Return -1, 0 or 1: the end of a free parameter's prior where samples gather."""
        if not quantity.is_free:
            return 0
        low, high = self.prior[quantity.name]
        part = (quantity.values(self.points) - low) / (high - low)
        return -1 if np.mean(part < 0.05) > 0.01 else 1 if np.mean(part > 0.95) > 0.01 else 0


def common_prior(inferences):
    """Return name -> (low, high), one for all laws, so that evidences are comparable."""
    box: dict[str, tuple[float, float]] = {}
    for inference in inferences:
        solution, profiles = inference.solution, inference.profiles
        errors = 1.96 * solution.errors
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
    """Return the ends of a coordinate's prior, from its estimate and 95 % interval.

    If one side is open, the estimate is meaningless.  A logarithm's prior then extends from the
    closed end.
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
    """Return the `Posterior` of a solution.

    prior : name -> (low, high) of coordinates, as of `common_prior`; other names are ignored
    label : text of the progress bar
    """
    import dynesty

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
    points[:, likelihood.nonlinear] = results.samples[chosen]
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
