"""Intervals from the likelihood itself, where it is not Gaussian.

A quantity's profile is the least chi-square of all fits in which the quantity is constrained to a
value, less that of the best fit: its deviance.  With a noise that is known it is 1 and 3.84 at the
ends of the 68 and 95 % intervals; the noise's uncertainty moves these outwards
(noise_uncertainty.py).  See Venzon & Moolgavkar (1988) doi:10.2307/2347496.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from ...kit.least_squares import minimum
from ..estimates import GAUSSIAN, ROOTS
from ..unknowns import parameter

#: root of the deviance where a profile may end, over that where its widest interval does
BEYOND = 1.03
#: root of the deviance from one point of a profile to the next; most points on one side
STRIDE, MOST = 1.02, 24
#: a last step, out of the interval, is too long if the root of the deviance grows by more than this
LEAP = 2.0
#: shortest step, as a part of the distance from the fit, where the deviance leaps or motion ends
LEAST = 0.02
#: fall of chi-square by which a point of the profile is better than the fit
BETTER = 0.05
#: on the side on which a parameter ceases to matter an interval is open if a value so far from
#: the estimate (as a logarithm) is still likely
FARTHEST = np.log(1000.0)
#: longest first step of a coordinate, as a part of the distance between its bounds
LONGEST = 0.03
#: weight of the penalty, over that of a deviance that rises by 1 within a step
WEIGHT = 4.0
#: fall of chi-square, by the linear model, at which a search ends
ENOUGH = 1e-3
#: relative difference of the deviance's root from a Gaussian's that counts as Gaussian
TOLERANCE = 0.1
#: distance from a bound, as a part of the distance between both bounds, that counts as none
BOUND = 1e-9
#: most rounds in which profiles that others contradict are computed again
ROUNDS = 2


class BetterPoint(Exception):
    """Raised with a point of a profile that fits better than the fit."""

    def __init__(self, point):
        super().__init__()
        self.point = point


class Profile(NamedTuple):
    """Values of a quantity in increasing order, the deviance at each, and how both sides end."""

    values: np.ndarray  # (n,) as `ReportedQuantity.value`
    deviance: np.ndarray  # (n,)
    points: np.ndarray  # (n, k) the best fits
    ends: tuple  # lower, upper: "closed", "open" or "edge" (no motion beyond)

    @property
    def root(self):
        """(n,) roots of the deviance, negative below the fit."""
        above = np.arange(self.values.size) >= np.argmin(self.deviance)
        return np.where(above, 1.0, -1.0) * np.sqrt(self.deviance)

    def interval(self, roots=GAUSSIAN):
        """(levels, sides) where the root passes these for the last time; inf where it never does.

        Where a side ends at an edge, beyond which there is no motion, so does the interval.
        """
        interval = np.empty(roots.shape)
        curve = PchipInterpolator(self.values, self.root) if self.values.size > 1 else None
        for side, (sign, last) in enumerate(((-1, 0), (1, -1))):
            for level, target in enumerate(roots[:, side]):
                if curve is not None and self.deviance[last] >= target**2:
                    crossings = curve.solve(sign * target, extrapolate=False)
                    interval[level, side] = crossings.max() if side else crossings.min()
                else:
                    is_open = self.ends[side] == "open"
                    interval[level, side] = sign * np.inf if is_open else self.values[last]
        return interval


def compute_profile(solution, quantity, fits=(), roots=GAUSSIAN, better=BETTER):
    """The `Profile` of a `ReportedQuantity` about a solution.

    fits : (point, deviance) of other fits to start from as well
    roots : (levels, sides) roots of the deviance at the ends of its intervals
    better : fall of chi-square by which a point is better

    Raises `BetterPoint` where a point of the profile fits better than the solution.
    """
    low, high = (
        _Side(solution, quantity, sign, BEYOND * root, fits, better)
        for sign, root in zip((-1.0, 1.0), roots[-1], strict=True)
    )
    ends = low.walk(), high.walk()
    both = ((low.values, high.values), (low.deviance, high.deviance), (low.points, high.points))
    values, deviance, points = (np.array([*below[:0:-1], *above]) for below, above in both)
    return Profile(values, deviance, points, ends)


class _Side:
    """One side of a profile, from the fit outwards."""

    def __init__(self, solution, quantity, sign, beyond, fits, better):
        self.solution, self.quantity, self.sign = solution, quantity, sign
        self.beyond, self.better = beyond, better
        along = solution.covariance @ quantity.gradient(solution.point)
        variance = float(quantity.gradient(solution.point) @ along)
        self.lead = sign * along / variance  # change of all coordinates per unit of the quantity
        _, low, high = solution.unknowns
        moved = np.maximum(np.abs(self.lead), 1e-300)
        self.shortest = LEAST**2 * variance**0.5
        self.step = min(STRIDE * variance**0.5, float((LONGEST * (high - low) / moved).min()))
        self._coordinate = quantity.name if quantity.function is None else ""
        self.values, self.deviance = [quantity.value(solution.point)], [0.0]
        self.points = [solution.point]
        valued = [(quantity.value(point), point, deviance) for point, deviance in fits]
        self.fits = [fit for fit in valued if sign * (fit[0] - self.values[0]) > 0.0]
        likely = [sign * value for value, _, deviance in self.fits if deviance < beyond**2]
        #: how far the farthest likely fit is
        self.far = max(likely, default=-np.inf)

    def walk(self):
        """Add the points of this side; how it ends."""
        for _ in range(MOST):
            if self._has_gone_far_enough(self.points[-1]):
                return "open"
            last = self.values[-1]
            fit = self._fit_near(last + self.sign * self.step)
            moved = self.sign * (fit[0] - last) if fit else 0.0
            root = np.sqrt(max(fit[2], 0.0)) if fit else np.inf
            is_leap = root > self.beyond and root - np.sqrt(self.deviance[-1]) > LEAP
            if is_leap or moved < LEAST * self.step:
                self.step *= 0.5
                if self.step < max(LEAST * abs(last - self.values[0]), self.shortest):
                    return "open" if fit and self._others_at_bounds(fit[1]) else "edge"
                continue
            self._add_point(*fit)
            if root > self.beyond and self.sign * fit[0] >= self.far:
                return "closed"
        return "open"

    def _fit_near(self, value):
        """Value, point and deviance of the best fit near a value; None where nothing moves."""
        ahead = self.points[-1] + self.lead * abs(value - self.values[-1])
        nearest = min(self.fits, key=lambda fit: abs(fit[0] - value), default=None)
        starts = [ahead] if nearest is None else [ahead, nearest[1]]
        return penalized_fit(self.solution, self.quantity, value, self.step, starts)

    def _has_gone_far_enough(self, point):
        """Whether the interval is open because this far out the quantity is still likely."""
        far = self.sign * (self.quantity.value(point) - self.values[0]) > FARTHEST
        if far and self.quantity.irrelevant == self.sign:
            return True
        sides = self.solution.unknowns.sides(point, BOUND)
        if sides.get(self._coordinate) == self.sign:
            return True
        return self.solution.problem.is_open_at_bounds and self._others_at_bounds(point)

    def _others_at_bounds(self, point):
        """Whether another coordinate has come to a bound at which it still matters."""
        sides = self.solution.unknowns.sides(point, BOUND)
        return any(
            side and parameter(name).irrelevant != side
            for name, side in sides.items()
            if name != self._coordinate
        )

    def _add_point(self, value, point, deviance):
        """Add a point, and choose the step to the next."""
        if deviance < -self.better:
            raise BetterPoint(point)
        moved = abs(value - self.values[-1])
        rise = np.sqrt(max(deviance, 0.0)) - np.sqrt(self.deviance[-1])
        self.lead = (point - self.points[-1]) / moved
        self.step = moved * min(max(STRIDE / max(rise, 1e-9), 0.1), 3.0)
        self.values.append(value)
        self.deviance.append(max(deviance, 0.0))
        self.points.append(point)


def penalized_fit(solution, quantity, value, step, starts):
    """Fit with a quantity held near a value: value reached, point (k,), deviance (< 0: better).

    A penalty holds it: with a strict constraint least squares would advance slowly along a curved
    valley.  Where the search ends, chi-square is the least for the quantity's value there.  None
    where no start moves through the whole record.
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
        white, _ = solution.noise.whiten(problem.t, problem.difference(starts).T)
        costs = np.sum(white**2, axis=0) + (weight * (quantity.values(starts) - value)) ** 2
        starts = starts[np.argsort(costs)]  # NaN last
    enough = max(ENOUGH, problem.enough)
    best = minimum(with_penalty, starts[0], low, high, problem.most // 8, enough)
    if best is None:
        return None
    reached = quantity.value(best.x)
    chi2 = 2.0 * best.cost - (weight * (reached - value)) ** 2
    return reached, best.x, chi2 - solution.chi2


def compute_profiles(solution, quantities, everything, roots=None, better=BETTER):
    """name -> `Profile` of the quantities whose likelihood is not Gaussian, or of all.

    roots : (quantities, levels, sides) of the deviance, at the ends of intervals; by default those
        of a noise that is known

    Where one quantity goes far, the others follow it: so each profile also starts from the fits
    of the others, and is computed again where those fit better than its own.  `BetterPoint` is
    raised where one fits better than the solution.
    """
    left_out = [False] * len(quantities) if everything else are_gaussian(solution, quantities)
    roots = [GAUSSIAN] * len(quantities) if roots is None else roots
    roots_of = {q.name: own for q, own in zip(quantities, roots, strict=True)}
    todo = [q for q, is_left_out in zip(quantities, left_out, strict=True) if not is_left_out]
    profiles: dict[str, Profile] = {}
    fits: list[tuple] = []  # (point, deviance) of all profiles
    for _ in range(ROUNDS):
        for quantity in todo:
            profile = profiles[quantity.name] = compute_profile(
                solution, quantity, fits, roots_of[quantity.name], better
            )
            fits += zip(profile.points, profile.deviance, strict=True)
        todo = [q for q in quantities if _contradicted(solution, q, profiles.get(q.name), fits)]
        if not todo:
            break
    return profiles


def are_gaussian(solution, quantities):
    """Whether the likelihood is Gaussian along each `ReportedQuantity`: list of bool.

    Two standard errors to both sides, along the direction in which the other coordinates follow
    the quantity, the deviance is compared with 4.  The fall that moving the others could still
    achieve is subtracted to second order.  All points are one batch of lanes.  False where one is
    out of bounds, or has no motion.
    """
    point, spread, problem = solution.point, solution.covariance, solution.problem
    along = [spread @ quantity.gradient(point) for quantity in quantities]
    errors = [quantity.standard_error(point, spread) for quantity in quantities]
    steps = [2.0 * u / error for u, error in zip(along, errors, strict=True)]
    points = np.array([point + sign * step for step in steps for sign in (-1.0, 1.0)])
    sound = ((points > problem.unknowns.low) & (points < problem.unknowns.high)).all(axis=1)
    points[~sound] = point
    residuals = problem.difference(points)
    sound &= np.isfinite(residuals).all(axis=1)
    residuals[~sound] = 0.0
    columns = np.column_stack([residuals.T, solution.jacobian])
    white, _ = solution.noise.whiten(problem.t, columns)
    whitened, jacobian = white[:, : len(points)], white[:, len(points) :]
    slopes = jacobian.T @ whitened
    gain = np.einsum("ip,ij,jp->p", slopes, spread, slopes)
    root = np.zeros(len(points))
    for i, (quantity, u, error) in enumerate(zip(quantities, along, errors, strict=True)):
        for p in (2 * i, 2 * i + 1):
            # without the part of the gain that would move the quantity itself
            gain_of_others = gain[p] - (u @ slopes[:, p] / error) ** 2
            deviance = whitened[:, p] @ whitened[:, p] - gain_of_others - solution.chi2
            moved = (quantity.value(points[p]) - quantity.value(point)) / error
            root[p] = np.sqrt(max(deviance, 0.0)) / max(abs(moved), 1e-9)
    close = sound & (np.abs(root - 1.0) < TOLERANCE)
    return [bool(both) for both in close.reshape(-1, 2).all(axis=1)]


def _contradicted(solution, quantity, profile, fits):
    """Whether some fit has a smaller deviance than the quantity's profile, or Gaussian, there."""
    values = np.array([quantity.value(point) for point, _ in fits])
    roots = np.sqrt([deviance for _, deviance in fits])
    likely = roots < BEYOND * ROOTS[-1]
    if profile is None:
        error = quantity.standard_error(solution.point, solution.covariance)
        claimed = np.abs(values - quantity.value(solution.point)) / error
    else:
        # beyond its ends a profile claims as much as at them
        claimed = np.abs(np.interp(values, profile.values, profile.root))
    return bool(np.any(likely & (roots < (1.0 - TOLERANCE) * claimed - TOLERANCE)))
