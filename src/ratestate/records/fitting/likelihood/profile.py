"""Intervals from the likelihood itself, where it is not Gaussian.

A quantity's profile is the least chi-square of all fits in which the quantity is constrained to a
value, less that of the best fit: its deviance.  With a noise that is known it is 1 and 3.84 at the
ends of the 68 and 95 % intervals; the noise's uncertainty moves these outwards
(noise_uncertainty.py).  See Venzon & Moolgavkar (1988) doi:10.2307/2347496.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from ..estimates import GAUSSIAN
from ..unknowns import parameter
from .constrained import constrained_fit

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
