"""Intervals from the likelihood itself, where it is not Gaussian.

A quantity's profile is the least chi-square of all fits in which the quantity is constrained to a
value, less that of the best fit: its deviance.  With a noise that is known it is 1 and 3.84 at the
ends of the 68 and 95 % intervals; the noise's uncertainty moves these outwards
(noise_uncertainty.py).  See Venzon & Moolgavkar (1988) doi:10.2307/2347496.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from ..estimates import GAUSSIAN, ROOTS
from ..generalized_least_squares import SEARCH_EVALUATIONS
from ..problem import search
from ..unknowns import Unknowns, parameter, to_coordinate

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
#: longest first step, as a part of the distance between the bounds
LONGEST = 0.03
#: relative difference of the deviance's root from a Gaussian's that counts as Gaussian
TOLERANCE = 0.1
#: most rounds in which profiles that others contradict are computed again
ROUNDS = 3


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


def compute_profile(solution, quantity, fits=(), roots=GAUSSIAN):
    """The `Profile` of a `ReportedQuantity` about a solution.

    fits : (point, deviance) of other fits to start from as well
    roots : (levels, sides) roots of the deviance at the ends of its intervals

    Raises `BetterPoint` where a point of the profile fits better than the solution.
    """
    low, high = (
        _Side(solution, quantity, sign, BEYOND * root, fits)
        for sign, root in zip((-1.0, 1.0), roots[-1], strict=True)
    )
    ends = low.walk(), high.walk()

    both = ((low.values, high.values), (low.deviance, high.deviance), (low.points, high.points))
    values, deviance, points = (np.array([*below[:0:-1], *above]) for below, above in both)
    return Profile(values, deviance, points, ends)


class _Side:
    """One side of a profile, from the fit outwards."""

    def __init__(self, solution, quantity, sign, beyond, fits):
        self.solution, self.quantity, self.sign = solution, quantity, sign
        self.beyond = beyond
        gradient = quantity.gradient(solution.point)
        along = solution.covariance @ gradient
        variance = float(gradient @ along)
        self.error = float(np.sqrt(variance))
        self.lead = sign * along / variance  # change of all coordinates per unit of the quantity
        self.limit, self.step = sign * np.inf, STRIDE * self.error
        self.values, self.deviance = [quantity.value(solution.point)], [0.0]
        self.points = [solution.point]
        if quantity.is_coordinate:
            low, high = (float(end[quantity.eliminated]) for end in solution.unknowns[1:])
            self.limit = high if sign > 0 else low
            if parameter(quantity.name).irrelevant == sign:
                far = self.values[0] + sign * FARTHEST
                self.limit = sign * min(sign * self.limit, sign * far)
            if np.isfinite(high - low):
                self.step = min(self.step, LONGEST * (high - low))
        valued = [(quantity.value(point), point, deviance) for point, deviance in fits]
        self.fits = [fit for fit in valued if sign * (fit[0] - self.values[0]) > 0.0]
        likely = [fit[0] for fit in self.fits if fit[2] < beyond**2]
        #: the farthest value of a likely fit
        self.far = sign * max((sign * value for value in likely), default=-np.inf)

    def walk(self):
        """Add the points of this side; how it ends."""
        for _ in range(MOST):
            last = self.values[-1]
            if np.isfinite(self.limit) and abs(self.limit - last) <= 1e-9 * max(abs(last), 1e-9):
                return "open"
            value = self.sign * min(
                self.sign * (last + self.sign * self.step), self.sign * self.limit
            )
            moved = abs(value - last)
            fit = constrained_fit(self.solution, self.quantity, value, self._starts(value, moved))
            root = np.sqrt(max(fit[1], 0.0)) if fit else np.inf
            if root > self.beyond and root - np.sqrt(self.deviance[-1]) > LEAP:
                self.step = 0.5 * moved
                if self.step < LEAST * max(abs(last - self.values[0]), LEAST * self.error):
                    return "open" if fit and self._at_a_bound(fit[0]) else "edge"
                continue
            self._add_point(value, *fit)
            if self.deviance[-1] > self.beyond**2 and self.sign * (value - self.far) >= 0.0:
                return "closed"
        return "open"

    def _at_a_bound(self, point):
        """Whether another coordinate is at a bound: then the search ends, not the motion."""
        sides = self.solution.unknowns.sides(point)
        own = self.quantity.names[self.quantity.eliminated]
        return any(s and n != own and parameter(n).irrelevant != s for n, s in sides.items())

    def _starts(self, value, moved):
        """Points to start from: ahead of the last point, and the nearest other fit."""
        ahead = self.points[-1] + self.lead * moved
        nearest = min(self.fits, key=lambda fit: abs(fit[0] - value), default=None)
        return [ahead, self.points[-1]] if nearest is None else [ahead, nearest[1]]

    def _add_point(self, value, point, deviance):
        """Add a point, and choose the step to the next."""
        if deviance < -BETTER:
            raise BetterPoint(point)
        moved = abs(value - self.values[-1])
        rise = np.sqrt(max(deviance, 0.0)) - np.sqrt(self.deviance[-1])
        self.lead = (point - self.points[-1]) / moved
        self.step = moved * min(max(STRIDE / max(rise, 1e-9), 0.1), 3.0)
        self.values.append(value)
        self.deviance.append(max(deviance, 0.0))
        self.points.append(point)


class ConstrainedProblem:
    """A `Problem` with a `ReportedQuantity` constrained: one coordinate is eliminated by it."""

    def __init__(self, problem, quantity, value):
        self.problem, self.quantity, self.value = problem, quantity, value
        names, low, high = problem.unknowns
        name = names[quantity.eliminated]
        #: where Newton's method for the eliminated coordinate starts; not every law allows 0
        own = getattr(problem.slider, name) if parameter(name).group == "slider" else 0.0
        self.start = to_coordinate(name, own)
        rest = self.rest = [i for i in range(len(names)) if i != quantity.eliminated]
        self.unknowns = Unknowns(tuple(names[i] for i in rest), low[rest], high[rest])

    def point(self, rest):
        """The point (k,) with these values (k - 1,) of the others; NaN if only a < 0 would do."""
        point = np.insert(rest, self.quantity.eliminated, self.start)
        return self.quantity.constrained(point, self.value)

    def whitened(self, rest, noise):
        """As `Problem.whitened`, at the other coordinates (k - 1,) and by them."""
        point, eliminated = self.point(rest), self.quantity.eliminated
        residual, columns = self.problem.whitened(point, noise)
        gradient = self.quantity.gradient(point)
        by_rest = -gradient[self.rest] / gradient[eliminated]
        return residual, columns[:, self.rest] + np.outer(columns[:, eliminated], by_rest)


def constrained_fit(solution, quantity, value, starts):
    """Point (k,), and deviance (< 0: better), of the best fit in which a quantity has this value.

    None where no start moves through the whole record.
    """
    problem = ConstrainedProblem(solution.problem, quantity, value)
    fits = []
    for start in starts:
        rest = np.clip(start[problem.rest], problem.unknowns.low, problem.unknowns.high)
        if fit := search(problem, rest, solution.noise, SEARCH_EVALUATIONS):
            fits.append(fit)
    best = min(fits, key=lambda fit: fit.cost, default=None)
    return best and (problem.point(best.x), 2.0 * float(best.cost) - solution.chi2)


def compute_profiles(solution, quantities, everything, roots=None):
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
                solution, quantity, fits, roots_of[quantity.name]
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
    residuals = problem.forward.friction(points) - problem.record.friction
    sound &= np.isfinite(residuals).all(axis=1)
    residuals[~sound] = 0.0
    columns = np.column_stack([residuals.T, solution.jacobian])
    white, _ = solution.noise.whiten(problem.record.t, columns)
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
