"""Cuts the rows of a record into runs, on each of which a straight line fits.

Continuous lines that break at free times have two numbers for each line (with n lines: n slopes,
n - 1 times, one offset), as many as n independent lines.  So the joint least
squares of times and slopes are a line through the rows of each run by itself, broken where
neighbours intersect; and sums over rows from the start on give the misfit of any run at once.

The noise is estimated at each sampling rate, and at each place: a recorder that averages over its
sampling interval leaves less noise at a lower rate.
"""

import functools

import numpy as np
import scipy  # `scipy.ndimage` is imported once it is used: it is slow

from ...model.arrays import running_sum
from ..messages import load_point as sentences

MOST = 500  # runs
CANDIDATES = 20_000  # rows at which a run may be cut, before breaks are placed between rows
#: least fall of the squared misfit by a cut, over the variance of the noise.  The largest of n
#: falls by chance is about 2 ln n, 20 for long records.
SIGNIFICANT = 40.0
#: least spread of the times of a run, over that of all: below it sums have no digits left
RESOLVED = 1e-15
#: rows whose median interval is the local one; ratio of intervals beyond which two rates differ
BESIDE, APART = 9, 1.3
#: rows of the shortest run
SHORTEST = 4
#: median of chi-squared with as many degrees as a cut has numbers, for a level and for a line
TYPICAL = (0.455, 1.386)
#: pairs of runs of which the typical one is not moved by a few steps; fewest at a rate with a noise
#: of its own
PAIRS, FEWEST_PAIRS = 39, 8
#: pairs of shortest runs that show the noise at one place of the record, and by how many times its
#: variance must be larger there: by chance it is up to 2.5 times as large
LOCAL, LARGER = 101, 3.0
#: a gap is a step of time so many times longer than usual, among so many rows on either side of it
GAP, NEAR = 5.0, 10
#: least variance of the noise, over the sum of squares of all values (rounding) and over the
#: largest variance at any rate (sums have no digits for more)
ROUNDING, QUIETEST = 1e-15, 1e-6


class RowSums:
    """Sums over rows from the start on, at the rows where runs may be cut, weighted by the noise.

    t, x : ndarray, shape (n,)
    degree : 1 or 0, of what is fitted to a run: a line (a displacement), or a level (a speed)
    longest : rows within which noise is looked for; steps that are closer would count as noise

    `rates` (n,) numbers the sampling rates, `noise` (n,) is the variance of the noise there, and
    `gaps` are the rows before which there is a gap in time.
    """

    def __init__(self, t, x, degree=1, longest=10**9):
        self.t, self.x, self.degree = t, x, degree
        self.gaps = gaps_in(t)
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


def gaps_in(t):
    """Rows (list) before which there is a gap in the times t (n,), after 1 row at least."""
    dt = np.diff(t)
    if dt.size < 3:
        return []
    beside = np.minimum(np.append(dt[1], dt[:-1]), np.append(dt[1:], dt[-2]))
    gaps = []
    for i in np.flatnonzero(dt > GAP * beside).tolist():
        # the sampling rate may change: then the step is usual on one side
        sides = [dt[max(0, i - NEAR) : i], dt[i + 1 : i + 1 + NEAR]]
        if dt[i] > GAP * max(float(np.median(side)) for side in sides if side.size):
            gaps.append(i + 1)
    return gaps


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


def sampling_noise(t, y, degree, longest):
    """Return the variance of the noise of y, and the number of the rate, at times t: (n,) each.

    degree : 1 or 0, of what is fitted to a run: a line (a displacement), or a level (a speed)
    longest : most rows of the runs in which noise is looked for

    Notes
    -----
    The variance is the typical fall of the misfit when a run without break is cut in the middle,
    divided by the fall for white noise of variance 1.  The shortest runs give a level for each
    rate, and a larger one where the noise is larger than usual at that rate.  Longer runs, up to a
    fortieth of the rows, give larger variances if noise is correlated or the machine wanders.  The
    length with the largest variance counts.  If a rate has too few rows for a length, its noise
    grows by as much as the noise of the whole record.
    """
    rates = sampling_rates(t)
    blocks = np.cumsum(np.diff(rates, prepend=rates[0]) != 0)
    of_all = range(rates.max() + 1)

    def falls_by_rate(length, noise):
        """Falls (pairs,) for runs of a length, and those of each rate (list)."""
        first = np.arange(0, t.size - 2 * length + 1, length)
        falls = _falls(t, y, noise, first, length, degree)
        inside = blocks[first] == blocks[first + 2 * length - 1]
        return falls, [falls[inside & (rates[first] == rate)] for rate in of_all]

    shortest, own = falls_by_rate(SHORTEST, np.ones(t.size))
    known = [one.size >= FEWEST_PAIRS for one in own]
    levels = [np.median(one) for one, enough in zip(own, known, strict=True) if enough]
    noisiest = max(levels or [np.median(shortest) if shortest.size else 0.0])
    least = max(QUIETEST * noisiest, ROUNDING * float(y @ y))
    variances = np.full(len(own), max(noisiest, least))
    variances[known] = np.maximum(levels, least)
    growth, length = np.ones(len(own)), 2 * SHORTEST
    while length <= min(longest, t.size // (PAIRS + 1)):
        falls, own = falls_by_rate(length, variances[rates])
        typical = [np.median(one if one.size >= PAIRS else falls) for one in own]
        growth, length = np.maximum(growth, typical), 2 * length
    noise = _local(shortest, variances[rates]) * growth[rates]
    # (rates change between two rows: those beside have the larger noise of both)
    return scipy.ndimage.maximum_filter1d(noise, BESIDE, mode="nearest"), rates


def _local(falls, noise):
    """The noise (n,) of each rate, or by falls for short runs at its place if it is larger."""
    if falls.size < 2 * LOCAL:
        return noise
    rows = SHORTEST * np.arange(1, falls.size + 1)
    larger = scipy.ndimage.median_filter(falls / noise[rows], LOCAL, mode="reflect")
    larger = np.where(larger > LARGER, larger, 1.0)
    return noise * np.interp(np.arange(noise.size), rows, larger)


def sampling_rates(t):
    """Return the number of the sampling rate at each of the times t [s]: (n,) int from 0 on.

    Rates are groups of local sampling intervals that lie apart.  A clock that jitters has one.
    """
    interval = scipy.ndimage.median_filter(
        np.diff(t, append=2.0 * t[-1] - t[-2]), BESIDE, mode="nearest"
    )
    order = np.argsort(interval, kind="stable")
    rates = np.empty(t.size, int)
    rates[order] = np.cumsum(np.diff(np.log(interval[order]), prepend=np.inf) > np.log(APART))
    return rates


def _falls(t, y, noise, first, length, degree):
    """Falls (k,) of the misfit when runs from these rows on, two lengths each, are cut in two."""
    both = first[:, None] + np.arange(2 * length)
    misfits = [
        _misfits(t[rows], y[rows], 1.0 / noise[rows], degree)
        for rows in (both, both[:, :length], both[:, length:])
    ]
    return (misfits[0] - misfits[1] - misfits[2]) / TYPICAL[degree]


def _misfits(t, y, weight, degree):
    """Weighted sums of squares (k,) about the best line or level through rows (k, length)."""
    total = weight.sum(axis=1)

    def centred(x):
        x = x - x[:, :1]
        return x - ((weight * x).sum(axis=1) / total)[:, None]

    y = centred(y)
    if degree:
        u = centred(t)
        y = y - ((weight * u * y).sum(axis=1) / (weight * u * u).sum(axis=1))[:, None] * u
    return (weight * y * y).sum(axis=1)
