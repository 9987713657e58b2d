"""One set of parameters for several steps, and a test whether it serves.

The steps share the parameters of the law; stiffness, level, trend and start remain each step's own,
and so does its noise, at the estimate of its separate fit.  The joint least squares are those of
all whitened residuals.  Errors are as much wider as those of the separate fits are for the noise's
own uncertainty (likelihood/noise_uncertainty.py).
"""

import itertools
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from ..by_law import value_of
from ..levenberg_marquardt import minimum
from ..problem import Problem
from ..unknowns import parameter

#: parameters of the slider that are the machine's, not the law's
OF_MACHINE = ("K", "M", "lag")
#: most evaluations of the search
MOST = 60


class Shared(NamedTuple):
    """The joint fit of n steps with k shared parameters."""

    names: tuple  # of the shared parameters
    point: np.ndarray  # (k,) their coordinates
    covariance: np.ndarray  # (k, k) of these
    deviance: float  # chi-square over the sum of those of the separate fits
    inflation: float  # by how much the noise's own uncertainty raises this, as of variances
    degrees: int  # by how many parameters it has less, k (n - 1)

    @property
    def p_value(self):
        """Probability of such a deviance or a larger one, if one set serves all steps."""
        return float(chdtrc(self.degrees, max(self.deviance, 0.0) / self.inflation))


class _Step:
    """A step with its separate fit; its residuals by shared and own coordinates."""

    def __init__(self, fitted, law):
        settings, separate = fitted.task.settings, fitted.of(law)
        slider = settings.sliders[settings.laws.index(law)]
        self.problem = Problem(separate.record, slider, separate.unknowns)
        self.separate, names = separate, separate.unknowns.names
        self.names = tuple(n for n in names if n in settings.free and n not in OF_MACHINE)
        self.shared = [names.index(name) for name in self.names]
        self.own = [i for i in range(len(names)) if i not in self.shared]

    def widening(self):
        """(k,) errors of the separate fit over those with the noise as known; 1 of profiles."""
        part, known = self.separate.result, self.separate.errors[self.shared]
        reported = part["standard_error"].sel(parameter=list(self.names)).values
        values = np.array([value_of(part, name) for name in self.names])
        is_log = np.array([parameter(name).is_log for name in self.names])
        wider = np.where(is_log, reported / values, reported) / known
        return np.where(np.isfinite(wider), wider, 1.0)

    def compressed(self, shared, own):
        """Residual (k + 1,) and jacobian (k + 1, k) with the normal equations of all samples.

        Columns of shared coordinates first.  NaN where there is no motion.
        """
        point = np.empty(len(self.shared) + len(self.own))
        point[self.shared], point[self.own] = shared, own
        record, noise = self.problem.record, self.separate.noise
        friction, jacobian = self.problem.forward.jacobian(point)
        columns = np.column_stack([jacobian[:, self.shared + self.own], friction - record.friction])
        if not np.isfinite(columns).all():
            return np.full((point.size + 1, point.size + 1), np.nan)
        # of a QR decomposition, R has the same inner products as the columns
        return np.linalg.qr(noise.whiten(record.t, columns)[0], mode="r")


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

    def collected(self, values, of_shared):
        """(n,) coordinates, from those of each step; shared ones by a function of all."""
        each = list(zip(self.steps, values, strict=True))
        shared = of_shared([one[step.shared] for step, one in each], axis=0)
        return np.concatenate([shared, *(one[step.own] for step, one in each)])


def shared_fit(fits, law):
    """`Shared` of `Fitted` windows that have converged under a law.

    None for fewer than two, for nothing to share, and where the search has not converged.
    """
    steps = [_Step(fitted, law) for fitted in fits if fitted.converged(law)]
    if len(steps) < 2 or not steps[0].shared:
        return None
    joint, k = _Joint(steps), len(steps[0].shared)
    start = joint.collected([step.separate.point for step in steps], np.median)
    low = joint.collected([step.separate.unknowns.low for step in steps], np.min)
    high = joint.collected([step.separate.unknowns.high for step in steps], np.max)
    result = minimum(joint.at, start, low, high, MOST)
    if result is None or not result.converged:
        return None
    separate = sum(step.separate.chi2 for step in steps)
    covariance = np.linalg.pinv(result.jacobian.T @ result.jacobian, hermitian=True)[:k, :k]
    degrees = k * (len(steps) - 1)
    wider = np.sqrt(np.mean([step.widening() ** 2 for step in steps], axis=0))
    covariance *= np.outer(wider, wider)
    deviance, inflation = 2.0 * result.cost - separate, float(np.mean(wider**2))
    return Shared(steps[0].names, result.x[:k], covariance, deviance, inflation, degrees)
