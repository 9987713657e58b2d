"""Cuts the rows of a record into runs, on each of which a straight line fits.

Continuous lines that break at free times have two numbers for each line (with n lines: n slopes,
n - 1 times, one offset), as many as n independent lines.  So the joint least
squares of times and slopes are a line through the rows of each run by itself, broken where
neighbours intersect; and sums over rows from the start on give the misfit of any run at once.
"""

import functools

import numpy as np

from ...model.arrays import running_sum
from ..messages import load_point as sentences
from .sampling_noise import SHORTEST, sampling_noise

MOST = 500  # runs
CANDIDATES = 20_000  # rows at which a run may be cut, before breaks are placed between rows
#: least fall of the squared misfit by a cut, over the variance of the noise.  The largest of n
#: falls by chance is about 2 ln n, 20 for long records.
SIGNIFICANT = 40.0
#: least spread of the times of a run, over that of all: below it sums have no digits left
RESOLVED = 1e-15


class RowSums:
    """Sums over rows from the start on, at the rows where runs may be cut, weighted by the noise.

    t, x : ndarray, shape (n,)
    degree : 1 or 0, of what is fitted to a run: a line (a displacement), or a level (a speed)
    longest : rows within which noise is looked for; steps that are closer would count as noise

    `rates` (n,) numbers the sampling rates, and `noise` (n,) is the variance of the noise there.
    """

    def __init__(self, t, x, degree=1, longest=10**9):
        self.t, self.degree = t, degree
        u = t - t.mean()
        # what all runs share only costs digits
        y = x - (np.polyval(np.polyfit(u, x, 1), u) if degree else x.mean())
        self.noise, self.rates = sampling_noise(t, y, degree, longest)
        columns = np.array([np.ones_like(u), u, u * u, y, u * y, y * y]) / self.noise
        self.all = np.zeros((6, t.size + 1))
        self.all[:, 1:] = running_sum(columns)
        self.every = -(-t.size // CANDIDATES)
        self.set_candidates(np.unique(np.append(np.arange(0, t.size, self.every), t.size)))

    def set_candidates(self, at):
        """Let these rows (indices, increasing, first and last included) be the candidates."""
        self.at, self.sums = at, self.all[:, at]
        self.best_cut = functools.cache(self._best_cut)  # called repeatedly

    def misfit(self, i, j):
        """Sum of squares about the best line (or level), of rows ``at[i]`` up to ``at[j]``."""
        n, u, uu, y, uy, yy = (column[j] - column[i] for column in self.sums)
        n = np.maximum(n, 1e-300)
        misfit = yy - y * y / n
        if self.degree:
            spread, along = uu - u * u / n, uy - u * y / n
            resolved = spread > RESOLVED * self.sums[2, -1]  # else rows are too close in time
            misfit -= np.where(resolved, along, 0.0) ** 2 / np.where(resolved, spread, 1.0)
        return np.maximum(misfit, 0.0)

    def _best_cut(self, i, j):
        """The candidate between i and j that takes most off the misfit, and how much."""
        k = np.arange(
            np.searchsorted(self.at, self.at[i] + SHORTEST),
            np.searchsorted(self.at, self.at[j] - SHORTEST, side="right"),
        )
        if not k.size:
            return i, 0.0
        both = self.misfit(i, k) + self.misfit(k, j)
        best = int(np.argmin(both))
        return int(k[best]), float(self.misfit(i, j) - both[best])


def cut(rows):
    """Cut a record into runs: list of the indices in ``rows.at`` where they begin and end.

    Each run is cut where that gains most, as long as the gain is significant; then cuts are moved
    between their neighbours until none gains, and those that gain nothing any more are undone.
    ParameterError for more than `MOST`: a history without constant speeds would make as many.
    """
    cuts, open_ = [0, rows.at.size - 1], [(0, rows.at.size - 1)]
    while open_ and len(cuts) <= MOST:
        i, j = open_.pop(0)
        k, gain = rows.best_cut(i, j)
        if gain > SIGNIFICANT:
            cuts.append(k)
            open_ += [(i, k), (k, j)]
    if len(cuts) > MOST:
        t, T = rows.t[0], rows.t[-1]
        raise sentences.refusal("segments.none", first=t, last=T, most=MOST, tenth=t + (T - t) / 10)
    cuts = _improved(rows, sorted(cuts))
    if rows.every > 1:
        # all rows near the cuts as candidates, not only every second or so
        near = np.arange(-2 * rows.every, 2 * rows.every + 1)
        places = rows.at[cuts]
        candidates = np.unique(np.append(rows.at, (places[:, None] + near).ravel()))
        rows.set_candidates(candidates[(candidates >= 0) & (candidates <= places[-1])])
        cuts = _improved(rows, np.searchsorted(rows.at, places).tolist())
    while len(cuts) > 2:
        m, fewer, gain = _weakest_cut(rows, cuts)
        if gain > SIGNIFICANT:
            break
        cuts = _improved(rows, fewer, near=m)
    return cuts


def _weakest_cut(rows, cuts):
    """The cut, or two that one may replace, of least use: index, other cuts, rise of the misfit."""
    c = np.array(cuts)
    one = rows.misfit(c[:-1], c[1:])
    gains = rows.misfit(c[:-2], c[2:]) - one[:-1] - one[1:]
    m = int(np.argmin(gains))
    weakest = m + 1, cuts[: m + 1] + cuts[m + 2 :], float(gains[m])
    for m in range(1, len(cuts) - 2):
        i, j = cuts[m - 1], cuts[m + 2]
        k, gain = rows.best_cut(i, j)
        loss = float(rows.misfit(i, j) - gain - one[m - 1 : m + 2].sum())
        if i < k and loss < weakest[2]:
            weakest = m, [*cuts[:m], k, *cuts[m + 2 :]], loss
    return weakest


def _improved(rows, cuts, near=None):
    """The cuts, each (or those near index `near`) at its best place between its neighbours."""
    cuts = list(cuts)
    for _ in range(20):
        before = list(cuts)
        for m in range(1, len(cuts) - 1):
            if near is None or abs(m - near) <= 1:
                k, gain = rows.best_cut(cuts[m - 1], cuts[m + 1])
                cuts[m] = k if gain > 0.0 else cuts[m]
        if cuts == before:
            break
    return cuts


def drop_weak_cuts(rows, cuts, sizes, least):
    """Rows (list) at the ends of runs, once the cuts of a size below the least are gone.

    sizes : function of such rows, the size of the change at each but the first and last
    """
    while True:
        at = rows.at[cuts].tolist()
        changes = sizes(at)
        if not len(changes) or min(changes) >= least:
            return at
        m = int(np.argmin(changes)) + 1
        cuts = _improved(rows, cuts[:m] + cuts[m + 1 :], near=m)
