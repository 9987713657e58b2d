"""Straight lines through the runs of a record, and their intersections with their errors."""

import itertools
import math

import numpy as np

from .splits import NEAR

ROUNDS = 50  # of moving rows from one line to the next
MANY = 400  # rows that tell the correlation of their noise
JUMP = 4.0  # least jump, over the standard deviation of these rows


class Run:
    """Rows of a record at one speed, and the lines of this slope that fit them best.

    samples : `RowSums` of all rows of the record
    rows : list of (first, last + 1), for each line: several if the displacement jumps in between
    hold : whether V = 0 exactly

    `V` [m/s] is the slope, from rows that weigh as much as their noise is low; `start` and `end`
    [s] are the times of the first and the last row.
    """

    def __init__(self, samples, rows, hold=False):
        self.samples, self.rows, self.hold = samples, rows, hold
        self.t, x, noise = samples.t, samples.x, samples.noise
        self.first, self.last = rows[0][0], rows[-1][1]
        self.start, self.end = self.t[self.first], self.t[self.last - 1]
        self.means, self.weights = [], []  # of t and x, and their total weights
        self.spread, along = 0.0, 0.0  # sums of squares of t about the means; of products
        for i, j in rows:
            weight = 1.0 / noise[i:j]
            total = float(weight.sum())
            mean_t, mean_x = (float((y[i:j] * (weight / total)).sum()) for y in (self.t, x))
            u = self.t[i:j] - mean_t
            self.spread += float(weight @ (u * u))
            along += float((weight * u) @ (x[i:j] - mean_x))
            self.means.append((mean_t, mean_x))
            self.weights.append(total)
        self.V = along / self.spread if self.spread > 0.0 and not hold else 0.0

    def joined(self, other, hold=False):
        """This run and another as one, with lines of its own for each."""
        return Run(self.samples, self.rows + other.rows, hold)

    def at(self, t, end):
        """Displacement [m] at time t [s] by the first line (end = 0) or the last one (end = -1)."""
        mean_t, mean_x = self.means[end]
        return mean_x + self.V * (t - mean_t)

    def variance(self, t, end):
        """Variance of what `at` gives, with noise as stated [m^2]."""
        mean = 1.0 / self.weights[end]
        return mean if self.hold else mean + (t - self.means[end][0]) ** 2 / self.spread

    def of_rows(self, values):
        """(rows,) of values (n,) those at its rows."""
        return np.concatenate([values[i:j] for i, j in self.rows])

    def whitened(self):
        """(rows,) displacement less the lines, over the standard deviation of the noise."""
        lines = zip(self.rows, self.means, strict=True)
        x = self.samples.x
        parts = [x[i:j] - mean - self.V * (self.t[i:j] - t) for (i, j), (t, mean) in lines]
        return np.concatenate(parts) / np.sqrt(self.of_rows(self.samples.noise))


def breakpoints(runs):
    """Times [s] at which each run meets the next, and how long they are open [s]: (runs - 1,) each.

    Midway between if they hardly meet.  If the displacement jumps there, anywhere between the two
    rows.  In a gap in time, at its end if they meet beyond it by no more than noise; else anywhere:
    the middle of the gap, open for as long as it lasts.
    """
    times, spans = [], []
    for one, other in itertools.pairwise(runs):
        middle = 0.5 * (one.end + other.start)
        change = one.V - other.V
        meet = middle + (other.at(middle, 0) - one.at(middle, -1)) / change if change else middle
        near = one.t[one.rows[-1][0]] < meet < one.t[other.rows[0][1] - 1]
        span = 0.0
        if jump_between(one, other):
            near, span = False, other.start - one.end
        if is_gap(one, other):
            inside = min(max(meet, one.end), other.start)
            steps = one.t[one.last - 1] - one.t[one.last - 2], one.t[other.first + 1] - other.start
            error = math.sqrt(one.variance(one.end, -1) + other.variance(other.start, 0))
            near = abs(meet - inside) <= max(steps) + JUMP * error / abs(change)
            meet, span = inside, 0.0 if near else other.start - one.end
        times.append(float(meet if near else middle))
        spans.append(span)
    return np.array(times), np.array(spans)


def jump_between(one, other):
    """Jump [m], of either sign, between runs at two speeds that are next to each other; 0 if none.

    It is the part of the move from row to row that neither speed explains.
    """
    samples, row = one.samples, other.first
    if one.last != row or is_gap(one, other):
        return 0.0
    moved, lasts = (float(y[row] - y[row - 1]) for y in (samples.x, samples.t))
    low, high = sorted((one.V * lasts, other.V * lasts))
    jump = moved - min(max(moved, low), high)
    noise = float(samples.noise[row - 1] + samples.noise[row])
    return jump if abs(jump) > max(JUMP * math.sqrt(noise), abs(high - low)) else 0.0


def is_gap(one, other):
    """Whether there is a gap in time between runs."""
    return one.last == other.first and other.first in one.samples.gaps


def refine_breakpoints(runs):
    """list of the runs with each row on its own side of the breaks: the joint least squares.

    Rows between runs that belong to neither, of a ramp, stay so; it ends after `ROUNDS` at most.
    """
    samples, seen = runs[0].samples, set()
    for _ in range(ROUNDS):
        rows = [[*run.rows] for run in runs]
        for m, edge in enumerate(np.searchsorted(samples.t, breakpoints(runs)[0]).tolist()):
            (first, last), (start, end) = rows[m][-1], rows[m + 1][0]
            # rows between neighbours that belong to neither (a ramp) stay so
            if last == start and first + 2 <= edge <= end - 2:
                rows[m][-1], rows[m + 1][0] = (first, edge), (edge, end)
        places = tuple(own[0][0] for own in rows)
        if rows == [run.rows for run in runs] or places in seen:
            break
        seen.add(places)
        runs = [Run(samples, own, run.hold) for own, run in zip(rows, runs, strict=True)]
    return runs


def noise_variances(runs):
    """For each run the variance, over that stated, of the white noise of its errors: list."""
    # The variance of its rows, times a factor for correlation at their sampling rate, or in the
    # record as a whole if the rate has fewer than `MANY` rows: the sum of the correlations over all
    # lags, from neighbouring rows or from the scatter of means over 2, 4, 8, ... rows; whichever is
    # larger.
    residuals = [run.whitened() for run in runs]
    parameters = [len(run.rows) + (not run.hold) for run in runs]
    # (two rows tell nothing of it: as stated)
    levels = [
        float(r @ r) / (r.size - n) if r.size > n else 1.0
        for r, n in zip(residuals, parameters, strict=True)
    ]
    unit = np.concatenate([r / (s**0.5 or 1.0) for r, s in zip(residuals, levels, strict=True)])
    rates = [run.of_rows(run.samples.rates) for run in runs]
    of_all = np.concatenate(rates)
    parts = [unit[of_all == rate] for rate in range(of_all.max() + 1)]
    factors = np.array([_correlation_factor(p if p.size >= MANY else unit) for p in parts])
    return [level * factors[own].mean() for level, own in zip(levels, rates, strict=True)]


def _correlation_factor(unit):
    """Sum of the correlations of values (n,) of unit variance over all lags, 1 at least."""
    next_ = min(0.99, float(unit[1:] @ unit[:-1]) / (float(unit @ unit) or 1.0))
    factors = [1.0, (1.0 + next_) / (1.0 - next_)]
    batch = 2
    while batch <= unit.size // 20:
        means = unit[: unit.size // batch * batch].reshape(-1, batch).mean(axis=1)
        factors.append(batch * float(means @ means) / means.size)
        batch *= 2
    return max(factors)


def jump_size(rows, row, V):
    """Jump [m], of either sign, of the displacement of `RowSums` before a row, at speed V [m/s].

    0 if there is none.
    """
    # what is beyond another gap in time has no part in it
    ends = [0, *rows.gaps, rows.t.size]
    first = max(row - NEAR, max(end for end in ends if end < row))
    last = min(row + NEAR, min(end for end in ends if end > row))
    x = rows.x[first:last] - V * (rows.t[first:last] - rows.t[row])
    before, after = x[: row - first], x[row - first :]
    gap = float(np.median(after) - np.median(before))
    scatter = math.sqrt(0.5 * (before.var() + after.var()))
    return gap if abs(gap) > JUMP * scatter else 0.0
