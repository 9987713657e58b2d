"""The least-squares problem of a record under a law: residuals, bounds and starting points.

The friction of a velocity step gives all parameters to an order of magnitude or two.  Sliders
are drawn at random within these ranges and computed in one march.  Least squares start from the
best of them.
"""

import numpy as np

from ..kit.least_squares import minimum
from ..kit.noise import Noise
from .forward import Forward
from .unknowns import distinct, parameter, sizes_of, to_coordinate

#: sliders drawn at random, and samples of the record with which they are compared
CLOUD, SAMPLES = 96, 500
SEED = 20190101
#: least distance of two starts in at least one coordinate, ln 2
DISTANCE = 0.7


class LeastSquares:
    """Residuals of observed values as functions of the unknowns, with derivatives."""

    #: observed values: "samples" or "cycles"
    kind = "samples"
    #: most evaluations of a search; expected fall of chi-square below which it ends
    most, enough = 200, 0.0
    #: whether an interval is open if another coordinate has reached its bound
    is_open_at_bounds = False

    def __init__(self, slider, forward, unknowns, t, observed):
        self.slider, self.forward, self.unknowns = slider, forward, unknowns
        self.t, self.observed, self.law = t, observed, slider.friction_law

    def difference(self, points):
        """Return model less observed (n, m) at points (n, k); NaN without a motion."""
        return self.forward.friction(points) - self.observed

    def whitened(self, point, noise):
        """Return whitened difference (m,) and jacobian (m, k); NaN, 0 without a motion."""
        friction, jacobian = self.forward.jacobian(point)
        columns = np.column_stack([friction - self.observed, np.nan_to_num(jacobian)])
        white, _ = noise.whiten(self.t, columns)
        return white[:, 0], white[:, 1:]


class SamplesProblem(LeastSquares):
    """The `LeastSquares` of a record's samples.

    slider : gives the law, and the parameters that are not free
    """

    def __init__(self, record, slider, unknowns):
        forward = Forward(record, slider, unknowns.names)
        super().__init__(slider, forward, unknowns, record.t, record.friction)
        self.record = record

    def __reduce__(self):  # forward.moving_law, made at run time, cannot be pickled
        return SamplesProblem, (self.record, self.slider, self.unknowns)

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
