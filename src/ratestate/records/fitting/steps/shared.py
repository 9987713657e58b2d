"""One set of parameters for several steps, and a test whether it serves.

The steps share the parameters of the law; stiffness, level, trend and start remain each step's own,
and so does its noise, at the estimate of its separate fit, but as much larger as its uncertainty
makes the variances of this step's estimates (likelihood/noise_uncertainty.py).  The joint least
squares are those of all whitened residuals.

The test is that of Welch (1951) doi:10.1093/biomet/38.3-4.330 for means of groups whose variances
are estimated, for k parameters as of Johansen (1980) doi:10.1093/biomet/67.1.85.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc

from ...kit.least_squares import minimum
from ..problem import Problem
from .fitted import shared_coordinates

#: most evaluations of the search
MOST = 60
#: least of the sum in `denominator`: above it chi-square and F are the same
LEAST = 1e-9


class Shared(NamedTuple):
    """The joint fit of n steps with k shared parameters."""

    names: tuple  # of the shared parameters
    point: np.ndarray  # (k,) their coordinates
    covariance: np.ndarray  # (k, k) of these
    deviance: float  # chi-square over the sum of those of the separate fits
    degrees: int  # by how many parameters it has less, k (n - 1)
    denominator: float  # degrees of freedom with which the variance is known

    @property
    def p_value(self):
        """Probability of such a deviance or a larger one, if one set serves all steps.

        It then has the mean `degrees`, and F the mean denominator/(denominator - 2).
        """
        mean = self.denominator / (self.denominator - 2.0)
        ratio = mean * max(self.deviance, 0.0) / self.degrees
        return float(fdtrc(self.degrees, self.denominator, ratio))


class _Step:
    """A step with its separate fit; its residuals by shared and own coordinates."""

    def __init__(self, fitted, law):
        settings, separate = fitted.task.settings, fitted.of(law)
        slider = settings.sliders[settings.laws.index(law)]
        self.problem = Problem(separate.record, slider, separate.unknowns)
        self.separate, names = separate, separate.unknowns.names
        self.shared = shared_coordinates(separate.unknowns, settings)
        self.names = tuple(names[i] for i in self.shared)
        larger, noise = math.sqrt(separate.inflation.factor), separate.noise
        self.noise = noise.times(larger)
        self.own = [i for i in range(len(names)) if i not in self.shared]

    def compressed(self, shared, own):
        """Residual (k + 1,) and jacobian (k + 1, k) with the normal equations of all samples.

        Columns of shared coordinates first.  NaN where there is no motion.
        """
        point = np.empty(len(self.shared) + len(self.own))
        point[self.shared], point[self.own] = shared, own
        record = self.problem.record
        friction, jacobian = self.problem.forward.jacobian(point)
        columns = np.column_stack([jacobian[:, self.shared + self.own], friction - record.friction])
        if not np.isfinite(columns).all():
            return np.full((point.size + 1, point.size + 1), np.nan)
        # of a QR decomposition, R has the same inner products as the columns
        return np.linalg.qr(self.noise.whiten(record.t, columns)[0], mode="r")


class _Joint:
    """Residuals of all steps by the shared coordinates, then those of each step, in order."""

    def __init__(self, steps):
        self.steps, self.k = steps, len(steps[0].shared)
        ends = self.k + np.cumsum([0] + [len(step.own) for step in steps])
        self.own = list(itertools.starmap(slice, itertools.pairwise(ends.tolist())))
        self.rows = np.cumsum([0] + [self.k + len(step.own) + 1 for step in steps])
        self.size = int(ends[-1])

    def at(self, point):
        """Residual (m,) and jacobian (m, n) at a point (n,); NaN and 0 without a motion."""
        residual, jacobian = np.empty(self.rows[-1]), np.zeros((self.rows[-1], self.size))
        for step, own, first, end in zip(
            self.steps, self.own, self.rows, self.rows[1:], strict=False
        ):
            columns = step.compressed(point[: self.k], point[own])
            jacobian[first:end, : self.k] = columns[:, : self.k]
            jacobian[first:end, own] = columns[:, self.k : -1]
            residual[first:end] = columns[:, -1]
        return residual, np.nan_to_num(jacobian)

    def information(self, jacobian):
        """(steps, k, k) information of each step on the shared coordinates."""
        of_steps = []
        for own, first, end in zip(self.own, self.rows, self.rows[1:], strict=False):
            shared, rest = jacobian[first:end, : self.k], jacobian[first:end, own]
            left = shared - rest @ np.linalg.lstsq(rest, shared)[0]
            of_steps.append(left.T @ left)
        return np.array(of_steps)

    def starts(self):
        """Points (n,), an iterator: at the medians of shared coordinates, then at each step's.

        With those of another some step may have no motion.
        """
        points = [step.separate.point for step in self.steps]
        yield self.collected(points, np.median)
        for i in range(len(points)):
            yield self.collected(points, lambda shared, axis, i=i: shared[i])

    def collected(self, values, of_shared):
        """(n,) coordinates, from those of each step; shared ones by a function of all."""
        each = list(zip(self.steps, values, strict=True))
        shared = of_shared([one[step.shared] for step, one in each], axis=0)
        return np.concatenate([shared, *(one[step.own] for step, one in each)])


def shared_fit(fits, law):
    """`Shared` of `Fitted` windows that are usable under a law.

    None for fewer than two, for nothing to share, and where the search has not converged.
    """
    steps = [_Step(fitted, law) for fitted in fits if fitted.usable(law)]
    if len(steps) < 2 or not steps[0].shared:
        return None
    joint, k = _Joint(steps), len(steps[0].shared)
    low = joint.collected([step.separate.unknowns.low for step in steps], np.min)
    high = joint.collected([step.separate.unknowns.high for step in steps], np.max)
    searches = (minimum(joint.at, start, low, high, MOST) for start in joint.starts())
    result = next((one for one in searches if one), None)
    if result is None or not result.converged:
        return None
    information = joint.information(result.jacobian)
    covariance = np.linalg.pinv(information.sum(axis=0), hermitian=True)
    parts = np.einsum("ij,nji->n", covariance, information) / k
    inflations = [step.separate.inflation for step in steps]
    chi2 = np.array([step.separate.chi2 for step in steps])
    separate = float(np.sum(chi2 / [one.factor for one in inflations]))
    deviance, degrees = 2.0 * result.cost - separate, k * (len(steps) - 1)
    below = denominator(k, parts, np.array([one.spread for one in inflations]))
    return Shared(steps[0].names, result.x[:k], covariance, deviance, degrees, below)


def denominator(k, parts, spreads):
    """Degrees of freedom, above 4, of F with the variance of the deviance of k parameters.

    parts : (n,) of each step in the information on the parameters, their sum 1
    spreads : (n,) relative variances of the variances of their estimates, as of `Inflation`
    """
    degrees = k * (parts.size - 1)
    more = k * (k + 2) * np.sum((1.0 - parts) ** 2 * spreads)
    return float(4.0 + 2.0 * degrees * (degrees + 2) / max(more, LEAST))
