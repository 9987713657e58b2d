"""What least squares minimise: residuals of a record under a law, and their derivatives."""

import numpy as np
from scipy.optimize import least_squares

from .forward import Forward
from .noise import Noise

#: most evaluations of one least-squares fit
MOST = 200


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

    def with_best_level(self, points):
        """Points with the level and trend that fit the record best, and their misfits."""
        points = points.copy()
        names = self.unknowns.names
        linear = [names.index(name) for name in ("level", "trend") if name in names]
        points[:, linear] = 0.0
        columns = np.ones((self.record.t.size, len(linear)))
        columns[:, 1:] = self.record.trend_variable[:, None]
        scale = np.abs(columns).max(axis=0)
        residuals = (self.record.friction - self.forward.friction(points)).T
        sound = np.isfinite(residuals).all(axis=0)
        best = np.linalg.lstsq(columns / scale, residuals[:, sound], rcond=None)[0]
        points[np.ix_(sound, linear)] = (best / scale[:, None]).T
        misfits = np.full(len(points), np.inf)
        misfits[sound] = ((residuals[:, sound] - columns / scale @ best) ** 2).sum(axis=0)
        return points, misfits

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
