"""The joint fit of several steps: one set of parameters, and the scatter between steps.

The steps share the parameters of the law.  Each step has its own stiffness, level, trend and
start.  It also has its own noise: the estimate of its separate fit, enlarged as the uncertainty
of the noise enlarges the variances of this step's estimates (noise_uncertainty.py).

The test whether one set serves all steps is the test of Welch (1951)
doi:10.1093/biomet/38.3-4.330 for means of groups with estimated variances.  For k parameters it
follows Johansen (1980) doi:10.1093/biomet/67.1.85.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
import scipy

from ...kit.least_squares import minimum
from ...kit.regression import weighted_mean
from ..unknowns import DERIVED, parameter

#: most evaluations of the joint search
MOST = 60
#: least sum in `denominator`; for smaller sums F equals chi-square
LEAST = 1e-9


class Shared(NamedTuple):
    """The joint fit of n steps with k shared parameters."""

    names: tuple  # of the shared parameters
    point: np.ndarray  # (k,) their coordinates
    covariance: np.ndarray  # (k, k)
    deviance: float  # chi-square less the sum of chi-squares of the separate fits
    degrees: int  # number of parameters fewer than in the separate fits, k (n - 1)
    denominator: float  # degrees of freedom of the denominator of F

    @property
    def p_value(self):
        """Probability of such a deviance or a larger one, if one set serves all steps.

        The deviance then has the mean `degrees`, and F the mean denominator/(denominator - 2).
        """
        mean = self.denominator / (self.denominator - 2.0)
        ratio = mean * max(self.deviance, 0.0) / self.degrees
        return float(scipy.special.fdtrc(self.degrees, self.denominator, ratio))


class _Joint:
    """Residuals of all steps, by k shared coordinates and then each step's own."""

    def __init__(self, steps):
        self.steps, self.k = steps, len(steps[0].shared)
        sizes = [step.solution.point.size for step in steps]
        pairs = zip(sizes, steps, strict=True)
        self.own = [[i for i in range(size) if i not in step.shared] for size, step in pairs]
        self.columns = _slices([len(own) for own in self.own], self.k)
        self.rows = _slices([size + 1 for size in sizes], 0)

    def at(self, point):
        """Return residual (m,) and jacobian (m, n) at a point; NaN, 0 without a motion.

        The rows of a step have the normal equations of all its samples.
        """
        residual = np.empty(self.rows[-1].stop)
        jacobian = np.zeros((residual.size, point.size))
        parts = zip(self.steps, self.own, self.columns, self.rows, strict=True)
        for step, own, columns, rows in parts:
            triangle = _triangle(step, own, np.append(point[columns], point[: self.k]))
            jacobian[rows, columns] = triangle[:, : len(own)]
            jacobian[rows, : self.k] = triangle[:, len(own) : -1]
            residual[rows] = triangle[:, -1]
        return residual, np.nan_to_num(jacobian)

    def information(self, jacobian):
        """Return the information (steps, k, k) of each step on the shared coordinates.

        Rows of a triangle below the rows of the step's own coordinates do not depend on them.
        """
        pairs = zip(self.rows, self.own, strict=True)
        roots = [jacobian[rows.start + len(own) : rows.stop, : self.k] for rows, own in pairs]
        return np.array([root.T @ root for root in roots])

    def collected(self, values, combine):
        """Return coordinates (n,) from each step's; `combine` merges the shared ones."""
        shared = [x[step.shared] for x, step in zip(values, self.steps, strict=True)]
        own = [x[own] for x, own in zip(values, self.own, strict=True)]
        return np.concatenate([combine(shared, axis=0), *own])

    def starts(self):
        """Yield points (n,): first medians of the shared coordinates, then each step's.

        A step may have no motion with the shared coordinates of another step.
        """
        points = [step.solution.point for step in self.steps]
        yield self.collected(points, np.median)
        for i in range(len(points)):
            yield self.collected(points, lambda shared, axis, i=i: shared[i])


def _slices(sizes, begin):
    """Return contiguous slices (list) of these sizes."""
    return [slice(*pair) for pair in itertools.pairwise(itertools.accumulate(sizes, initial=begin))]


def _triangle(step, own, values):
    """Return the triangle of a QR decomposition of whitened derivatives, residual.

    own : coordinates (list of int) of the step that are not shared
    values : of the own coordinates, then of the shared ones; NaN without a motion
    """
    problem, order = step.solution.problem, own + step.shared
    point = values[np.argsort(order)]
    friction, jacobian = problem.forward.jacobian(point)
    columns = np.column_stack([jacobian[:, order], friction - problem.record.friction])
    if not np.isfinite(columns).all():
        return np.full((point.size + 1, point.size + 1), np.nan)
    white, _ = problem.whiten(columns, step.solution.noise)
    return np.linalg.qr(white / math.sqrt(step.inflation.factor), mode="r")


def shared_fit(steps):
    """Return the `Shared` of the usable `Step`s (list) under one law.

    None with fewer than two, if no coordinate is shared, or if the search has not converged.
    """
    steps = [step for step in steps if step.is_usable]
    if len(steps) < 2 or not steps[0].shared:
        return None
    joint = _Joint(steps)
    solutions, inflations = [s.solution for s in steps], [s.inflation for s in steps]
    low = joint.collected([solution.unknowns.low for solution in solutions], np.min)
    high = joint.collected([solution.unknowns.high for solution in solutions], np.max)
    searches = (minimum(joint.at, start, low, high, MOST) for start in joint.starts())
    result = next(filter(None, searches), None)
    if result is None or not result.converged:
        return None
    information = joint.information(result.jacobian)
    covariance = np.linalg.pinv(information.sum(axis=0), hermitian=True)
    k, names = joint.k, tuple(solutions[0].unknowns.names[i] for i in steps[0].shared)
    parts = np.einsum("ij,nji->n", covariance, information) / k
    below = denominator(k, parts, np.array([inflation.spread for inflation in inflations]))
    separate = sum(x.chi2 / y.factor for x, y in zip(solutions, inflations, strict=True))
    deviance, degrees = 2.0 * result.cost - separate, k * (len(steps) - 1)
    return Shared(names, result.x[:k], covariance, deviance, degrees, below)


def denominator(k, parts, spreads):
    """Return degrees of freedom > 4 of F with the variance of the deviance.

    k : number of parameters
    parts : (n,) each step's fraction of the information on the parameters
    spreads : (n,) relative variances of the variances of their estimates, as of `Inflation`
    """
    degrees = k * (parts.size - 1)
    more = k * (k + 2) * np.sum((1.0 - parts) ** 2 * spreads)
    return float(4.0 + 2.0 * degrees * (degrees + 2) / max(more, LEAST))


def moves_as_log(name):
    """Return whether the logarithms of a parameter's estimates are compared."""
    return name not in DERIVED and parameter(name).is_log


def estimates_of(steps, name):
    """Return values (n,) of a parameter in its coordinate, and errors (n,).

    Both are NaN if a `Step` is not usable, or if its error is not finite.
    """
    pairs = np.full((len(steps), 2), np.nan)
    for i, step in enumerate(steps):
        if step.is_usable and name in step.result["parameter"].values:
            error = float(step.result["standard_error"].sel(parameter=name))
            if np.isfinite(error):
                pairs[i] = float(step.result[name]), error
    values, errors = pairs.T
    return (np.log(values), errors / values) if moves_as_log(name) else (values, errors)


def mean_of(values, errors):
    """Return the mean of estimates (n,) with errors (n,), NaN left out; its error; the scatter.

    Weighted as by DerSimonian & Laird (1986) doi:10.1016/0197-2456(86)90046-2.  The scatter is the
    standard deviation between steps beyond the errors, NaN for one estimate.
    """
    known = np.isfinite(errors)
    values, errors = values[known], errors[known]
    if not (n := len(values)):
        return np.nan, np.nan, np.nan
    weights = errors**-2.0
    excess = weighted_mean(values, errors)[2] - (n - 1)
    per_scatter = float(weights.sum() - (weights**2).sum() / weights.sum())
    scatter = math.sqrt(max(excess / per_scatter, 0.0)) if n > 1 else 0.0
    mean, error, _ = weighted_mean(values, np.hypot(errors, scatter))
    return mean, error, scatter if n > 1 else np.nan


def ratio_of(up, down, is_log):
    """Return the ratio of the means of two groups, its error, and the p-value of equal means.

    up, down : pairs of values (n,) and errors (n,)

    The scatter is about both means together, as in Student's test.  All is NaN if a group is empty.
    Error and probability are NaN if each group has one estimate, so that the scatter is unknown.
    """
    if not (len(up[0]) and len(down[0])):
        return np.nan, np.nan, np.nan
    mean_up, error_up, chi2_up = weighted_mean(*up)
    mean_down, error_down, chi2_down = weighted_mean(*down)
    difference, degrees = mean_up - mean_down, len(up[0]) + len(down[0]) - 2
    value = float(np.exp(difference)) if is_log else mean_up / mean_down
    if degrees == 0:
        return value, np.nan, np.nan
    enlarged = math.sqrt(max((chi2_up + chi2_down) / degrees, 1.0))
    of_difference = enlarged * math.hypot(error_up, error_down)
    p_value = float(2.0 * scipy.special.stdtr(degrees, -abs(difference) / of_difference))
    if is_log:
        return value, value * of_difference, p_value
    error = enlarged * math.hypot(error_up, value * error_down) / abs(mean_down)
    return value, error, p_value
