"""Straight lines through the runs of a record, and their intersections with their errors."""

import itertools
import math
from typing import NamedTuple

import numpy as np

ROUNDS = 50  # of moving rows from one line to the next
NEAR = 10  # rows beside a place where a displacement may jump
JUMP = 4.0  # least jump, over the standard deviation of these rows


class Line(NamedTuple):
    """A line through rows first to last - 1, with their means."""

    first: int
    last: int
    t: float = 0.0
    x: float = 0.0


class Run(NamedTuple):
    """Rows at one speed: lines of one slope, several if the displacement jumps in between."""

    lines: tuple[Line, ...]
    hold: bool = False  # V = 0 exactly
    V: float = 0.0
    spread: float = 1.0  # sums of squares of t about the means

    @property
    def first(self):
        return self.lines[0].first

    @property
    def last(self):
        return self.lines[-1].last

    def at(self, t, end):
        """Displacement at time t by the first line (end = 0) or the last one (end = -1)."""
        return self.lines[end].x + self.V * (t - self.lines[end].t)

    def variance(self, t, end):
        """Variance of that, over the noise's."""
        line = self.lines[end]
        mean = 1.0 / (line.last - line.first)
        return mean if self.hold else mean + (t - line.t) ** 2 / self.spread

    def residual(self, t, x):
        """The displacement less the lines."""
        parts = [(slice(line.first, line.last), line) for line in self.lines]
        return np.concatenate([x[i] - line.x - self.V * (t[i] - line.t) for i, line in parts])


def fit_run(t, x, run):
    """A run with the slope and the lines that fit its rows best; levels for a hold."""
    lines, spread, along = [], 0.0, 0.0
    for line in run.lines:
        tt, xx = t[line.first : line.last], x[line.first : line.last]
        lines.append(Line(line.first, line.last, float(tt.mean()), float(xx.mean())))
        u = tt - lines[-1].t
        spread += float(u @ u)
        along += float(u @ (xx - lines[-1].x))
    V = along / spread if spread > 0.0 and not run.hold else 0.0
    return run._replace(lines=tuple(lines), V=V, spread=spread)


def breakpoints(t, runs):
    """Times at which each run meets the next one; midway between them if they hardly do."""
    times = []
    for one, other in itertools.pairwise(runs):
        middle = 0.5 * (t[one.last - 1] + t[other.first])
        change = one.V - other.V
        meet = middle + (other.at(middle, 0) - one.at(middle, -1)) / change if change else middle
        near = t[one.lines[-1].first] < meet < t[other.lines[0].last - 1]
        times.append(float(meet if near else middle))
    return np.array(times)


def refine_breakpoints(t, x, runs):
    """Runs with the rows that lie between their breaks: the joint least squares.

    Neighbours with rows between them that belong to neither (a ramp) keep them so.
    """
    runs = [fit_run(t, x, run) for run in runs]
    seen = set()
    for _ in range(ROUNDS):
        changed = list(runs)
        for m, edge in enumerate(np.searchsorted(t, breakpoints(t, runs)).tolist()):
            one, other = changed[m], changed[m + 1]
            *before, last = one.lines
            first, *after = other.lines
            if one.last == other.first and last.first + 2 <= edge <= first.last - 2:
                changed[m] = one._replace(lines=(*before, last._replace(last=edge)))
                changed[m + 1] = other._replace(lines=(first._replace(first=edge), *after))
        places = tuple(run.first for run in changed)
        if changed == runs or places in seen:
            break
        seen.add(places)
        runs = [fit_run(t, x, run) for run in changed]
    return runs


def noise_variances(t, x, runs):
    """Variance for each run of the white noise that would cause its errors.

    It is the variance of its rows, times a factor for correlation in the record as a whole: the sum
    of the correlations over all lags, from neighbouring rows, or from the scatter of means over
    2, 4, 8, ... rows (up to a twentieth of the record); whichever is larger.
    """
    residuals = [run.residual(t, x) for run in runs]
    parameters = [len(run.lines) + (not run.hold) for run in runs]
    levels = [float(r @ r) / max(1, r.size - n) for r, n in zip(residuals, parameters, strict=True)]
    unit = np.concatenate([r / (s**0.5 or 1.0) for r, s in zip(residuals, levels, strict=True)])
    next_ = min(0.99, float(unit[1:] @ unit[:-1]) / (float(unit @ unit) or 1.0))
    factors = [1.0, (1.0 + next_) / (1.0 - next_)]
    batch = 2
    while batch <= unit.size // 20:
        means = unit[: unit.size // batch * batch].reshape(-1, batch).mean(axis=1)
        factors.append(batch * float(means @ means) / means.size)
        batch *= 2
    return [max(factors) * level for level in levels]


def jump_size(t, x, row, V):
    """Jump of a displacement just before a row where it runs at speed V; 0 if there is none.

    A jump exceeds the scatter of the rows beside it; a machine that wanders does not.
    """
    x = x - V * (t - t[row])
    before, after = x[max(0, row - NEAR) : row], x[row : row + NEAR]
    gap = float(np.median(after) - np.median(before))
    scatter = math.sqrt(0.5 * (before.var() + after.var()))
    return gap if abs(gap) > JUMP * scatter else 0.0
