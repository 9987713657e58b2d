"""What several steps tell together: one set of parameters for all, and the scatter between them.

The steps share the parameters of the law; stiffness, level, trend and start remain each step's own,
and so does its noise, at the estimate of its separate fit, but as much larger as its uncertainty
makes the variances of this step's estimates (noise_uncertainty.py).  The joint least
squares are those of all whitened residuals.

The test is that of Welch (1951) doi:10.1093/biomet/38.3-4.330 for means of groups whose variances
are estimated, for k parameters as of Johansen (1980) doi:10.1093/biomet/67.1.85.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc, stdtr

from ...kit.least_squares import minimum
from ...kit.regression import weighted_mean
from ..by_law import value_of
from ..unknowns import SUMS, parameter, to_value
from .each import shared_coordinates

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

    def values(self, move=0.0):
        """name -> value [SI] of the parameters, their coordinates moved (k,)."""
        point = zip(self.names, self.point + move, strict=True)
        return {name: float(to_value(name, x)) for name, x in point}

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
        separate = fitted.of(law)
        self.inflation, self.solution = separate.inflation, separate.solution
        self.problem, names = self.solution.problem, self.solution.unknowns.names
        self.shared = shared_coordinates(self.solution.unknowns, fitted.task.settings)
        self.names = tuple(names[i] for i in self.shared)
        self.noise = self.solution.noise.times(math.sqrt(self.inflation.factor))
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
        self.ends = np.cumsum([self.k + len(step.own) + 1 for step in steps])

    def at(self, point):
        """Residual (m,) and jacobian (m, n) at a point (n,); NaN and 0 without a motion."""
        residuals, jacobian, begin = [], np.zeros((self.ends[-1], point.size)), 0
        for step, own, end in zip(self.steps, self.own, self.ends, strict=True):
            columns = step.compressed(point[: self.k], point[own])
            jacobian[begin:end, : self.k] = columns[:, : self.k]
            jacobian[begin:end, own] = columns[:, self.k : -1]
            residuals.append(columns[:, -1])
            begin = end
        return np.concatenate(residuals), np.nan_to_num(jacobian)

    def information(self, jacobian):
        """(steps, k, k) information of each step on the shared coordinates."""
        of_steps = []
        for own, rows in zip(self.own, np.split(jacobian, self.ends[:-1]), strict=True):
            shared, rest = rows[:, : self.k], rows[:, own]
            left = shared - rest @ np.linalg.lstsq(rest, shared)[0]
            of_steps.append(left.T @ left)
        return np.array(of_steps)

    def starts(self):
        """Points (n,), an iterator: at the medians of shared coordinates, then at each step's.

        With those of another some step may have no motion.
        """
        points = [step.solution.point for step in self.steps]
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
    low = joint.collected([step.solution.unknowns.low for step in steps], np.min)
    high = joint.collected([step.solution.unknowns.high for step in steps], np.max)
    searches = (minimum(joint.at, start, low, high, MOST) for start in joint.starts())
    result = next((one for one in searches if one), None)
    if result is None or not result.converged:
        return None
    information = joint.information(result.jacobian)
    covariance = np.linalg.pinv(information.sum(axis=0), hermitian=True)
    parts = np.einsum("ij,nji->n", covariance, information) / k
    inflations = [step.inflation for step in steps]
    chi2 = np.array([step.solution.chi2 for step in steps])
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


class Group(NamedTuple):
    """Mean of n estimates of one parameter, in its coordinate."""

    mean: float
    error: float  # of the mean, with the scatter between the estimates
    scatter: float  # standard deviation between them beyond their errors
    n: int
    is_log: bool  # whether the coordinate is a logarithm


class Ratio(NamedTuple):
    """Mean over steps up divided by that over steps down."""

    value: float
    error: float  # standard error, with the scatter within both groups
    p_value: float  # of as large a difference of the means if there is none


def ratio_of(up, down, is_log):
    """`Ratio` of two groups of estimates: pairs of values (n,) and standard errors (n,).

    The scatter is that about both means together, as of Student's test.  NaN without both, and
    errors and probability where each has one estimate, for then nothing is known of the scatter.
    """
    if not (len(up[0]) and len(down[0])):
        return Ratio(np.nan, np.nan, np.nan)
    of_up, of_down = (weighted_mean(*map(np.asarray, group)) for group in (up, down))
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


def group_of(values, errors, is_log=False):
    """`Group` of estimates (n,) with standard errors (n,): weighted, by DerSimonian & Laird (1986).

    doi:10.1016/0197-2456(86)90046-2; NaN of none.
    """
    n = len(values)
    if n == 0:
        return Group(np.nan, np.nan, np.nan, 0, is_log)
    values, errors = np.asarray(values), np.asarray(errors)
    weights = errors**-2.0
    excess = weighted_mean(values, errors).chi2 - (n - 1)
    per_scatter = float(weights.sum() - (weights**2).sum() / weights.sum())
    scatter = math.sqrt(max(excess / per_scatter, 0.0)) if n > 1 else 0.0
    mean = weighted_mean(values, np.hypot(errors, scatter))
    return Group(mean.value, mean.error, scatter, n, is_log)


def grouped(fits, law, name):
    """`Group` of a parameter over all `Fitted` windows, in its coordinate."""
    values, errors, is_log = estimates_of(fits, law, name)
    return group_of(values, errors, is_log)


def estimates_of(fits, law, name, chosen=lambda window: True):
    """Values (list) of a parameter in its coordinate, errors (list), and whether it is a logarithm.

    Of the `Fitted` windows that are chosen and usable; estimates without a finite error do not
    count.
    """
    is_log = name not in SUMS and parameter(name).is_log
    values, errors = [], []
    for fit in fits:
        separate = fit.usable(law)
        if not separate or not chosen(fit.task.window):
            continue
        part = separate.result
        if name not in part["parameter"].values:
            continue
        value, error = value_of(part, name), float(part["standard_error"].sel(parameter=name))
        if np.isfinite(error):
            values.append(np.log(value) if is_log else value)
            errors.append(error / value if is_log else error)
    return values, errors, is_log


def is_up(window):
    """Whether a window is that of a step to a higher speed."""
    return window.kind == "step" and window.V_after > window.V_before


def is_down(window):
    """Whether a window is that of a step to a lower speed."""
    return window.kind == "step" and window.V_after < window.V_before
