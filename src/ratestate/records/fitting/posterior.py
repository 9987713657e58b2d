"""The likelihood of a record as a function of its parameters, its posterior and evidence.

Friction is linear in level and trend, and their priors are flat without bounds, so that the
integral over them has a closed form.  The noise is held at its estimate.  The posterior is found by
nested sampling with dynesty: Speagle (2020) doi:10.1093/mnras/staa278.
"""

import math
import warnings
from typing import NamedTuple

import numpy as np

from ...dynamics.progress import bar
from ...model.conversion import in_si
from ...model.names import keywords_checked
from ...model.quantities import QUANTITIES
from ..messages import fitting as sentences
from .problem import SamplesProblem
from .quantities import LEVELS
from .settings import checked_settings
from .solutions import solutions_of
from .unknowns import LINEAR, parameter, to_coordinate, unknowns_of

#: ln(likelihood) if a slider does not move through the whole record
NO_MOTION = -1e300
LIVE, SEED = 400, 20190101
#: possible gain of ln(evidence) at which sampling ends; most evaluations
GAIN, MOST = 0.05, 300_000
#: number of samples of equal weight; fewest effective samples that are reliable
KEPT, FEWEST = 2000, 200
#: largest half width of a prior, in half widths of the 95 % interval, and of a logarithm
REACH, FARTHEST = 4.0, math.log(100.0)


@keywords_checked
def log_likelihood(
    record, slider, free=("a", "b", "Dc", "K"), *, loading=None, trend="slip", noise=None
):
    """Return ln(likelihood) of a record as a function of the free parameters.

    The function is for your own sampler or optimiser.  The record must begin in steady sliding.
    Its level of friction and its trend are integrated out, with flat priors without bounds.  So the
    maximum is at the estimates of `fit`, but its value differs from ``log_likelihood`` of that
    result.

    Parameters
    ----------
    record : xarray.Dataset
        As for `fit`.
    slider : SpringSlider
        The law, the parameters that are not free, and an initial guess of the free ones.
    free : sequence of str
        The free parameters, in the order in which the function takes them.
    loading : Loading, optional
        As for `fit`.
    trend : {"slip", "time", None}
        As for `fit`.
    noise : float or dict, optional
        As for `fit`.  By default it is held at the estimate of a fit.

    Returns
    -------
    LogLikelihood
        A function of a point: values (k,) [SI], in the order of `free` without mu0.  It returns a
        float, or -inf if no slider with these values moves through the whole record, or if a value
        is not finite or cannot be a parameter.  Its attribute ``names`` holds the order.  The
        function can be pickled.

    Raises
    ------
    ParameterError
        As `fit` does.  Also if the function gets anything but one number for each name.

    Examples
    --------
    >>> import numpy as np, ratestate as rs
    >>> slider = rs.SpringSlider(a=0.01, b=0.012, Dc="10 um", sigma="5 MPa", K="5 GPa/m")
    >>> step = rs.Loading.steps("1 um/s", (100.0, "10 um/s"))
    >>> run = rs.simulate(slider, step, 140.0, times=np.linspace(0, 140, 1401))
    >>> noise = 1e-4 * np.random.default_rng(1).normal(size=1401)
    >>> record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    >>> function = rs.log_likelihood(record, slider, ("Dc", "a"))
    >>> function([10e-6, 0.01]) > function([20e-6, 0.01])
    True
    """
    free = (free,) if isinstance(free, str) else tuple(free)
    choices = {"against": "time", "start": "steady", "errors": "covariance"}
    settings = checked_settings(slider, free=free, law=None, noise=noise, trend=trend, **choices)
    (solution,) = solutions_of(in_si(record), settings, loading)
    names = [name for name in free if name != "mu0"]
    samples, slider = solution.problem.record, solution.problem.slider
    unknowns = unknowns_of(samples, slider, names, start=False)
    problem = SamplesProblem(samples, slider, unknowns, solution.problem.systematic)
    return LogLikelihood(problem, solution.noise)


class LogLikelihood:
    """ln(likelihood) as a function of all coordinates but level and trend."""

    def __init__(self, problem, noise):
        self.problem, self.noise = problem, noise
        names = problem.unknowns.names
        self.nonlinear = [i for i, name in enumerate(names) if name not in LINEAR]
        self.linear = [i for i, name in enumerate(names) if name in LINEAR]
        self.names = tuple(names[i] for i in self.nonlinear)
        self.evaluations = 0

    def __call__(self, values):
        """Return ln(likelihood) at values (k,) [SI] of `names`; -inf without a motion."""
        try:
            point = np.asarray(values, float)
        except (TypeError, ValueError):
            point = np.empty(0)
        if point.shape != (len(self.names),):
            raise sentences.refusal(
                "settings.point", names=", ".join(self.names), count=len(self.names), values=values
            )
        with np.errstate(divide="ignore", invalid="ignore"):
            pairs = list(zip(self.names, point, strict=True))
            coordinates = np.array([to_coordinate(name, value) for name, value in pairs])
        least = [parameter(name).least for name in self.names]
        if not np.isfinite(coordinates).all() or (coordinates < least).any():
            return -math.inf
        value, _ = self.at(coordinates)
        return value if value > NO_MOTION else -math.inf

    def at(self, coordinates):
        """Return ln(likelihood), mean and root of level and trend; `NO_MOTION` and 0."""
        self.evaluations += 1
        record, count = self.problem.record, len(self.linear)
        point = np.zeros((1, len(self.problem.unknowns.names)))
        point[0, self.nonlinear] = coordinates
        friction, regressors = self.problem.forward.friction_and_regressors(point)
        if not np.isfinite(friction).all():
            return NO_MOTION, np.zeros(count + count * count)
        lines = [regressor[0] for regressor in regressors.values()]
        columns = np.column_stack([record.friction - friction[0], *lines])
        white, log_determinant = self.problem.whiten(columns, self.noise)
        products = white.T @ white
        # covariance of level and trend given the rest, as root @ root.T
        root = np.linalg.inv(np.linalg.cholesky(products[1:, 1:])).T
        gained = root.T @ products[1:, 0]
        chi2 = products[0, 0] - gained @ gained
        free = record.t.size - count
        value = -0.5 * (chi2 + log_determinant + free * math.log(2.0 * math.pi))
        blob = np.concatenate([root @ gained, root.ravel()])
        return float(value + np.log(np.diag(root)).sum()), blob


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
            least, most = box.get(name, (lower, upper))
            box[name] = (min(lower, least), max(upper, most))
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
    # level and trend are drawn given the other coordinates
    count = len(likelihood.linear)
    mean, root = np.split(results.blob[chosen], [count], axis=1)
    drawn = np.einsum("nij,nj->ni", root.reshape(-1, count, count), rng.standard_normal(mean.shape))
    points[:, likelihood.linear] = mean + drawn
    return Posterior(
        points,
        prior,
        float(results.logz[-1]),
        math.sqrt(max(float(results.information[-1]), 0.0) / LIVE),
        likelihood.evaluations,
        float(weights.sum() ** 2 / (weights @ weights)),
        len(weights) / likelihood.evaluations,
    )
