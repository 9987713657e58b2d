"""Intervals from profiles of the likelihood, if the likelihood is not Gaussian.

A quantity's profile is its deviance as a function of its value.  The deviance is the least
chi-square of all fits in which the quantity has that value, less chi-square of the best fit.
With known noise it is 1 and 3.84 at the ends of the 68 and 95 % intervals.  The uncertainty of
the noise moves the ends outwards (noise_uncertainty.py).  See Venzon & Moolgavkar (1988)
doi:10.2307/2347496.
"""

from typing import NamedTuple

import numpy as np
import scipy

from ..kit.least_squares import minimum
from .quantities import GAUSSIAN, ROOTS
from .unknowns import parameter

#: root of the deviance at which a profile may end, divided by that of its widest interval
BEYOND = 1.03
#: increase of the root of the deviance between points of a profile; most points on one side
STRIDE, MOST = 1.02, 24
#: largest increase of the root of the deviance in the step that leaves the interval
LEAP = 2.0
#: shortest step, as a fraction of the distance from the fit
LEAST = 0.02
#: fall of chi-square by which a point of the profile counts as better than the fit
LEAST_GAIN = 0.05
#: distance of a likely value, as a logarithm, from which an interval is open on the side on which
#: the parameter has no effect
FARTHEST = np.log(1000.0)
#: longest first step of a coordinate, as a fraction of its range
LONGEST = 0.03
#: weight of the penalty, relative to a deviance that rises by 1 within a step
WEIGHT = 4.0
#: expected fall of chi-square below which a search ends
ENOUGH = 1e-3
#: relative difference from a Gaussian's root of the deviance that is allowed
TOLERANCE = 0.1
#: distance from a bound, as a fraction of the range, below which a point is at the bound
BOUND = 1e-9
#: most rounds of computing profiles again that other profiles contradict
ROUNDS = 2


class BetterPoint(Exception):
    """Raised with a point of a profile that fits better than the fit."""


class Profile(NamedTuple):
    """Values of a quantity in increasing order, with the deviance at each."""

    values: np.ndarray  # (n,) as `ReportedQuantity.value`
    deviance: np.ndarray  # (n,)
    points: np.ndarray  # (n, k) the best fits
    ends: tuple  # of both sides: "closed", "open" or "edge" (no motion beyond)

    @property
    def root(self):
        """Roots (n,) of the deviance, negative below the fit."""
        above = np.arange(self.values.size) >= np.argmin(self.deviance)
        return np.where(above, 1.0, -1.0) * np.sqrt(self.deviance)

    def interval(self, roots=GAUSSIAN):
        """Return the outermost values (levels, sides) with these roots of the deviance.

        An end is infinite if the root stays smaller, or the last value if no motion is beyond it.
        """
        interval = np.empty(roots.shape)
        for side, (sign, last) in enumerate(((-1, 0), (1, -1))):
            for level, target in enumerate(roots[:, side]):
                if self.deviance[last] >= target**2:
                    curve = scipy.interpolate.PchipInterpolator(self.values, self.root)
                    crossings = curve.solve(sign * target, extrapolate=False)
                    interval[level, side] = crossings.max() if side else crossings.min()
                else:
                    is_open = self.ends[side] == "open"
                    interval[level, side] = sign * np.inf if is_open else self.values[last]
        return interval


def compute_profile(solution, quantity, fits=(), roots=GAUSSIAN, least_gain=LEAST_GAIN):
    """Return the `Profile` of a `ReportedQuantity` about a solution.

    fits : (point, deviance) of other fits, from which searches start as well
    roots : (levels, sides) roots of the deviance at the ends of intervals
    least_gain : fall of chi-square by which a point counts as better

    `BetterPoint` is raised if a point of the profile fits better than the solution.
    """
    low, high = (
        _Side(solution, quantity, sign, BEYOND * root, fits, least_gain)
        for sign, root in zip((-1.0, 1.0), roots[-1], strict=True)
    )
    ends = low.extend(), high.extend()
    pairs = ((low.values, high.values), (low.deviance, high.deviance), (low.points, high.points))
    values, deviance, points = (np.array([*below[:0:-1], *above]) for below, above in pairs)
    return Profile(values, deviance, points, ends)


class _Side:
    """One side of a profile, built from the fit outwards."""

    def __init__(self, solution, quantity, sign, beyond, fits, least_gain):
        self.solution, self.quantity, self.sign = solution, quantity, sign
        self.beyond, self.least_gain = beyond, least_gain
        error = quantity.standard_error(solution)
        along = solution.covariance_with(quantity)
        self.direction = sign * along / error**2  # d(coordinates)/d(quantity)
        _, low, high = solution.unknowns
        moved = np.maximum(np.abs(self.direction), 1e-300)
        self.shortest = LEAST**2 * error
        self.step = min(STRIDE * error, float((LONGEST * (high - low) / moved).min()))
        self.near_bound = BOUND * solution.unknowns.ranges
        self._coordinate = quantity.name if quantity.function is None else ""
        self.values, self.deviance = [quantity.value(solution.point)], [0.0]
        self.points = [solution.point]
        valued = [(quantity.value(point), point, deviance) for point, deviance in fits]
        self.fits = [fit for fit in valued if sign * (fit[0] - self.values[0]) > 0.0]
        likely = [sign * value for value, _, deviance in self.fits if deviance < beyond**2]
        self.farthest_likely = max(likely, default=-np.inf)

    def extend(self):
        """Add the points of this side; return how the side ends."""
        for _ in range(MOST):
            if self._is_open_at(self.points[-1]):
                return "open"
            last, value = self.values[-1], self.values[-1] + self.sign * self.step
            starts = [self.points[-1] + self.direction * abs(value - last)]
            if self.fits:
                starts.append(min(self.fits, key=lambda fit: abs(fit[0] - value))[1])
            fit = penalized_fit(self.solution, self.quantity, value, self.step, starts)
            moved = self.sign * (fit[0] - last) if fit else 0.0
            root = np.sqrt(max(fit[2], 0.0)) if fit else np.inf
            is_leap = root > self.beyond and root - np.sqrt(self.deviance[-1]) > LEAP
            if is_leap or moved < LEAST * self.step:
                self.step *= 0.5
                if self.step < max(LEAST * abs(last - self.values[0]), self.shortest):
                    at_bound = fit and (self._is_open_at(fit[1]) or self._others_at_bounds(fit[1]))
                    return "open" if at_bound else "edge"
                continue
            self._add_point(*fit)
            if root > self.beyond and self.sign * fit[0] >= self.farthest_likely:
                return "closed"
        return "open"

    def _is_open_at(self, point):
        """Return whether the interval is open, because this far value is still likely."""
        far = self.sign * (self.quantity.value(point) - self.values[0]) > FARTHEST
        if far and self.quantity.no_effect == self.sign:
            return True
        sides = self.solution.unknowns.sides(point, self.near_bound)
        if sides.get(self._coordinate) == self.sign:
            return True
        return self.solution.problem.is_open_at_bounds and self._others_at_bounds(point)

    def _others_at_bounds(self, point):
        """Return whether another coordinate is at a bound and still has an effect."""
        sides = self.solution.unknowns.sides(point, self.near_bound)
        return any(
            side and parameter(name).no_effect != side
            for name, side in sides.items()
            if name != self._coordinate
        )

    def _add_point(self, value, point, deviance):
        """Add a point, and choose the step to the next point."""
        if deviance < -self.least_gain:
            raise BetterPoint(point)
        moved = abs(value - self.values[-1])
        rise = np.sqrt(max(deviance, 0.0)) - np.sqrt(self.deviance[-1])
        self.direction = (point - self.points[-1]) / moved
        self.step = moved * min(max(STRIDE / max(rise, 1e-9), 0.1), 3.0)
        self.values.append(value)
        self.deviance.append(max(deviance, 0.0))
        self.points.append(point)


def penalized_fit(solution, quantity, value, step, starts):
    """Return value, point (k,) and deviance of a fit with a quantity near a value.

    A penalty holds the quantity.  With a strict constraint least squares would advance slowly
    along a curved valley.  At the end of the search chi-square is the least for the value reached.
    None if the slider does not move through the whole record from the best start.
    """
    problem, weight = solution.problem, WEIGHT / step

    def with_penalty(point):
        residual, jacobian = problem.whitened(point, solution.noise)
        penalty = weight * (quantity.value(point) - value)
        return np.append(residual, penalty), np.vstack(
            [jacobian, weight * quantity.gradient(point)]
        )

    _, low, high = problem.unknowns
    starts = np.clip(starts, low, high)
    if len(starts) > 1:
        white, _ = problem.whiten(problem.difference(starts).T, solution.noise)
        costs = np.sum(white**2, axis=0) + (weight * (quantity.values(starts) - value)) ** 2
        starts = starts[np.argsort(costs)]  # NaN last
    enough = max(ENOUGH, problem.enough)
    best = minimum(with_penalty, starts[0], low, high, problem.most // 8, enough)
    if best is None:
        return None
    reached = quantity.value(best.x)
    chi2 = 2.0 * best.cost - (weight * (reached - value)) ** 2
    return reached, best.x, chi2 - solution.chi2


def compute_profiles(solution, quantities, all_quantities, roots, least_gain=LEAST_GAIN):
    """Return name -> `Profile` of quantities with a likelihood that is not Gaussian.

    all_quantities : whether to compute profiles of the other quantities as well
    roots : (quantities, levels, sides) of the deviance at the ends of intervals

    Where one quantity goes far, others may follow it.  So each profile also starts from the fits of
    other profiles, and is computed again if those fit better than its own.  `BetterPoint` is
    raised if a fit is better than the solution.
    """
    left_out = [False] * len(quantities) if all_quantities else are_gaussian(solution, quantities)
    roots_of = {q.name: own for q, own in zip(quantities, roots, strict=True)}
    todo = [q for q, is_left_out in zip(quantities, left_out, strict=True) if not is_left_out]
    profiles: dict[str, Profile] = {}
    fits: list[tuple] = []  # (point, deviance) of all profiles
    for _ in range(ROUNDS):
        for quantity in todo:
            profile = profiles[quantity.name] = compute_profile(
                solution, quantity, fits, roots_of[quantity.name], least_gain
            )
            fits += zip(profile.points, profile.deviance, strict=True)
        todo = [q for q in quantities if _is_contradicted(solution, q, profiles.get(q.name), fits)]
        if not todo:
            break
    return profiles


def are_gaussian(solution, quantities):
    """Return whether the likelihood is Gaussian along each `ReportedQuantity` (list).

    The deviance is compared with 4 at two standard errors on both sides, along the direction in
    which the other coordinates follow the quantity.  The fall that other coordinates could still
    achieve is subtracted to second order.  All points are computed in one march.  A quantity counts
    as not Gaussian if one of its points is out of bounds or has no motion.
    """
    point, problem = solution.point, solution.problem
    errors = np.array([quantity.standard_error(solution) for quantity in quantities])
    along = np.array([solution.covariance_with(q) for q in quantities]) / errors[:, None]
    points = np.concatenate([point - 2.0 * along, point + 2.0 * along])
    is_valid = ((points > problem.unknowns.low) & (points < problem.unknowns.high)).all(axis=1)
    points[~is_valid] = point
    residuals = problem.difference(points)
    is_valid &= np.isfinite(residuals).all(axis=1)
    residuals[~is_valid] = 0.0
    columns = np.column_stack([residuals.T, solution.jacobian])
    white, _ = problem.whiten(columns, solution.noise)
    whitened, jacobian = white[:, : len(points)], white[:, len(points) :]
    slopes = jacobian.T @ whitened
    # leave out the part of the gain that would move the quantity itself
    of_itself = np.sum(np.concatenate([along, along]).T * slopes, axis=0)
    gain_of_others = np.sum((solution.root.T @ slopes) ** 2, axis=0) - of_itself**2
    deviance = np.sum(whitened**2, axis=0) - gain_of_others - solution.chi2
    three = [
        q.values(np.stack([point, *points[i :: len(errors)]])) for i, q in enumerate(quantities)
    ]
    start, *ends = np.array(three).T
    moved = np.abs((ends - start) / errors).ravel()
    root = np.sqrt(np.maximum(deviance, 0.0)) / np.maximum(moved, 1e-9)
    close = is_valid & (np.abs(root - 1.0) < TOLERANCE)
    return close.reshape(2, -1).all(axis=0).tolist()


def _is_contradicted(solution, quantity, profile, fits):
    """Return whether a fit has a smaller deviance than the profile, or a Gaussian."""
    values = np.array([quantity.value(point) for point, _ in fits])
    roots = np.sqrt([deviance for _, deviance in fits])
    likely = roots < BEYOND * ROOTS[-1]
    if profile is None:
        error = quantity.standard_error(solution)
        claimed = np.abs(values - quantity.value(solution.point)) / error
    else:
        # beyond its ends, a profile counts as constant
        claimed = np.abs(np.interp(values, profile.values, profile.root))
    return bool(np.any(likely & (roots < (1.0 - TOLERANCE) * claimed - TOLERANCE)))
