"""Steps and ramps of normal stress in a record."""

import itertools
from typing import NamedTuple

import numpy as np

from ...errors import ParameterError
from ..kit.sample_noise import OF_SECOND
from .runs import Run
from .splits import SHORTEST, RowSums, cut

#: change of a normal stress, as a multiple of its mean, from which it varies
VARIABLE = 0.01
#: least time at one level, over the time that the change to the next level takes
REST = 2.0
#: rows of a change whose ends lines do not tell, and part of the change that is outside of it
SUDDEN, EDGE = 2 * SHORTEST, 0.05
#: fewest and most means of rows; their range, as a multiple of the range of white noise, beyond 1/f
FEWEST, MOST, BEYOND = 16, 1000, 2.4
#: standard deviation of normal noise, over the mean of its size
OF_MEAN = (0.5 * np.pi) ** 0.5


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


def stress_steps(time, sigma):
    """`StressStep`s (list) of a record of normal stress.

    time, sigma : (n,) arrays [s], [Pa]

    Normal stress rests at each level for `REST` times as long as the change between them takes.
    """
    if not _is_stress(sigma) or np.ptp(sigma) <= VARIABLE * sigma.mean():
        return []
    rows = RowSums(time, sigma)
    try:
        places = rows.at[cut(rows)].tolist()
    except ParameterError:  # it varies without end
        return []
    runs = [Run(rows, [two]) for two in itertools.pairwise(places)]
    slow = [r for r in runs if abs(r.V) * (r.end - r.start) <= VARIABLE * r.means[0][1]]
    edges = np.concatenate([time[:1], 0.5 * (time[1:] + time[:-1]), time[-1:]])
    levels = [_Level(edges[r.first], edges[r.last], r.means[0][1]) for r in slow]
    while levels and min(rests := _rests(levels)) < REST:
        del levels[int(np.argmin(rests))]
    return [
        _between(time, sigma, one, other)
        for one, other in itertools.pairwise(levels)
        if abs(other.sigma - one.sigma) > VARIABLE * one.sigma
    ]


def _between(time, sigma, one, other):
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


def stress_range(data, rows=slice(None)):
    """Return the range of normal stress beyond its noise, as a multiple of its mean.

    data : a Dataset; rows : those of ``time`` that count

    It is 0 if the range is only noise, or if no positive normal stress is recorded along ``time``.
    Rows without one are left out.

    Notes
    -----
    The range is the largest one of means over more and more rows, less what white noise adds.  The
    noise of the means is the least that second differences show for these or fewer rows: a sinusoid
    adds to it only near its period, white noise falls, and noise of 1/f stays the same.
    """
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return 0.0
    sigma = np.asarray(data["sigma"].values, float)[rows]
    sigma = sigma[np.isfinite(sigma)]
    if not _is_stress(sigma):
        return 0.0
    largest, noise, rows = 0.0, np.inf, max(sigma.size // MOST, 1)
    while sigma.size >= FEWEST * rows:
        means = sigma[: sigma.size // rows * rows].reshape(-1, rows).mean(axis=1)
        noise = min(noise, np.abs(np.diff(means, 2)).mean() * OF_MEAN / OF_SECOND)
        by_noise = 2.0 * np.sqrt(2.0 * np.log(means.size)) * noise
        if np.ptp(means) > BEYOND * by_noise:
            largest = max(largest, np.ptp(means) - by_noise)
        rows *= 2
    return float(largest / sigma.mean())


def _rests(levels):
    """(n,) times at n levels, as multiples of the longer change beside each; inf without one."""
    begin, end, _ = np.transpose(levels)
    changes = np.concatenate([[0.0], begin[1:] - end[:-1], [0.0]])
    longer = np.maximum(changes[:-1], changes[1:])
    return np.where(longer > 0.0, (end - begin) / np.where(longer > 0.0, longer, 1.0), np.inf)


def _is_stress(sigma):
    return np.isfinite(sigma).all() and (sigma > 0.0).all()
