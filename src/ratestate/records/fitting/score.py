"""Score tests: how chi-square would change with more, or fewer, parameters, without a search."""

import numpy as np
from scipy.special import chdtri

#: fall of chi-square by one more parameter (a lag, an unsteady start) that is not by chance
FALL = 12.0
#: probability below which a response is not taken for noise
CHANCE = 1e-4


def gain_of(solution, added):
    """Fall of chi-square (float, >= 0) with more coordinates, and the values (p,) of these.

    To first order, with all other coordinates fitted again: a score test.

    added : (m, p) derivatives of friction by them
    """
    columns = np.column_stack([solution.residual, added, solution.jacobian])
    rest = projected(solution, columns, 1 + added.shape[1])
    moved = np.linalg.lstsq(rest[:, 1:], rest[:, 0], rcond=1e-6)[0]
    return float(np.sum((rest[:, 1:] @ moved) ** 2)), moved


def response(solution):
    """Fall of chi-square from level and trend alone to the solution, and parameters it takes.

    The fall is negative where these alone fit better.
    """
    record = solution.problem.record
    lines = [values / np.abs(values).max() for values in record.regressors().values()]
    columns = np.column_stack([record.friction, *lines])
    rest = projected(solution, columns, 1)[:, 0]
    return float(rest @ rest) - solution.chi2, len(solution.point) - columns.shape[1] + 1


def projected(solution, columns, count):
    """The first columns (m, count), whitened, less their projections on the other columns."""
    white, _ = solution.noise.whiten(solution.problem.record.t, columns)
    basis, _ = np.linalg.qr(white[:, count:])
    return white[:, :count] - basis @ (basis.T @ white[:, :count])


def responds(solution):
    """Whether friction responds to the steps by more than noise does by chance."""
    gain, free = response(solution)
    return bool(gain > chdtri(free, CHANCE))
