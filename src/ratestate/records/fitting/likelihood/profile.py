"""Intervals from the likelihood itself, where it is not Gaussian.

The profile of a number is the least chi-square of all fits in which the number keeps a value, over
that of the best fit: its deviance.  With the noise fixed it is 1 and 3.84 at the ends of the 68
and 95 % intervals.  See Venzon & Moolgavkar (1988) doi:10.2307/2347496.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from ..result import ROOTS
from ..unknowns import NEAR
from .held import best_with

#: root of the deviance where a profile may end
BEYOND = 1.03 * ROOTS[-1]
#: root of the deviance from one point of a profile to the next; most points on one side
STRIDE, MOST = 1.02, 24
#: the same, too much for a step that leads out of the interval
LEAP = 2.0
#: shortest step, in parts of the way from the fit, where the deviance leaps, or motion ends
LEAST = 0.02
#: fall of chi-square that makes a point of the profile better than the fit
BETTER = 0.05
#: sides on which a parameter ceases to matter; still likely so far from its estimate (as a
#: logarithm) it has no end there
ENDLESS, FARTHEST = (("K", 1.0), ("M", -1.0)), np.log(1000.0)
#: longest first step, in parts of the way between the bounds
LONGEST = 0.03


class Better(Exception):
    """A profile has found a point that fits better than the fit."""

    def __init__(self, point):
        super().__init__()
        self.point = point


class Profile(NamedTuple):
    """A number's values and the deviance there, in order, and how both sides end."""

    values: np.ndarray  # (n,) as `Reported.value`
    deviance: np.ndarray  # (n,)
    points: np.ndarray  # (n, k) the best fits
    ends: tuple  # lower, upper: "closed", "open" or "edge" (no motion beyond)

    @property
    def best(self):
        return int(np.argmin(self.deviance))

    @property
    def root(self):
        """(n,) roots of the deviance, negative below the fit."""
        side = np.where(np.arange(self.values.size) < self.best, -1.0, 1.0)
        return side * np.sqrt(self.deviance)

    def interval(self):
        """(levels, sides) where the root passes `ROOTS` for the last time; inf where it never does.

        A number that ends at an edge, beyond which there is no motion, has its interval end there.
        """
        found = np.empty((len(ROOTS), 2))
        curve = PchipInterpolator(self.values, self.root) if self.values.size > 1 else None
        for side, sign in enumerate((-1, 1)):
            last = self.values[0 if side == 0 else -1]
            reached = self.deviance[0 if side == 0 else -1]
            for level, target in enumerate(ROOTS):
                if curve is not None and reached >= target**2:
                    crossings = curve.solve(sign * target, extrapolate=False)
                    found[level, side] = crossings.max() if side else crossings.min()
                else:
                    found[level, side] = sign * np.inf if self.ends[side] == "open" else last
        return found


def profile(solution, reported, known=()):
    """The `Profile` of a `Reported` about a solution.

    Parameters
    ----------
    solution : Solution
    reported : Reported
    known : sequence of (point, deviance), fits from which to start as well

    Raises
    ------
    Better
        A point was found that fits better than the solution.
    """
    low, high = (_Side(solution, reported, sign, known).walk() for sign in (-1.0, 1.0))
    values, deviance, points = (
        np.array([*below[:0:-1], *above]) for below, above in zip(low[:3], high[:3], strict=True)
    )
    return Profile(values, deviance, points, (low[3], high[3]))


class _Side:
    """One side of a profile, from the fit outwards."""

    def __init__(self, solution, reported, sign, known):
        self.solution, self.reported, self.sign = solution, reported, sign
        gradient = reported.gradient(solution.point)
        along = solution.covariance @ gradient
        variance = float(gradient @ along)
        self.error = float(np.sqrt(variance))
        self.lead = sign * along / variance  # how the others follow, for each unit of the number
        self.limit, self.step = sign * np.inf, STRIDE * self.error
        self.values, self.deviance = [reported.value(solution.point)], [0.0]
        self.points = [solution.point]
        if reported.plain:
            low, high = (float(end[reported.given_up]) for end in solution.unknowns[1:])
            self.limit = high if sign > 0 else low
            if (reported.name, sign) in ENDLESS:
                far = self.values[0] + sign * FARTHEST
                self.limit = sign * min(sign * self.limit, sign * far)
            if np.isfinite(high - low):
                self.step = min(self.step, LONGEST * (high - low))
        fits = [(reported.value(point), point, deviance) for point, deviance in known]
        self.known = [fit for fit in fits if sign * (fit[0] - self.values[0]) > 0.0]
        likely = [fit[0] for fit in self.known if fit[2] < BEYOND**2]
        #: the likely values that are known reach as far as this
        self.far = sign * max((sign * value for value in likely), default=-np.inf)

    def walk(self):
        """Values, deviances, points and how the side ends."""
        return self.values, self.deviance, self.points, self._walked()

    def _walked(self):
        for _ in range(MOST):
            here = self.values[-1]
            if np.isfinite(self.limit) and abs(self.limit - here) <= 1e-9 * max(abs(here), 1e-9):
                return "open"
            value = self.sign * min(
                self.sign * (here + self.sign * self.step), self.sign * self.limit
            )
            moved = abs(value - here)
            found = best_with(self.solution, self.reported, value, self._starts(value, moved))
            root = np.sqrt(max(found[1], 0.0)) if found else np.inf
            if root > BEYOND and root - np.sqrt(self.deviance[-1]) > LEAP:
                self.step = 0.5 * moved
                if self.step < LEAST * max(abs(here - self.values[0]), LEAST * self.error):
                    return "open" if found and self._stopped(found[0]) else "edge"
                continue
            self._take(value, *found)
            if self.deviance[-1] > BEYOND**2 and self.sign * (value - self.far) >= 0.0:
                return "closed"
        return "open"

    def _stopped(self, point):
        """Whether another coordinate stands at a bound: the search, not the record, ends there."""
        names, low, high = self.solution.unknowns
        near = np.where(np.isfinite(high - low), NEAR * (high - low), 0.0)
        stopped = set(zip(names, np.where(point <= low + near, -1.0, 0.0), strict=True))
        stopped |= set(zip(names, np.where(point >= high - near, 1.0, 0.0), strict=True))
        own = self.reported.names[self.reported.given_up]
        return any(side and name != own and (name, side) not in ENDLESS for name, side in stopped)

    def _starts(self, value, moved):
        """Where least squares start: on from here, and from the nearest fit that is known."""
        ahead = self.points[-1] + self.lead * moved
        nearest = min(self.known, key=lambda fit: abs(fit[0] - value), default=None)
        return [ahead, self.points[-1]] if nearest is None else [ahead, nearest[1]]

    def _take(self, value, point, deviance):
        """One more point, and the step to the next."""
        if deviance < -BETTER:
            raise Better(point)
        moved = abs(value - self.values[-1])
        rise = np.sqrt(max(deviance, 0.0)) - np.sqrt(self.deviance[-1])
        self.lead = (point - self.points[-1]) / moved
        self.step = moved * min(max(STRIDE / max(rise, 1e-9), 0.1), 3.0)
        self.values.append(value)
        self.deviance.append(max(deviance, 0.0))
        self.points.append(point)
