"""A least-squares problem: residuals of a record under a law, bounds, and points to start from.

The friction of a velocity step fixes the sizes of all parameters to an order of magnitude or two.
Within those a seeded cloud of sliders is marched at once; the least squares start from the best of
them and the user's own.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from .forward import Forward
from .noise import Noise
from .unknowns import START, Unknowns, distinct, to_coordinate

#: most evaluations of one least-squares fit
MOST = 200
#: sliders in the cloud, and the samples of the record that they are compared with
CLOUD, SAMPLES = 96, 500
SEED = 20190101
#: ln of the ratio of speeds that a hold counts as
HOLD = 5.0
#: least distance of two starts in some coordinate, ln 2
DISTANCE = 0.7


class Reach(NamedTuple):
    """How far from the size of a parameter, as a factor of it, its search and starts reach."""

    low: float
    high: float
    starts: tuple[float, float]  # in powers of ten; b, which may be negative, in its size itself


REACH = {
    "a": Reach(1e-3, 1e2, (-0.5, 0.5)),
    "b": Reach(-1e2, 1e2, (-1.0, 3.0)),
    "Dc": Reach(1e-3, 1e3, (-1.5, 0.7)),
    "K": Reach(1e-4, 1e6, (-0.5, 1.5)),
    "M": Reach(1e-8, 1e4, (-3.0, 1.0)),
}


class Problem:
    """Residuals of a record under a law as functions of the unknowns, and their derivatives."""

    def __init__(self, record, slider, law, unknowns):
        self.record, self.unknowns = record, unknowns
        self.forward = Forward(record, slider, law, unknowns.names)

    def difference(self, point):
        """(m,) model less record; NaN where there is no motion."""
        return self.forward.friction(point[None])[0] - self.record.friction

    def residual(self, point, noise):
        """(m,) `difference`, whitened."""
        return noise.whiten(self.record.t, self.difference(point))[0][:, 0]

    def jacobian(self, point, noise):
        """(m, k) derivative of `residual`; 0 where it does not exist."""
        columns = self.forward.jacobian(point)[1]
        return np.nan_to_num(noise.whiten(self.record.t, columns)[0])

    def white_noise(self, point):
        """White noise of the size of the residuals at a point."""
        return Noise(max(float(np.sqrt(np.mean(self.difference(point) ** 2))), 1e-15))


def search(problem, start, noise, most=MOST):
    """`scipy.optimize.least_squares` of a problem from this point; None where nothing moves there.

    problem : has unknowns, and residual and jacobian as functions of a point and a `Noise`
    """
    low, high = problem.unknowns.low, problem.unknowns.high
    inside = 1e-9 * np.where(np.isfinite(high), 1.0 + np.abs(start), 0.0)
    start = np.clip(start, low + inside, high - inside)
    if not np.isfinite(problem.residual(start, noise)).all():
        return None
    return least_squares(
        problem.residual,
        start,
        problem.jacobian,
        bounds=(low, high),
        x_scale="jac",
        args=(noise,),
        max_nfev=most,
    )


def unknowns_of(record, free, *, start, sigma):
    """`Unknowns` of a record: free parameters, the start if that is free, level, trend."""
    sizes = _sizes(record, sigma)
    late = 0.1 * record.t[-1]
    bounds = {"lag": (-late, late), **dict.fromkeys(START, (-20.0, 20.0))}
    for name, (low, high, _) in REACH.items():
        bounds[name] = tuple(to_coordinate(name, end * sizes[name]) for end in (low, high))
    names = (*free, *(START if start else ()), "level", *(("trend",) if record.trend else ()))
    low, high = np.array([bounds.get(name, (-np.inf, np.inf)) for name in names]).T
    return Unknowns(names, low, high)


def starting_points(problem, slider, most):
    """Points (k,) to start from, all distinct, the best fit to a thinned record first."""
    unknowns, record = problem.unknowns, problem.record
    sizes = _sizes(record, slider.sigma)
    rng = np.random.default_rng(SEED)
    cloud = np.zeros((CLOUD + 1, len(unknowns.names)))
    sized = [i for i, name in enumerate(unknowns.names) if name in sizes]
    for i in sized:
        name = unknowns.names[i]
        drawn = rng.uniform(*REACH[name].starts, size=CLOUD + 1)
        cloud[:, i] = sizes[name] * drawn if name == "b" else np.log(sizes[name] * 10.0**drawn)
        cloud[0, i] = to_coordinate(name, getattr(slider, name))
    cloud = np.clip(cloud, unknowns.low, unknowns.high)
    cloud, misfit = _with_best_level(problem, cloud if sized else cloud[:1])
    points = cloud[np.argsort(misfit, kind="stable")[: int(np.isfinite(misfit).sum())]]
    # distances in b, the only one that is no logarithm, are over its size
    distance = [DISTANCE * (sizes["b"] if unknowns.names[i] == "b" else 1.0) for i in sized]
    return points[distinct(points[:, sized], distance, most)]


def _with_best_level(problem, points):
    """Points with the level and trend that fit the record best, and their misfits."""
    points, record, names = points.copy(), problem.record, problem.unknowns.names
    linear = [names.index(name) for name in ("level", "trend") if name in names]
    points[:, linear] = 0.0
    columns = np.ones((record.t.size, len(linear)))
    columns[:, 1:] = record.trend_variable[:, None]
    scale = np.abs(columns).max(axis=0)
    residuals = (record.friction - problem.forward.friction(points)).T
    sound = np.isfinite(residuals).all(axis=0)
    best = np.linalg.lstsq(columns / scale, residuals[:, sound], rcond=None)[0]
    points[np.ix_(sound, linear)] = (best / scale[:, None]).T
    misfits = np.full(len(points), np.inf)
    misfits[sound] = ((residuals[:, sound] - columns / scale @ best) ** 2).sum(axis=0)
    return points, misfits


def _sizes(record, sigma):
    """symbol -> order of magnitude that the record suggests [SI]."""
    speeds = record.loading.V[record.loading.V > 0.0]
    ratio = max(float(np.abs(np.log(speeds / record.loading.V[0])).max()), 1.0)
    if speeds.size < record.loading.V.size:  # in a hold the slider slows by orders of magnitude
        ratio = max(ratio, HOLD)
    scale = record.scale / ratio
    t, slow = record.t, float(speeds.min())
    distance = float(record.loading.delta_lp(t[-1:])[0] - record.loading.delta_lp(t[:1])[0])
    distance = max(distance, 10.0 * slow * record.spacing)
    K = 10.0 * sigma * record.scale / distance
    return {"a": scale, "b": scale, "Dc": 0.05 * distance, "K": K, "M": K * (t[-1] / 50.0) ** 2}
