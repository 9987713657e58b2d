"""A least-squares problem: residuals of a record under a law, bounds, and points to start from.

The friction of a velocity step fixes the sizes of all parameters to an order of magnitude or two.
Within those a seeded cloud of sliders is marched at once; the least squares start from the best of
them and the user's own.
"""

import numpy as np

from ..kit.least_squares import minimum
from ..kit.noise import Noise
from .forward import Forward
from .unknowns import distinct, parameter, sizes_of, to_coordinate

#: sliders in the cloud, and the samples of the record that they are compared with
CLOUD, SAMPLES = 96, 500
SEED = 20190101
#: least distance of two starts in some coordinate, ln 2
DISTANCE = 0.7


class LeastSquares:
    """Residuals of what was observed as functions of the unknowns, and their derivatives."""

    #: what was observed: "samples" or "cycles"
    kind = "samples"
    #: most evaluations of a search, and fall of chi-square, by the linear model, at which it ends
    most, enough = 200, 0.0
    #: whether values are meaningless beyond the bounds of coordinates, so that intervals are open
    is_open_at_bounds = False

    def __init__(self, slider, forward, unknowns, t, observed):
        self.slider, self.forward, self.unknowns = slider, forward, unknowns
        self.t, self.observed, self.law = t, observed, slider.friction_law

    def difference(self, points):
        """(n, m) model at points (n, k) less what was observed; NaN where there is no motion."""
        return self.forward.friction(points) - self.observed

    def whitened(self, point, noise):
        """Whitened difference (m,), NaN without a motion, and jacobian (m, k), 0 without one."""
        friction, jacobian = self.forward.jacobian(point)
        columns = np.column_stack([friction - self.observed, np.nan_to_num(jacobian)])
        white, _ = noise.whiten(self.t, columns)
        return white[:, 0], white[:, 1:]


class Problem(LeastSquares):
    """The `LeastSquares` of a record's samples.

    slider : gives the law, and what is not among the unknowns
    """

    def __init__(self, record, slider, unknowns):
        forward = Forward(record, slider, unknowns.names)
        super().__init__(slider, forward, unknowns, record.t, record.friction)
        self.record = record

    def __reduce__(self):  # (the law of a moving slider may be made at run time)
        return Problem, (self.record, self.slider, self.unknowns)

    def distances(self):
        """Coordinates (list of int) of the free distances over which states evolve.

        In the order of the slider's values, the longest last.
        """
        free = [D for D in dict.fromkeys(self.law.lengths) if D in self.unknowns.names]
        by_length = sorted(free, key=lambda D: getattr(self.slider, D))
        return [self.unknowns.names.index(D) for D in by_length]

    def white_noise(self, point):
        """White `Noise` of the residuals' size at a point, 1e-15 or more; NaN without a motion."""
        return Noise(max(float(np.sqrt(np.mean(self.difference(point[None]) ** 2))), 1e-15))


def search(problem, start, noise, most=None):
    """The `Minimum` from this point (moved within bounds); None where there is no motion.

    problem : a `LeastSquares`
    """
    _, low, high = problem.unknowns
    most = problem.most if most is None else most
    return minimum(lambda x: problem.whitened(x, noise), start, low, high, most, problem.enough)


def starting_points(problem, most):
    """(n, k) points to start from, n <= most, all distinct, the best first; n = 0 if none moves."""
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
    # states that evolve alike could change places, and mean the same
    cloud[:, problem.distances()] = np.sort(cloud[:, problem.distances()], axis=1)
    cloud = np.clip(cloud, unknowns.low, unknowns.high)
    cloud, misfit = with_best_level(problem, cloud if distance else cloud[:1])
    points = cloud[np.argsort(misfit, kind="stable")[: int(np.isfinite(misfit).sum())]]
    return points[distinct(points[:, [*distance]], [*distance.values()], most)]


def with_best_level(problem, points):
    """Points (n, k) with the best level and trend, and their misfits (n,); inf without a motion."""
    points, record, names = points.copy(), problem.record, problem.unknowns.names
    linear = [names.index(name) for name in record.regressors()]
    points[:, linear] = 0.0
    columns = np.array([*record.regressors().values()]).T.copy()
    scale = np.abs(columns).max(axis=0)
    residuals = (record.friction - problem.forward.friction(points)).T
    sound = np.isfinite(residuals).all(axis=0)
    best = np.linalg.lstsq(columns / scale, residuals[:, sound], rcond=None)[0]
    points[np.ix_(sound, linear)] = (best / scale[:, None]).T
    misfits = np.full(len(points), np.inf)
    misfits[sound] = ((residuals[:, sound] - columns / scale @ best) ** 2).sum(axis=0)
    return points, misfits
