"""Score tests: what more, or less, freedom would do to chi-square, without another search."""

import numpy as np
from scipy.special import chdtri

#: fall of chi-square that has a cause, and is no chance: of a start out of steady sliding, of a lag
FALL = 12.0
#: chance below which noise alone is not believed to make a response
CHANCE = 1e-4


def gain_of(solution, added):
    """By how much chi-square would fall with more coordinates, and where they would come to.

    To first order, all others being refitted: a score test.

    added : (m, p) derivatives of friction by them
    """
    record = solution.problem.record
    residual = record.friction - solution.fitted
    columns = np.column_stack([residual, added, solution.jacobian])
    rest = _rest(solution, columns, 1 + added.shape[1])
    moved = np.linalg.lstsq(rest[:, 1:], rest[:, 0], rcond=1e-6)[0]
    return float(np.sum((rest[:, 1:] @ moved) ** 2)), moved


def response(solution):
    """By how much the sliders fit better than level and trend alone, and by how many parameters."""
    record = solution.problem.record
    lines = [np.ones(record.t.size), record.along / np.abs(record.along).max()]
    columns = np.column_stack([record.friction, *lines[: 2 if record.trend else 1]])
    rest = _rest(solution, columns, 1)[:, 0]
    return float(rest @ rest) - solution.chi2, len(solution.point) - columns.shape[1] + 1


def _rest(solution, columns, count):
    """The first columns (m, count), whitened, without what the others can make of them."""
    white, _ = solution.noise.whiten(solution.problem.record.t, columns)
    basis, _ = np.linalg.qr(white[:, count:])
    return white[:, :count] - basis @ (basis.T @ white[:, :count])


def responds(solution):
    """Whether friction responds to the steps by more than noise does by chance."""
    gain, free = response(solution)
    return bool(gain > chdtri(free, CHANCE))
