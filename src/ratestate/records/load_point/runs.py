"""Straight lines through the runs of a record, their intersections and standard errors."""

import itertools
import math

import numpy as np

from ..kit.sample_noise import OF_STEP
from .splits import GAP_ROWS

MAX_ROUNDS = 50  # rounds of moving rows from one line to the next
MIN_RATE_ROWS = 400  # fewest rows at a sampling rate from which its correlation is estimated
JUMP_SIGMAS = 4.0  # least jump, as a multiple of the standard deviation of the rows beside it
ROUNDING_TERMS = 10  # terms of the Fourier series of an error of rounding


class SpeedRun:
    """Rows of a record at one speed, and the parallel lines that fit them best.

    samples : `RowSums` of all rows of the record
    rows : list of (first, last + 1) of each line; there are several if the displacement jumps
    hold : whether V = 0 exactly

    `V` [m/s] is the slope, fitted with weights 1/noise.  `start` and `end` [s] are the times of the
    first and the last row.
    """

    def __init__(self, samples, rows, hold=False):
        self.samples, self.rows, self.hold = samples, rows, hold
        self.t, x, noise = samples.t, samples.x, samples.noise
        self.first, self.last = rows[0][0], rows[-1][1]
        self.start, self.end = self.t[self.first], self.t[self.last - 1]
        self.means, self.weights = [], []  # of each line: mean t and x, total weight
        self.spread, products = 0.0, 0.0  # sums of squares of t about the means; of t times x
        for i, j in rows:
            weight = 1.0 / noise[i:j]
            total = float(weight.sum())
            mean_t, mean_x = (float((y[i:j] * (weight / total)).sum()) for y in (self.t, x))
            u = self.t[i:j] - mean_t
            self.spread += float(weight @ (u * u))
            products += float((weight * u) @ (x[i:j] - mean_x))
            self.means.append((mean_t, mean_x))
            self.weights.append(total)
        self.V = products / self.spread if self.spread > 0.0 and not hold else 0.0

    def join(self, other, hold=False):
        """Return one run of the rows of both runs; the lines keep their own offsets."""
        return SpeedRun(self.samples, self.rows + other.rows, hold)

    def x_at(self, t, end):
        """Return the displacement [m] at t [s] on the first (end = 0) or last (end = -1) line."""
        mean_t, mean_x = self.means[end]
        return mean_x + self.V * (t - mean_t)

    def x_variance(self, t, end):
        """Return the variance [m^2] of `x_at` for the noise in `samples`."""
        mean = 1.0 / self.weights[end]
        return mean if self.hold else mean + (t - self.means[end][0]) ** 2 / self.spread

    def select_rows(self, values):
        """Return the elements of values (n,) at the rows of this run: (rows,)."""
        return np.concatenate([values[i:j] for i, j in self.rows])

    def whitened_residuals(self):
        """Return (rows,) residuals divided by the standard deviation of the noise."""
        lines = zip(self.rows, self.means, strict=True)
        x = self.samples.x
        parts = [x[i:j] - mean - self.V * (self.t[i:j] - t) for (i, j), (t, mean) in lines]
        return np.concatenate(parts) / np.sqrt(self.select_rows(self.samples.noise))


def breakpoints(runs):
    """Return when each run meets the next, and the uncertain spans: (runs - 1,) each, in s.

    Usually the lines intersect, and the span is 0.  If they do not intersect near their rows, the
    time is midway between the two rows.  If the displacement jumps there, the time is also midway,
    and the span is the interval between the rows.  In a gap in time, an intersection that lies
    beyond the gap by no more than the noise is moved to the end of the gap.  If it lies farther
    beyond, the time is the middle of the gap, and the span is the length of the gap.
    """
    times, spans = [], []
    for run, after in itertools.pairwise(runs):
        middle = 0.5 * (run.end + after.start)
        change = run.V - after.V
        gap = after.x_at(middle, 0) - run.x_at(middle, -1)
        meet = middle + gap / change if change else middle
        is_close = run.t[run.rows[-1][0]] < meet < run.t[after.rows[0][1] - 1]
        span = 0.0
        if jump_between(run, after):
            is_close, span = False, after.start - run.end
        if is_gap(run, after):
            inside = min(max(meet, run.end), after.start)
            steps = run.t[run.last - 1] - run.t[run.last - 2], run.t[after.first + 1] - after.start
            error = math.sqrt(run.x_variance(run.end, -1) + after.x_variance(after.start, 0))
            is_close = abs(meet - inside) <= max(steps) + JUMP_SIGMAS * error / abs(change)
            meet, span = inside, 0.0 if is_close else after.start - run.end
        times.append(float(meet if is_close else middle))
        spans.append(span)
    return np.array(times), np.array(spans)


def jump_between(before, after):
    """Return the signed jump [m] between neighbouring runs at two speeds; 0 if none.

    It is the part of the displacement from row to row that neither speed explains.
    """
    samples, row = before.samples, after.first
    if before.last != row or is_gap(before, after):
        return 0.0
    distance, duration = (float(y[row] - y[row - 1]) for y in (samples.x, samples.t))
    low, high = sorted((before.V * duration, after.V * duration))
    jump = distance - min(max(distance, low), high)
    noise = float(samples.noise[row - 1] + samples.noise[row])
    return jump if abs(jump) > max(JUMP_SIGMAS * math.sqrt(noise), abs(high - low)) else 0.0


def is_gap(before, after):
    return before.last == after.first and after.first in before.samples.gaps


def refine_breakpoints(runs):
    """Return the runs (list) refitted until each row is on its side of the breakpoints.

    This solves the joint least-squares problem of breakpoints and lines.  Rows of a ramp between
    two runs belong to neither.  It stops after `MAX_ROUNDS` rounds.
    """
    samples, visited = runs[0].samples, set()
    for _ in range(MAX_ROUNDS):
        rows = [[*run.rows] for run in runs]
        for m, edge in enumerate(np.searchsorted(samples.t, breakpoints(runs)[0]).tolist()):
            (first, last), (start, end) = rows[m][-1], rows[m + 1][0]
            if last == start and first + 2 <= edge <= end - 2:
                rows[m][-1], rows[m + 1][0] = (first, edge), (edge, end)
        places = tuple(spans[0][0] for spans in rows)
        if rows == [run.rows for run in runs] or places in visited:
            break
        visited.add(places)
        runs = [SpeedRun(samples, spans, run.hold) for spans, run in zip(rows, runs, strict=True)]
    return runs


def noise_variances(runs):
    """Return the factor (list) by which to multiply the variances of each run's estimates.

    It is the variance of the whitened residuals times the sum of their correlations over all lags.
    That sum is estimated at the run's sampling rate, or in the whole record if the rate has fewer
    than `MIN_RATE_ROWS` rows, as the larger of two estimates: from neighbouring rows, and from the
    scatter of means over 2, 4, 8, ... rows.
    """
    residuals = [run.whitened_residuals() for run in runs]
    parameters = [len(run.rows) + (not run.hold) for run in runs]
    # a line through two rows leaves no residual: its noise is taken from `samples`
    levels = [
        float(r @ r) / (r.size - n) if r.size > n else 1.0
        for r, n in zip(residuals, parameters, strict=True)
    ]
    unit = np.concatenate([r / (s**0.5 or 1.0) for r, s in zip(residuals, levels, strict=True)])
    rates = [run.select_rows(run.samples.rates) for run in runs]
    of_all = np.concatenate(rates)
    parts = [unit[of_all == rate] for rate in range(of_all.max() + 1)]
    factors = np.array([_correlation_factor(p if p.size >= MIN_RATE_ROWS else unit) for p in parts])
    return [level * factors[of_run].mean() for level, of_run in zip(levels, rates, strict=True)]


def rounding_variances(runs):
    """Return the variance [m^2] of the offset of each run due to the rounding of its rows.

    Notes
    -----
    The error of rounding is a Fourier series in the displacement between two digits.  Noise before
    the rounding reduces its terms, and so does the mean over rows at different places between two
    digits.  In a hold, all rows have the same error.
    """
    digit = runs[0].samples.digit
    if digit == 0.0:
        return [0.0] * len(runs)
    places, noises = [], []
    for run in runs:
        residuals = run.whitened_residuals() * np.sqrt(run.select_rows(run.samples.noise))
        places.append((run.select_rows(run.samples.x) - residuals) / digit)
        noises.append(float(residuals.var()) / digit**2)
    k = 2.0 * np.pi * np.arange(1, ROUNDING_TERMS + 1)
    variances = []
    for place, noise in zip(places, noises, strict=True):
        # rows that alternate between two digits do not show their noise, but other runs may
        before_rounding = max(0.0, (noise if noise > 0.25 else min(noises)) - OF_STEP**2)
        means = np.array([abs(np.exp(1j * factor * place).mean()) for factor in k])
        terms = 2.0 * means**2 * np.exp(-before_rounding * k**2) / k**2
        variances.append(digit**2 * float(terms.sum()))
    return variances


def _correlation_factor(unit):
    """Return the sum over all lags of the correlations of values of unit variance, at least 1."""
    lag_one = min(0.99, float(unit[1:] @ unit[:-1]) / (float(unit @ unit) or 1.0))
    factors = [1.0, (1.0 + lag_one) / (1.0 - lag_one)]
    batch = 2
    while batch <= unit.size // 20:
        means = unit[: unit.size // batch * batch].reshape(-1, batch).mean(axis=1)
        factors.append(batch * float(means @ means) / means.size)
        batch *= 2
    return max(factors)


def jump_size(rows, row, V):
    """Return the signed jump [m] of the displacement of `RowSums` before a row; 0 if none.

    V : speed [m/s] before and after the jump
    """
    # only rows up to the next gap in time count
    ends = [0, *rows.gaps, rows.t.size]
    first = max(row - GAP_ROWS, max(end for end in ends if end < row))
    last = min(row + GAP_ROWS, min(end for end in ends if end > row))
    x = rows.x[first:last] - V * (rows.t[first:last] - rows.t[row])
    before, after = x[: row - first], x[row - first :]
    gap = float(np.median(after) - np.median(before))
    scatter = math.sqrt(0.5 * (before.var() + after.var()))
    return gap if abs(gap) > JUMP_SIGMAS * scatter else 0.0
