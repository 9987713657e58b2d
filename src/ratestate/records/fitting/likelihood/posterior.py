"""The posterior of a fit, and its evidence, by nested sampling with dynesty.

Level and trend enter the model linearly and are integrated out in closed form, with flat priors
without bounds; the noise stays at its estimate.  Speagle (2020) doi:10.1093/mnras/staa278.
"""

import math
import warnings
from typing import NamedTuple

import numpy as np

from ....dynamics.progress import bar
from ....errors import ParameterError
from ....model.quantities import readable
from ..result import LEVELS
from ..unknowns import PLAIN

LIVE, SEED = 400, 20190101
#: what ln(evidence) may still gain when sampling ends; most evaluations
GAIN, MOST = 0.05, 300_000
#: samples of equal weight that are kept; effective ones below which none is believed
KEPT, FEWEST = 2000, 200
#: how far a prior reaches, in half widths of the 95 % interval, and in a logarithm
REACH, FARTHEST = 4.0, math.log(100.0)
#: ln(likelihood) where a slider does not move through the record
NONE = -1e300


class Posterior(NamedTuple):
    """Samples of equal weight, and what tells whether they can be trusted."""

    names: tuple  # of the coordinates
    points: np.ndarray  # (KEPT, k), whole points: level and trend drawn as well
    prior: dict  # name -> (low, high) of the coordinate
    log_evidence: float
    log_evidence_error: float
    evaluations: int
    effective: float  # samples of the same worth, if independent
    efficiency: float  # part of the evaluations that became samples
    complete: bool

    @property
    def sound(self):
        return self.effective >= FEWEST

    def of(self, reported):
        """(KEPT,) samples of a `Reported`."""
        return np.array([reported.value(point) for point in self.points])

    def interval(self, reported):
        """(levels, sides) quantiles."""
        tails = 0.5 - 0.5 * np.array(LEVELS)
        return np.quantile(self.of(reported), np.stack([tails, 1.0 - tails], axis=1))

    def cut(self, reported):
        """-1, 1 or 0: the lower or upper end of the prior at which samples gather, if any."""
        if not reported.plain:
            return 0
        low, high = self.prior[reported.name]
        sample = (self.of(reported) - low) / (high - low)
        if np.mean(sample < 0.05) > 0.01:
            return -1
        return 1 if np.mean(sample > 0.95) > 0.01 else 0


def prior_of(solutions, reaches):
    """name -> (low, high): one box for all laws, so that their evidences compare.

    Parameters
    ----------
    solutions : sequence of Solution
    reaches : sequence of dict, name -> (lower, upper) end of the 95 % interval of a coordinate
    """
    box: dict[str, tuple[float, float]] = {}
    for solution, reach in zip(solutions, reaches, strict=True):
        unknowns = solution.unknowns
        errors = 1.96 * np.sqrt(np.diag(solution.covariance))
        for i, name in enumerate(unknowns.names):
            if name in ("level", "trend"):
                continue
            here = float(solution.point[i])
            lower, upper = reach.get(name, (here - errors[i], here + errors[i]))
            lower, upper = float(lower), float(upper)
            low, high = _ends(here, lower, upper, name in PLAIN)
            low, high = max(low, unknowns.low[i]), min(high, unknowns.high[i])
            known = box.get(name, (low, high))
            box[name] = (min(low, known[0]), max(high, known[1]))
    return box


def _ends(here, lower, upper, plain):
    """Ends of the prior of a coordinate, from its estimate and the ends of its 95 % interval.

    On an open side the estimate means nothing: a logarithm's prior then reaches from the other end.
    """
    far = math.inf if plain else FARTHEST
    below, above = REACH * (here - lower), REACH * (upper - here)
    if not plain and math.isinf(above) and math.isfinite(below):
        return lower - min(below, 1.0), lower + far
    if not plain and math.isinf(below) and math.isfinite(above):
        return upper - far, upper + min(above, 1.0)
    return here - min(below, far), here + min(above, far)


def prior_words(prior):
    """The prior of a box, in words."""
    sides = []
    for name, (low, high) in prior.items():
        if name in PLAIN:
            unit = " s" if name == "lag" else ""
            sides.append(f"in {name} from {low:.4g} to {high:.4g}{unit}")
        else:
            ends = (readable(name, math.exp(end)) for end in (low, high))
            sides.append(f"in ln {name} from {' to '.join(ends)}")
    return (
        f"flat {', '.join(sides)}; flat without bounds in level and trend; the noise is held at "
        f"its estimate; the same for all laws"
    )


def posterior(solution, prior, label):
    """The `Posterior` of a solution.

    Raises
    ------
    ParameterError
        dynesty is missing.
    """
    dynesty = _dynesty()
    moving = [i for i, name in enumerate(solution.unknowns.names) if name in prior]
    names = [solution.unknowns.names[i] for i in moving]
    low, high = np.array([prior[name] for name in names]).T
    marginal = Marginal(solution, moving)
    sampler = dynesty.NestedSampler(
        marginal,
        lambda cube: low + (high - low) * cube,
        len(names),
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
    found = sampler.results
    weights = found.importance_weights()
    rng = np.random.default_rng(SEED)
    ladder = (np.arange(KEPT) + rng.random()) / KEPT
    chosen = rng.permutation(np.searchsorted(np.cumsum(weights) / weights.sum(), ladder))
    points = np.zeros((KEPT, len(solution.point)))
    points[:, moving] = found.samples[chosen]
    points[:, marginal.linear] = marginal.drawn(found.blob[chosen], rng)
    return Posterior(
        solution.unknowns.names,
        points,
        {name: prior[name] for name in names},
        float(found.logz[-1]),
        math.sqrt(max(float(found.information[-1]), 0.0) / LIVE),
        marginal.evaluations,
        float(weights.sum() ** 2 / (weights @ weights)),
        len(weights) / marginal.evaluations,
        marginal.evaluations < MOST,
    )


class Marginal:
    """ln(likelihood) of the coordinates `moving`, with level and trend integrated out."""

    def __init__(self, solution, moving):
        self.problem, self.noise = solution.problem, solution.noise
        names = solution.unknowns.names
        self.size, self.moving = len(names), moving
        self.linear = [i for i in range(self.size) if i not in moving]
        self.evaluations = 0

    def __call__(self, coordinates):
        """ln(likelihood), and means and root of the covariance of level, trend."""
        self.evaluations += 1
        record, count = self.problem.record, len(self.linear)
        point = np.zeros((1, self.size))
        point[0, self.moving] = coordinates
        friction, along = self.problem.forward.parts(point)
        nothing = np.zeros(count + count * count)
        if not np.isfinite(friction).all():
            return NONE, nothing
        columns = np.column_stack(
            [record.friction - friction[0], np.ones(record.t.size), along[0]][: count + 1]
        )
        white, log_determinant = self.noise.whiten(record.t, columns)
        products = white.T @ white
        # covariance of level and trend given the rest, as root @ root.T
        root = np.linalg.inv(np.linalg.cholesky(products[1:, 1:])).T
        gained = root.T @ products[1:, 0]
        chi2 = products[0, 0] - gained @ gained
        free = record.t.size - count
        value = -0.5 * (chi2 + log_determinant + free * math.log(2.0 * math.pi))
        blob = np.concatenate([root @ gained, root.ravel()])
        return float(value + np.log(np.diag(root)).sum()), blob

    def drawn(self, blobs, rng):
        """(n, level and trend) draws given the coordinates."""
        count = len(self.linear)
        mean, root = blobs[:, :count], blobs[:, count:].reshape(-1, count, count)
        return mean + np.einsum("nij,nj->ni", root, rng.standard_normal(mean.shape))


def _dynesty():
    try:
        import dynesty
    except ImportError:
        raise ParameterError(
            "errors='posterior' needs dynesty, which is not installed; install "
            "'ratestate[posterior]', or use errors='profile'"
        ) from None
    return dynesty
