"""A record under a law as a least-squares problem: samples, residuals and starting points.

The friction of a velocity step gives all parameters to an order of magnitude or two.  Sliders
are drawn at random within these ranges and computed in one march.  Least squares start from the
best of them.
"""

from typing import NamedTuple

import numpy as np

from ...model.loading import Loading
from ..kit.least_squares import minimum
from ..kit.noise import Noise
from ..load_point.stress_steps import VARIABLE
from ..messages import fitting as sentences
from ..raw_record import loading_of, raw_record, recorded_segments
from .forward import Forward
from .unknowns import distinct, parameter, sizes_of, to_coordinate

#: most samples: a march stores all of them for up to some thirty sliders at once
MOST = 200_000
#: fewest samples before the first step, and after the last
FEWEST = 8
#: sliders drawn at random, and samples of the record with which they are compared
CLOUD, SAMPLES = 96, 500
SEED = 20190101
#: least distance of two starts in at least one coordinate, ln 2
DISTANCE = 0.7


class Samples(NamedTuple):
    """The samples that are fitted.  Times count from the record's first sample.

    The measured displacement is replaced by the `loading` alone: constant speeds between steps.
    """

    t: np.ndarray  # (m,) [s], increasing
    friction: np.ndarray  # (m,)
    trend_variable: np.ndarray  # (m,) factor of the trend: time [s] or load-point displacement [m]
    trend: str | None  # "slip", "time" or None
    loading: Loading
    kind: str  # of friction: "tau" is tau/sigma of the spring, "mu" that of the interface
    time: np.ndarray  # (m,) recorded time [s]
    step_errors: np.ndarray  # standard errors [s] of `loading.t[1:]`; 0 in a given loading

    def regressors(self, along=None):
        """Return name -> derivative of friction by each of its linear parameters.

        along : (..., m) slip or time, by default `trend_variable`
        """
        along = self.trend_variable if along is None else along
        level = {"level": np.broadcast_to(1.0, along.shape)}
        return level | {"trend": along} if self.trend else level

    @property
    def level(self):
        """Friction before the first change of speed or normal stress."""
        return float(np.median(self.friction[before_first_change(self.loading, self.t)]))

    @property
    def scale(self):
        """Range of friction."""
        return float(np.ptp(self.friction))

    @property
    def spacing(self):
        """Median time between samples [s]."""
        return float(np.median(np.diff(self.t)))

    def thinned(self, stride):
        """Return the `Samples` with every stride-th sample and all samples near steps."""
        keep = np.zeros(self.t.size, bool)
        keep[::stride] = True
        for step in change_times(self.loading):
            at = np.searchsorted(self.t, step)
            keep[max(at - 5, 0) : at + 40] = True
        columns = ("t", "friction", "trend_variable", "time")
        return self._replace(**{name: getattr(self, name)[keep] for name in columns})


def samples_of(data, slider, *, loading, trend, against):
    """Return the `Samples` in a Dataset of `read_lab` or `simulate`."""
    raw = raw_record(data, slider)
    if raw.friction.size > MOST:
        every = -(-raw.friction.size // MOST)
        raise sentences.refusal("record.many", samples=raw.friction.size, most=MOST, every=every)
    if not np.ptp(raw.friction) > 1e-9 * np.abs(raw.friction).max():
        first = raw.friction[0]
        raise sentences.refusal("record.constant", friction=first, samples=raw.friction.size)
    segments = recorded_segments(raw.data, raw.time) if loading is None else None
    loading = loading_of(raw, loading, slider.sigma, segments)
    step_errors = segments.t_error[1:] if segments else np.zeros(loading.t.size - 1)
    t, order = raw.t, np.arange(raw.t.size)
    if against == "displacement":
        t, order = _times_at_displacements(raw.displacement, loading, t)
    _check_steps(loading, t)
    along = t if trend == "time" else np.asarray(loading.delta_lp(t))
    friction, time = raw.friction[order], raw.time[order]
    return Samples(t, friction, along, trend, loading, raw.kind, time, step_errors)


def change_times(loading):
    """Return times [s] > 0 of changes of speed, or of normal stress by over 1 %."""
    if (stress := loading.normal_stress) is None:
        return loading.t[1:]
    moves = np.abs(stress.end - stress.start) > VARIABLE * stress.start
    jumps = np.abs(stress.start[1:] - stress.end[:-1]) > VARIABLE * stress.start[1:]
    return np.union1d(loading.t[1:], stress.t[1:][jumps | moves[1:] | moves[:-1]])


def before_first_change(loading, t):
    """Return which times (m,) precede the first change; all, if under `FEWEST`."""
    events = change_times(loading)
    early = t < (events[0] if events.size else np.inf)
    return early if early.sum() >= FEWEST else np.ones(t.size, bool)


def _check_steps(loading, t):
    if loading.normal_stress is not None or (loading.t.size < 2 and loading.rate[0]):
        return
    if loading.t.size < 2:
        raise sentences.refusal("load_point.no_step", V=float(loading.V[0]))
    before = int(np.searchsorted(t, loading.t[1]))
    after = t.size - int(np.searchsorted(t, loading.t[-1]))
    if min(before, after) < FEWEST:
        side = "before the first" if before < after else "after the last"
        samples = min(before, after)
        raise sentences.refusal("load_point.few_beside", samples=samples, side=side, fewest=FEWEST)


def _times_at_displacements(displacement, loading, t):
    """Return sorted times at which the load point passed displacements, and rows."""
    if displacement is None:
        raise sentences.refusal("load_point.no_displacement")
    if not np.all(loading.V > 0.0) or np.any(loading.rate):
        raise sentences.refusal("load_point.holds")
    advance = displacement - np.median(displacement - loading.delta_lp(t))
    breaks = loading.delta_lp(loading.t)
    segment = np.clip(np.searchsorted(breaks, advance, side="right") - 1, 0, None)
    times = loading.t[segment] + (advance - breaks[segment]) / loading.V[segment]
    order = np.argsort(times, kind="stable")
    return np.maximum(times[order], 0.0), order


class LeastSquares:
    """Residuals of observed values as functions of the unknowns, with derivatives."""

    #: observed values: "samples" or "cycles"
    kind = "samples"
    #: most evaluations of a search; expected fall of chi-square below which it ends
    most, enough = 200, 0.0
    #: whether an interval is open if another coordinate has reached its bound
    is_open_at_bounds = False
    #: (m, r) systematic errors (systematic.py) at the estimate, or None
    systematic: np.ndarray | None = None

    def __init__(self, slider, forward, unknowns, t, observed):
        self.slider, self.forward, self.unknowns = slider, forward, unknowns
        self.t, self.observed, self.law = t, observed, slider.friction_law

    def difference(self, points):
        """Return model less observed (n, m) at points (n, k); NaN without a motion."""
        return self.forward.friction(points) - self.observed

    def linearised(self, point):
        """Return difference (m,) and jacobian (m, k) side by side; NaN, 0 without a motion."""
        friction, jacobian = self.forward.jacobian(point)
        return np.column_stack([friction - self.observed, np.nan_to_num(jacobian)])

    def whiten(self, columns, noise):
        """Whiten columns (m, k) by noise and systematic errors; return ln det(cov) too."""
        if self.systematic is None:
            return noise.whiten(self.t, columns)
        k = self.systematic.shape[1]
        white, log_determinant = noise.whiten(self.t, np.column_stack([self.systematic, columns]))
        basis, size, _ = np.linalg.svd(white[:, :k], full_matrices=False)
        part = (1.0 - 1.0 / np.sqrt(1.0 + size**2))[:, None] * (basis.T @ white[:, k:])
        return white[:, k:] - basis @ part, log_determinant + float(np.log1p(size**2).sum())

    def whitened(self, point, noise):
        """Return whitened difference (m,) and jacobian (m, k); NaN, 0 without a motion."""
        white, _ = self.whiten(self.linearised(point), noise)
        return white[:, 0], white[:, 1:]


class SamplesProblem(LeastSquares):
    """The `LeastSquares` of a record's samples.

    slider : gives the law, and the parameters that are not free
    """

    def __init__(self, record, slider, unknowns, systematic=None):
        forward = Forward(record, slider, unknowns.names)
        super().__init__(slider, forward, unknowns, record.t, record.friction)
        self.record, self.systematic = record, systematic

    def __reduce__(self):  # forward.moving_law, made at run time, cannot be pickled
        return SamplesProblem, (self.record, self.slider, self.unknowns, self.systematic)

    def distances(self):
        """Return coordinates (list of int) of free distances, by the slider's values."""
        free = [D for D in dict.fromkeys(self.law.lengths) if D in self.unknowns.names]
        by_length = sorted(free, key=lambda D: getattr(self.slider, D))
        return [self.unknowns.names.index(D) for D in by_length]

    def white_noise(self, point):
        """Return white `Noise` as large as residuals at a point; NaN without a motion."""
        return Noise(max(float(np.sqrt(np.mean(self.difference(point[None]) ** 2))), 1e-15))


def search(problem, start, noise, most=None):
    """Return the `Minimum` of a `LeastSquares` from a point; None without a motion."""
    _, low, high = problem.unknowns
    most = problem.most if most is None else most
    return minimum(lambda x: problem.whitened(x, noise), start, low, high, most, problem.enough)


def starting_points(problem, most):
    """Return distinct points (n, k), n <= most, best first; n = 0 without a motion."""
    unknowns, sizes = problem.unknowns, sizes_of(problem.record, problem.slider)
    rng = np.random.default_rng(SEED)
    cloud = np.zeros((CLOUD + 1, len(unknowns.names)))
    distance = {}  # coordinate -> least distance of two starts
    for i, name in enumerate(unknowns.names):
        row, size = parameter(name), sizes[name]
        if row.starts:
            low, high = row.starts
            drawn = rng.uniform(low, high, size=CLOUD + 1)
            cloud[:, i] = np.log(size * 10.0**drawn) if row.is_log else size * drawn
            cloud[0, i] = to_coordinate(name, getattr(problem.slider, name))
            distance[i] = DISTANCE * (1.0 if row.is_log else size)
    # exchanging two states that evolve alike gives the same friction: keep one order
    cloud[:, problem.distances()] = np.sort(cloud[:, problem.distances()], axis=1)
    cloud = np.clip(cloud, unknowns.low, unknowns.high)
    cloud, misfit = with_best_level(problem, cloud if distance else cloud[:1])
    points = cloud[np.argsort(misfit, kind="stable")[: int(np.isfinite(misfit).sum())]]
    return points[distinct(points[:, [*distance]], [*distance.values()], most)]


def with_best_level(problem, points):
    """Return points (n, k) with best level and trend; misfits (n,), inf if no motion."""
    points, record, names = points.copy(), problem.record, problem.unknowns.names
    linear = [names.index(name) for name in record.regressors()]
    points[:, linear] = 0.0
    columns = np.array([*record.regressors().values()]).T.copy()
    scale = np.abs(columns).max(axis=0)
    residuals = (record.friction - problem.forward.friction(points)).T
    moves = np.isfinite(residuals).all(axis=0)
    best = np.linalg.lstsq(columns / scale, residuals[:, moves], rcond=None)[0]
    points[np.ix_(moves, linear)] = (best / scale[:, None]).T
    misfits = np.full(len(points), np.inf)
    misfits[moves] = ((residuals[:, moves] - columns / scale @ best) ** 2).sum(axis=0)
    return points, misfits
