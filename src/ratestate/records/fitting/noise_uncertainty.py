"""How the uncertainty of the noise widens errors and intervals.

If the noise is slower than the response to a step, few independent samples determine it.  An
interval that takes the estimated noise as exact is then too narrow.  Here the shape of the noise
is integrated over, with flat priors of its coordinates (noise.py).  For each shape
generalized least squares gives the estimates, to first order about the fit, and the weight is
the restricted likelihood.  White noise, noise with one relaxation, and noise with a power-law
spectrum have equal prior probabilities.  A quantity then has a mixture of Gaussians, and the
ends of its intervals are quantiles of the mixture.  The shapes form a grid along the principal
axes of the likelihood, as in Rue, Martino & Chopin (2009) doi:10.1111/j.1467-9868.2008.00700.x.
"""

from typing import NamedTuple

import numpy as np
import scipy

from ..kit.noise import RestrictedLikelihood, families, modes
from .quantities import GAUSSIAN, LEVELS
from .solutions import Solution, project_out

#: spacing of the grid, in standard deviations of the shape; its least and largest length
STEP, SHORTEST, LONGEST = 1.0, 0.1, 1.5
#: step of finite differences for the curvature at the mode
DIFFERENCE = 0.25
#: fall of ln(likelihood) from which a shape is neglected; most shapes
NEGLIGIBLE, MOST = 6.0, 150
#: bisections in the search for a quantile
HALVINGS = 60


class Widening(NamedTuple):
    """How the noise's uncertainty widens the errors of q quantities."""

    errors: np.ndarray  # (q,) standard errors divided by those with the estimated noise
    #: (q, levels, sides) distances of intervals' ends from estimates, divided likewise
    roots: np.ndarray

    @classmethod
    def none(cls, q):
        """Return the `Widening` by a known noise."""
        return cls(np.ones(q), np.broadcast_to(GAUSSIAN, (q, *GAUSSIAN.shape)))


class Inflation(NamedTuple):
    """Factor by which the noise's uncertainty enlarges a covariance of estimates."""

    factor: float = 1.0
    spread: float = 0.0  # relative variance of the factor between shapes of the noise


class LikelyNoise(NamedTuple):
    """Likely shapes of the noise, besides the noise of the fit."""

    solution: Solution  # the fit
    estimates: list  # `RestrictedLikelihood.shift_and_root` for each shape
    weight: np.ndarray  # of each shape; the sum is 1

    def widening(self, gradients):
        """Return the `Widening` of quantities with these gradients (q, k)."""
        shifts, shape_roots = map(np.array, zip(*self.estimates, strict=True))
        means = shifts @ gradients.T  # (shapes, q)
        spreads = np.linalg.norm(gradients @ shape_roots, axis=2)
        own = np.linalg.norm(gradients @ self.solution.root, axis=1)
        seen = (spreads > 0.0).all(axis=0) & (own > 0.0)
        means, spreads, own = means[:, seen], spreads[:, seen], own[seen]
        errors, roots = (part.copy() for part in Widening.none(len(gradients)))
        errors[seen] = np.sqrt(self.weight @ (spreads**2 + means**2)) / own
        both = np.stack([-means, means], axis=-1)[:, :, None]  # (shapes, q, 1, sides)
        parts = 0.5 + 0.5 * np.array(LEVELS)[:, None]
        ends = _quantile(self.weight, both, spreads[:, :, None, None], parts)
        # every interval contains the estimate
        roots[seen] = np.maximum(ends, 0.0) / own[:, None, None]
        return Widening(errors, roots)

    def inflation(self, coordinates):
        """Return the `Inflation` of some coordinates (list of int).

        For each shape of the noise, its factor is the mean square deviation from the truth, in
        standard errors of the fit, over all directions of these coordinates.
        """
        seen = np.flatnonzero(self.solution.jacobian.any(axis=0)).tolist()
        chosen = [i for i in coordinates if i in seen]
        if not chosen:
            return Inflation()
        columns = self.solution.jacobian[:, chosen + [i for i in seen if i not in chosen]]
        remainder = project_out(self.solution, columns, len(chosen))
        information, rows = remainder.T @ remainder, np.ix_(chosen, chosen)
        squares = [root @ root.T + np.outer(shift, shift) for shift, root in self.estimates]
        factors = np.array([np.sum(information * square[rows]) for square in squares])
        factors /= len(chosen)
        factor = float(self.weight @ factors)
        return Inflation(factor, float(self.weight @ (factors / factor - 1.0) ** 2))


def likely_noise(solution):
    """Return the `LikelyNoise` of a `Solution`; None if no shape is possible."""
    problem, residual = solution.problem, solution.residual
    more = problem.systematic, solution.noise.level
    likelihood = RestrictedLikelihood(problem.t, residual, solution.jacobian, *more)
    estimates, weight = likely_estimates(likelihood, solution.noise, solution.peaks)
    return LikelyNoise(solution, estimates, weight) if estimates else None


def likely_estimates(likelihood, near=None, peaks=None):
    """Return `shift_and_root` (list) for likely shapes of the noise, and weights (n,).

    near : as for `estimated_noise`
    peaks : the `modes` of each family, if they are known

    The weights add up to 1.  The list is empty if no shape is possible.
    """
    shapes, priors = [likelihood.at()], [1.0]
    kinds = families(likelihood)
    peaks = [modes(family, near) for family in kinds] if peaks is None else peaks
    for family, found in zip(kinds, peaks, strict=True):
        likely, part = _grid_shapes(family, found)
        shapes += likely
        priors += [part] * len(likely)
    log_weight = np.array([shape.log_likelihood for shape in shapes])
    if not np.isfinite(log_weight).any():
        return [], log_weight
    weight = np.array(priors) * np.exp(log_weight - log_weight.max())
    return [likelihood.shift_and_root(shape.factor) for shape in shapes], weight / weight.sum()


def _quantile(weight, means, spreads, part):
    """Return quantiles, at probabilities `part`, of mixtures of Gaussians, shapes first."""
    low = (means - 10.0 * spreads).min(axis=0)
    high = (means + 10.0 * spreads).max(axis=0)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        below = np.tensordot(weight, scipy.special.ndtr((middle - means) / spreads), axes=1) < part
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


def _grid_shapes(family, peaks):
    """Return `Conditional`s (list) for likely shapes of a grid about modes, and their prior."""
    low, high = family.bounds.T
    highest, best = max(peaks, key=lambda mode: mode[0])
    axes = _principal_axes(family, best)
    # grid points have integer coordinates along the axes, relative to the best mode
    seen: set[tuple] = set()
    likely = []
    first = [np.linalg.solve(axes, point - best).round().astype(int) for _, point in peaks]
    queue = [tuple(place.tolist()) for place in first]
    while queue and len(seen) < MOST:
        place = queue.pop(0)
        point = best + axes @ np.array(place, float)
        if place in seen or (point < low).any() or (point > high).any():
            continue
        conditional = family.at(point)
        seen.add(place)
        if conditional.log_likelihood > highest - NEGLIGIBLE:
            likely.append(conditional)
            i, j = place
            queue += [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)]
    return likely, abs(np.linalg.det(axes)) / np.prod(high - low)


def _principal_axes(family, point):
    """Return the grid's steps (2, 2), as columns: a deviation along each axis."""
    h = DIFFERENCE
    low, high = family.bounds.T
    corner = np.clip(point, low + h, high - h) - h
    around = [family.at(corner + h * np.array(z)).log_likelihood for z in np.ndindex(3, 3)]
    (ll, lc, lh), (cl, centre, ch), (hl, hc, hh) = -np.reshape(around, (3, 3))
    with np.errstate(invalid="ignore"):  # an impossible shape has -inf
        xx, yy, xy = lc + hc - 2.0 * centre, cl + ch - 2.0 * centre, 0.25 * (ll + hh - lh - hl)
    curvature = np.array([[xx, xy], [xy, yy]]) / h**2
    if not np.isfinite(curvature).all():
        return LONGEST * np.eye(2)
    values, vectors = np.linalg.eigh(curvature)
    spread = 1.0 / np.sqrt(np.clip(values, LONGEST**-2, SHORTEST**-2))
    return STEP * vectors * spread
