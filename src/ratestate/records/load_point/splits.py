"""Cut the rows of a record into runs, each of which a straight line fits.

A continuous line of n pieces with free breakpoints has 2 n parameters (n slopes, n - 1 times, one
offset), as many as n independent lines.  So the joint least-squares fit of times and slopes is a
separate line through the rows of each run, with breakpoints where neighbouring lines intersect.
Cumulative sums over the rows give the misfit of any run at once.

The noise is estimated at each sampling rate and at each place, because a recorder that averages
over its sampling interval leaves less noise at a lower rate.
"""

import functools
import itertools

import numpy as np
import scipy

from ...model.arrays import running_sum
from ..kit.sample_noise import OF_STEP
from ..messages import load_point as sentences

MAX_RUNS = 500
MAX_CANDIDATES = 20_000  # rows at which a run may be cut in the first search
#: least reduction of the squared misfit by a cut, as a multiple of the variance of the noise.  The
#: largest of n reductions by chance is about 2 ln n, 20 for long records.
MIN_GAIN = 40.0
#: least spread of the times of a run, as a fraction of the spread of all times.  Below it, the
#: differences of cumulative sums have no significant digits.
MIN_SPREAD = 1e-15
#: rows whose median sampling interval is the local one; ratio of intervals of two different rates
NEIGHBOURS, RATE_RATIO = 9, 1.3
MIN_RUN_ROWS = 4  # rows of the shortest run
#: median of chi-squared with one degree of freedom (a level) and with two (a line)
CHI2_MEDIANS = (0.455, 1.386)
#: pairs of runs whose median a few steps do not change; fewest pairs that give a rate a noise level
TYPICAL_PAIRS, MIN_PAIRS = 39, 8
#: pairs of shortest runs that give the local noise, and the least ratio of the local variance to
#: the usual one that counts: by chance the ratio is up to 2.5
LOCAL_PAIRS, LOCAL_RATIO = 101, 3.0
#: least length of a gap, as a multiple of the usual time step, and rows on either side of the gap
#: that define the usual time step
GAP_RATIO, GAP_ROWS = 5.0, 10
#: least variance of the noise: as a fraction of the sum of squares of all values (rounding), and of
#: the largest variance at any rate (the precision of cumulative sums)
ROUNDING, MIN_VARIANCE_RATIO = 1e-15, 1e-6
# Variance of the noise of values that are all equal, by which sums are divided.
LEAST_VARIANCE = 1e-100


class RowSums:
    """Cumulative sums, weighted by the noise, at the candidate rows where runs may be cut.

    t, x : ndarray, shape (n,)
    degree : 1 to fit a line to each run (a displacement), 0 to fit a level (a speed)
    longest : most rows of the runs that the noise is estimated from; closer steps count as noise
    digit : step between the values of x if they are rounded, in their unit; else 0

    `rates` (n,) is the number of each row's sampling rate, and `noise` (n,) the variance of its
    noise.  `gaps` (list) has the rows before which there is a gap in time.
    """

    def __init__(self, t, x, degree=1, longest=10**9, digit=0.0):
        self.t, self.x, self.degree, self.digit = t, x, degree, digit
        self.gaps = gaps_in(t)
        u = t - t.mean()
        # removing the overall line or mean saves significant digits
        y = x - (np.polyval(np.polyfit(u, x, 1), u) if degree else x.mean())
        self.noise, self.rates = sampling_noise(t, y, degree, longest, (OF_STEP * digit) ** 2)
        columns = np.array([np.ones_like(u), u, u * u, y, u * y, y * y]) / self.noise
        self.all_sums = np.zeros((6, t.size + 1))
        self.all_sums[:, 1:] = running_sum(columns)
        self.stride = -(-t.size // MAX_CANDIDATES)
        self.set_candidates(np.unique(np.append(np.arange(0, t.size, self.stride), t.size)))

    def set_candidates(self, at):
        """Set the candidate rows: increasing indices, from 0 to the number of rows."""
        self.at, self.sums = at, self.all_sums[:, at]
        self.best_cut = functools.cache(self._best_cut)

    def misfit(self, i, j):
        """Return the sum of squares about the best line (or level) of rows at[i] to at[j] - 1."""
        n, u, uu, y, uy, yy = (column[j] - column[i] for column in self.sums)
        n = np.maximum(n, 1e-300)
        misfit = yy - y * y / n
        if self.degree:
            spread, product = uu - u * u / n, uy - u * y / n
            resolved = spread > MIN_SPREAD * self.sums[2, -1]  # else rows are too close in time
            misfit -= np.where(resolved, product, 0.0) ** 2 / np.where(resolved, spread, 1.0)
        return np.maximum(misfit, 0.0)

    def _best_cut(self, i, j):
        """Return the candidate between i and j that reduces the misfit most, and by how much."""
        k = np.arange(
            np.searchsorted(self.at, self.at[i] + MIN_RUN_ROWS),
            np.searchsorted(self.at, self.at[j] - MIN_RUN_ROWS, side="right"),
        )
        if not k.size:
            return i, 0.0
        misfits = self.misfit(i, k) + self.misfit(k, j)
        best = int(np.argmin(misfits))
        return int(k[best]), float(self.misfit(i, j) - misfits[best])


def gaps_in(t, ratio=GAP_RATIO, rows=GAP_ROWS):
    """Return the rows (list) before which there is a gap in the times t (n,).

    ratio : least length of a gap, as a multiple of the median time step on either side
    rows : number of time steps on either side
    """
    dt = np.diff(t)
    if dt.size < 3:
        return []
    neighbour = np.minimum(np.append(dt[1], dt[:-1]), np.append(dt[1:], dt[-2]))
    gaps = []
    for i in np.flatnonzero(dt > ratio * neighbour).tolist():
        # if the sampling rate changes here, the time step is the usual one on one side
        sides = [dt[max(0, i - rows) : i], dt[i + 1 : i + 1 + rows]]
        if dt[i] > ratio * max(float(np.median(side)) for side in sides if side.size):
            gaps.append(i + 1)
    return gaps


def find_cuts(rows):
    """Return the indices in ``rows.at`` (list) at which runs begin and end.

    Each run is cut at the row that reduces the misfit most, as long as the reduction is
    significant.  Then the cuts are moved between their neighbours until none improves, and cuts
    that are no more significant are removed.  The removal may join runs that can be cut elsewhere.
    ParameterError if there are more than `MAX_RUNS` runs, because the load point then has no
    constant speeds.
    """
    cuts = _improve_cuts(rows, _cut_runs(rows, [0, rows.at.size - 1]))
    if rows.stride > 1:
        # search again with all rows near the cuts as candidates
        near = np.arange(-2 * rows.stride, 2 * rows.stride + 1)
        places = rows.at[cuts]
        candidates = np.unique(np.append(rows.at, (places[:, None] + near).ravel()))
        rows.set_candidates(candidates[(candidates >= 0) & (candidates <= places[-1])])
        cuts = _improve_cuts(rows, np.searchsorted(rows.at, places).tolist())
    cuts = _remove_cuts(rows, cuts)
    more = _cut_runs(rows, cuts)
    return cuts if more == cuts else _remove_cuts(rows, _improve_cuts(rows, more))


def _cut_runs(rows, cuts):
    """Return the cuts and those that divide their runs further, as long as they are significant."""
    cuts, unfinished = list(cuts), list(itertools.pairwise(cuts))
    while unfinished and len(cuts) <= MAX_RUNS:
        i, j = unfinished.pop(0)
        k, gain = rows.best_cut(i, j)
        if gain > MIN_GAIN:
            cuts.append(k)
            unfinished += [(i, k), (k, j)]
    if len(cuts) > MAX_RUNS:
        t, T = rows.t[0], rows.t[-1]
        raise sentences.refusal(
            "segments.none", first=t, last=T, most=MAX_RUNS, tenth=t + (T - t) / 10
        )
    return sorted(cuts)


def _remove_cuts(rows, cuts):
    """Remove the cuts that are not significant, the weakest first."""
    while len(cuts) > 2:
        m, remaining, gain = _weakest_cut(rows, cuts)
        if gain > MIN_GAIN:
            break
        cuts = _improve_cuts(rows, remaining, near=m)
    return cuts


def _weakest_cut(rows, cuts):
    """Return the index of the weakest cut, the cuts without it, and the increase of the misfit.

    Two neighbouring cuts that one cut may replace count as one candidate for removal.
    """
    c = np.array(cuts)
    misfits = rows.misfit(c[:-1], c[1:])
    gains = rows.misfit(c[:-2], c[2:]) - misfits[:-1] - misfits[1:]
    m = int(np.argmin(gains))
    weakest = m + 1, cuts[: m + 1] + cuts[m + 2 :], float(gains[m])
    for m in range(1, len(cuts) - 2):
        i, j = cuts[m - 1], cuts[m + 2]
        k, gain = rows.best_cut(i, j)
        loss = float(rows.misfit(i, j) - gain - misfits[m - 1 : m + 2].sum())
        if i < k and loss < weakest[2]:
            weakest = m, [*cuts[:m], k, *cuts[m + 2 :]], loss
    return weakest


def _improve_cuts(rows, cuts, near=None):
    """Move each cut (or those near index `near`) to its best place between its neighbours."""
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
    """Remove cuts with a change below `least`; return the rows (list) at the ends of runs.

    sizes : function of these rows that returns the size of the change at each inner one
    """
    while True:
        at = rows.at[cuts].tolist()
        changes = sizes(at)
        if not len(changes) or min(changes) >= least:
            return at
        m = int(np.argmin(changes)) + 1
        cuts = _improve_cuts(rows, cuts[:m] + cuts[m + 1 :], near=m)


def sampling_noise(t, y, degree, longest, least):
    """Return the variance of the noise of y and the number of the sampling rate: (n,) each.

    degree : 1 to fit a line to each run (a displacement), 0 to fit a level (a speed)
    longest : most rows of the runs that the noise is estimated from
    least : least variance

    Notes
    -----
    The variance is the median reduction of the misfit when a run without a step is cut in the
    middle, divided by the median for white noise of variance 1.  The shortest runs give a level for
    each rate, and a larger local level if the noise is larger than usual at that rate.  Longer
    runs, up to a fortieth of the rows, give larger variances if the noise is correlated or the
    machine wanders.  The length with the largest variance counts.  If a rate has too few rows for a
    length, its noise grows by the same factor as the noise of the whole record.
    """
    rates = sampling_rates(t)
    blocks = np.cumsum(np.diff(rates, prepend=rates[0]) != 0)
    of_all = range(rates.max() + 1)

    def reductions_by_rate(length, noise):
        """Return the reductions (pairs,) for runs of a length, and a list of them by rate.

        Runs of twice the length are cut in half.  In white noise the median reduction is 1.
        """
        first = np.arange(0, t.size - 2 * length + 1, length)
        rows_of_pair = first[:, None] + np.arange(2 * length)
        joint, left, right = (
            _misfits(t[rows], y[rows], 1.0 / noise[rows], degree)
            for rows in (rows_of_pair, rows_of_pair[:, :length], rows_of_pair[:, length:])
        )
        reductions = (joint - left - right) / CHI2_MEDIANS[degree]
        inside = blocks[first] == blocks[first + 2 * length - 1]
        return reductions, [reductions[inside & (rates[first] == rate)] for rate in of_all]

    shortest, grouped = reductions_by_rate(MIN_RUN_ROWS, np.ones(t.size))
    known = [group.size >= MIN_PAIRS for group in grouped]
    levels = [np.median(group) for group, is_known in zip(grouped, known, strict=True) if is_known]
    noisiest = max(levels or [np.median(shortest) if shortest.size else 0.0])
    least = max(least, MIN_VARIANCE_RATIO * noisiest, ROUNDING * float(y @ y), LEAST_VARIANCE)
    variances = np.full(len(grouped), max(noisiest, least))
    variances[known] = np.maximum(levels, least)
    growth, length = np.ones(len(grouped)), 2 * MIN_RUN_ROWS
    while length <= min(longest, t.size // (TYPICAL_PAIRS + 1)):
        reductions, grouped = reductions_by_rate(length, variances[rates])
        typical = [np.median(x if x.size >= TYPICAL_PAIRS else reductions) for x in grouped]
        growth, length = np.maximum(growth, typical), 2 * length
    noise = _local_noise(shortest, variances[rates]) * growth[rates]
    # a rate changes between two rows: rows beside the change take the larger noise
    return scipy.ndimage.maximum_filter1d(noise, NEIGHBOURS, mode="nearest"), rates


def _local_noise(reductions, noise):
    """Return the noise (n,) of each rate, replaced by the local noise if that is larger."""
    if reductions.size < 2 * LOCAL_PAIRS:
        return noise
    rows = MIN_RUN_ROWS * np.arange(1, reductions.size + 1)
    larger = scipy.ndimage.median_filter(reductions / noise[rows], LOCAL_PAIRS, mode="reflect")
    larger = np.where(larger > LOCAL_RATIO, larger, 1.0)
    return noise * np.interp(np.arange(noise.size), rows, larger)


def sampling_rates(t):
    """Return the number of the sampling rate at each of the times t [s]: (n,) int from 0 on.

    A rate is a group of similar local sampling intervals.  A clock that jitters has one rate.
    """
    interval = scipy.ndimage.median_filter(
        np.diff(t, append=2.0 * t[-1] - t[-2]), NEIGHBOURS, mode="nearest"
    )
    order = np.argsort(interval, kind="stable")
    rates = np.empty(t.size, int)
    rates[order] = np.cumsum(np.diff(np.log(interval[order]), prepend=np.inf) > np.log(RATE_RATIO))
    return rates


def _misfits(t, y, weight, degree):
    """Return the weighted sums of squares (k,) about the best line or level of k runs."""
    total = weight.sum(axis=1)

    def centred(x):
        x = x - x[:, :1]
        return x - ((weight * x).sum(axis=1) / total)[:, None]

    y = centred(y)
    if degree:
        u = centred(t)
        y = y - ((weight * u * y).sum(axis=1) / (weight * u * u).sum(axis=1))[:, None] * u
    return (weight * y * y).sum(axis=1)
