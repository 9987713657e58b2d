"""What several steps determine together: one set of parameters, and the scatter between steps.

The steps share the parameters of the law; stiffness, level, trend and start remain each step's own.
So does its noise: the estimate of its separate fit, enlarged as the uncertainty of the noise
enlarges the variances of this step's estimates (noise_uncertainty.py).  The joint least squares are
those of all whitened residuals.

The test is the one of Welch (1951) doi:10.1093/biomet/38.3-4.330 for means of groups whose
variances are estimated, for k parameters after Johansen (1980) doi:10.1093/biomet/67.1.85.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc, stdtr

from ...kit.least_squares import minimum
from ...kit.regression import weighted_mean
from ..unknowns import DERIVED, parameter

#: most evaluations of the search
MOST = 60
#: least of the sum in `denominator`: above it chi-square and F are the same
LEAST = 1e-9


class Shared(NamedTuple):
    """The joint fit of n steps with k shared parameters."""

    names: tuple  # of the shared parameters
    point: np.ndarray  # (k,) their coordinates
    covariance: np.ndarray  # (k, k) of these
    deviance: float  # chi-square less the sum of chi-squares of the separate fits
    degrees: int  # how many parameters fewer it has, k (n - 1)
    denominator: float  # degrees of freedom with which the variance is known

    @property
    def p_value(self):
        """Probability of such a deviance or a larger one, if one set serves all steps.

        It then has the mean `degrees`, and F the mean denominator/(denominator - 2).
        """
        mean = self.denominator / (self.denominator - 2.0)
        ratio = mean * max(self.deviance, 0.0) / self.degrees
        return float(fdtrc(self.degrees, self.denominator, ratio))


class _Joint:
    """Residuals of all steps by k shared coordinates, then each step's own, in order."""

    def __init__(self, steps):
        self.steps, self.k = steps, len(steps[0].shared)
        each = [range(step.solution.point.size) for step in steps]
        self.own = [[i for i in x if i not in s.shared] for x, s in zip(each, steps, strict=True)]
        self.columns = _slices([len(own) for own in self.own], self.k)
        self.rows = _slices([len(x) + 1 for x in each], 0)

    def at(self, point):
        """Residual (m,) and jacobian (m, n) at a point (n,); NaN and 0 without a motion.

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
        """(steps, k, k) information of each step on the shared coordinates.

        Rows of a triangle below those of the step's own coordinates do not depend on these.
        """
        pairs = zip(self.rows, self.own, strict=True)
        roots = [jacobian[rows.start + len(own) : rows.stop, : self.k] for rows, own in pairs]
        return np.array([root.T @ root for root in roots])

    def collected(self, values, of_shared):
        """(n,) coordinates from those of each step; the shared ones by a function of all."""
        shared = [one[step.shared] for one, step in zip(values, self.steps, strict=True)]
        own = [one[own] for one, own in zip(values, self.own, strict=True)]
        return np.concatenate([of_shared(shared, axis=0), *own])

    def starts(self):
        """Points (n,), an iterator: at the medians of shared coordinates, then at each step's.

        Some step may have no motion with the shared coordinates of another.
        """
        points = [step.solution.point for step in self.steps]
        yield self.collected(points, np.median)
        for i in range(len(points)):
            yield self.collected(points, lambda shared, axis, i=i: shared[i])


def _slices(sizes, begin):
    """Slices (list) of these sizes, one after the other."""
    return [slice(*pair) for pair in itertools.pairwise(itertools.accumulate(sizes, initial=begin))]


def _triangle(step, own, values):
    """Upper triangle with the inner products of whitened derivatives and, last, the residual.

    values : of a step's own coordinates, then of the shared ones; NaN if there is no motion
    """
    problem, order = step.solution.problem, own + step.shared
    point = values[np.argsort(order)]
    friction, jacobian = problem.forward.jacobian(point)
    columns = np.column_stack([jacobian[:, order], friction - problem.record.friction])
    if not np.isfinite(columns).all():
        return np.full((point.size + 1, point.size + 1), np.nan)
    noise = step.solution.noise.times(math.sqrt(step.inflation.factor))
    return np.linalg.qr(noise.whiten(problem.record.t, columns)[0], mode="r")


def shared_fit(steps):
    """`Shared` of the usable `Step`s (list) under one law.

    None for fewer than two, for nothing to share, and if the search has not converged.
    """
    steps = [step for step in steps if step.is_usable]
    if len(steps) < 2 or not steps[0].shared:
        return None
    joint = _Joint(steps)
    solutions, inflations = [s.solution for s in steps], [s.inflation for s in steps]
    low = joint.collected([one.unknowns.low for one in solutions], np.min)
    high = joint.collected([one.unknowns.high for one in solutions], np.max)
    searches = (minimum(joint.at, start, low, high, MOST) for start in joint.starts())
    result = next((one for one in searches if one), None)
    if result is None or not result.converged:
        return None
    information = joint.information(result.jacobian)
    covariance = np.linalg.pinv(information.sum(axis=0), hermitian=True)
    k, names = joint.k, tuple(solutions[0].unknowns.names[i] for i in steps[0].shared)
    parts = np.einsum("ij,nji->n", covariance, information) / k
    below = denominator(k, parts, np.array([one.spread for one in inflations]))
    separate = sum(x.chi2 / y.factor for x, y in zip(solutions, inflations, strict=True))
    deviance, degrees = 2.0 * result.cost - separate, k * (len(steps) - 1)
    return Shared(names, result.x[:k], covariance, deviance, degrees, below)


def denominator(k, parts, spreads):
    """Degrees of freedom, above 4, of F with the variance of the deviance of k parameters.

    parts : (n,) of each step in the information on the parameters, their sum 1
    spreads : (n,) relative variances of the variances of their estimates, as of `Inflation`
    """
    degrees = k * (parts.size - 1)
    more = k * (k + 2) * np.sum((1.0 - parts) ** 2 * spreads)
    return float(4.0 + 2.0 * degrees * (degrees + 2) / max(more, LEAST))


def moves_as_log(name):
    """Whether estimates of a parameter are compared by their logarithms."""
    return name not in DERIVED and parameter(name).is_log


def estimates_of(steps, name):
    """Values (n,) of a parameter in its coordinate, and errors (n,), under one law.

    NaN if a `Step` is not usable, or if its error is not finite.
    """
    pairs = np.full((len(steps), 2), np.nan)
    for i, step in enumerate(steps):
        if step.is_usable and name in step.result["parameter"].values:
            error = float(step.result["standard_error"].sel(parameter=name))
            if np.isfinite(error):
                pairs[i] = float(step.result[name]), error
    values, errors = pairs.T
    return (np.log(values), errors / values) if moves_as_log(name) else (values, errors)


class MeanOfSteps(NamedTuple):
    """Mean of estimates of one parameter, its error with the scatter, and the scatter."""

    value: float
    error: float
    scatter: float  # standard deviation between estimates beyond their errors; NaN of one


def mean_of(values, errors):
    """`MeanOfSteps` of estimates (n,) with standard errors (n,); NaN are left out, and of none.

    Weighted as by DerSimonian & Laird (1986) doi:10.1016/0197-2456(86)90046-2.
    """
    known = np.isfinite(errors)
    values, errors = values[known], errors[known]
    if not (n := len(values)):
        return MeanOfSteps(np.nan, np.nan, np.nan)
    weights = errors**-2.0
    excess = weighted_mean(values, errors).chi2 - (n - 1)
    per_scatter = float(weights.sum() - (weights**2).sum() / weights.sum())
    scatter = math.sqrt(max(excess / per_scatter, 0.0)) if n > 1 else 0.0
    mean = weighted_mean(values, np.hypot(errors, scatter))
    return MeanOfSteps(mean.value, mean.error, scatter if n > 1 else np.nan)


class Ratio(NamedTuple):
    """Mean over steps up divided by that over steps down."""

    value: float
    error: float  # standard error, with the scatter within both groups
    p_value: float  # of as large a difference of the means if there is none


def ratio_of(up, down, is_log):
    """`Ratio` of two groups of estimates: pairs of values (n,) and standard errors (n,).

    The scatter is that about both means together, as of Student's test.  NaN without both, and
    errors and probability if each has one estimate, for then nothing is known of the scatter.
    """
    if not (len(up[0]) and len(down[0])):
        return Ratio(np.nan, np.nan, np.nan)
    of_up, of_down = weighted_mean(*up), weighted_mean(*down)
    difference, degrees = of_up.value - of_down.value, len(up[0]) + len(down[0]) - 2
    value = float(np.exp(difference)) if is_log else of_up.value / of_down.value
    if degrees == 0:
        return Ratio(value, np.nan, np.nan)
    enlarged = math.sqrt(max((of_up.chi2 + of_down.chi2) / degrees, 1.0))
    error = enlarged * math.hypot(of_up.error, of_down.error)
    p_value = float(2.0 * stdtr(degrees, -abs(difference) / error))
    own = value * error
    if not is_log:
        own = enlarged * math.hypot(of_up.error, value * of_down.error) / abs(of_down.value)
    return Ratio(value, own, p_value)
