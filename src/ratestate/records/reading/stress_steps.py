"""Steps and ramps of normal stress in a record."""

import itertools
from typing import NamedTuple

import numpy as np

from ...errors import ParameterError
from .runs import Run, Samples
from .sampling_noise import SHORTEST
from .splits import RowSums, cut

#: standard deviation, or change between levels, over the mean, from which a normal stress varies
VARIABLE = 0.01
#: least time at one level, over the time that the change to the next level takes
REST = 2.0
#: rows of a change whose ends lines do not tell, and part of the change that is outside of it
SUDDEN, EDGE = 2 * SHORTEST, 0.05


class StressStep(NamedTuple):
    """A change of normal stress from one level to another, at once or by a ramp."""

    t: float  # when it begins [s]
    before: float  # mean levels [Pa]
    after: float
    end: float  # [s]; `t` if it happens between two rows


class _Level(NamedTuple):
    """A run of rows in which normal stress stays within 1 %."""

    begin: float  # midway between its first row and the row before [s]
    end: float
    sigma: float  # mean [Pa]


def varies(sigma):
    """Whether a normal stress (n,) is positive everywhere, finite, and varies."""
    return bool(_is_stress(sigma) and sigma.std() > VARIABLE * sigma.mean())


def stress_steps(time, sigma):
    """`StressStep`s (list) of a record of normal stress.

    time, sigma : (n,) arrays [s], [Pa]

    Normal stress rests at each level for `REST` times as long as the change between them takes.
    """
    levels = [_level(run) for run in _lines(time, sigma) if _change(run) <= VARIABLE]
    while levels and min(rests := [*map(_rest, levels, *_beside(levels))]) < REST:
        del levels[int(np.argmin(rests))]
    return [
        _between(time, sigma, one, other)
        for one, other in itertools.pairwise(levels)
        if abs(other.sigma - one.sigma) > VARIABLE * one.sigma
    ]


def _between(time, sigma, one, other):
    """The `StressStep` between two levels."""
    begin, end = one.end, other.begin
    rows = np.arange(*np.searchsorted(time, (begin, end))) if end > begin else np.array([], int)
    if 0 < rows.size <= SUDDEN:
        part = (sigma[rows] - one.sigma) / (other.sigma - one.sigma)
        # rows up to the first that leaves one level, and from the last that is not at the other
        edges = time[rows[0] - 1 : rows[-1] + 2]
        edges = 0.5 * (edges[1:] + edges[:-1])
        before = int(np.argmax(np.append(part > EDGE, True)))
        after = rows.size - int(np.argmax(np.append(part[::-1] < 1.0 - EDGE, True)))
        begin, end = edges[before], edges[max(before, after)]
    return StressStep(float(begin), one.sigma, other.sigma, float(end))


def stress_range(time, sigma):
    """Return the range of a normal stress (n,) over its mean, without its noise; 0 if unknown."""
    ends = [run.at(t, end) for run in _lines(time, sigma) for t, end in _ends(run)]
    return float(np.ptp(ends) / sigma.mean()) if ends else 0.0


def _lines(time, sigma):
    """`Run`s (list) on each of which a line fits; none if it does not vary, or without end."""
    if not _is_stress(sigma) or np.ptp(sigma) <= VARIABLE * sigma.mean():
        return []
    rows = RowSums(time, sigma)
    try:
        cuts = cut(rows)
    except ParameterError:  # too many
        return []
    samples = Samples(time, sigma, rows.noise, rows.rates)
    return [Run(samples, [two]) for two in itertools.pairwise(rows.at[cuts].tolist())]


def _ends(run):
    return (run.start, 0), (run.end, -1)


def _change(run):
    """Change of a quantity along its line, over its mean."""
    return abs(run.V) * (run.end - run.start) / run.means[0][1]


def _level(run):
    t, (first, last) = run.t, run.rows[0]
    begin = 0.5 * (t[first] + t[max(first - 1, 0)])
    end = 0.5 * (t[last - 1] + t[min(last, t.size - 1)])
    return _Level(float(begin), float(end), float(run.means[0][1]))


def _beside(levels):
    """For each of n levels the one before, and the one after: itself at either end."""
    return [*levels[:1], *levels[:-1]], [*levels[1:], *levels[-1:]]


def _rest(level, before, after):
    """Time at a level over that of the longer change beside it."""
    change = max(level.begin - before.end, after.begin - level.end)
    return (level.end - level.begin) / change if change > 0.0 else np.inf


def _is_stress(sigma):
    return np.isfinite(sigma).all() and (sigma > 0.0).all()
