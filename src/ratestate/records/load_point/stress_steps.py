"""Find steps and ramps of normal stress in a record."""

import itertools
from typing import NamedTuple

import numpy as np

from ...errors import ParameterError
from ..kit.sample_noise import OF_SECOND
from .runs import SpeedRun
from .splits import MIN_RUN_ROWS, RowSums, find_cuts

#: largest change of a constant normal stress, as a fraction of its mean
VARIABLE = 0.01
#: least time at one level, as a multiple of the duration of the change beside it
MIN_REST = 2.0
#: most rows of a change that is too short to fit lines to; the part of the change before it begins,
#: and after it ends
SUDDEN_ROWS, EDGE_PART = 2 * MIN_RUN_ROWS, 0.05
#: fewest and most means of rows; least range of the means, as a multiple of the range of white
#: noise, that is not 1/f noise
MIN_MEANS, MAX_MEANS, RANGE_RATIO = 16, 1000, 2.4
#: standard deviation of Gaussian noise divided by its mean absolute value
SD_PER_MEAN_SIZE = (0.5 * np.pi) ** 0.5


class StressStep(NamedTuple):
    """A change of normal stress from one level to another, as a step or a ramp."""

    t: float  # begin of the change [s]
    before: float  # mean level before it [Pa]
    after: float  # mean level after it [Pa]
    end: float  # end of the change [s]; equals `t` if it happens between two rows


def stress_steps(time, sigma):
    """Return the `StressStep`s (list) of a record of normal stress.

    time, sigma : (n,) arrays [s], [Pa]

    A level lasts at least `MIN_REST` times as long as each change beside it.
    """
    if not _is_positive(sigma) or np.ptp(sigma) <= VARIABLE * sigma.mean():
        return []
    rows = RowSums(time, sigma)
    try:
        places = rows.at[find_cuts(rows)].tolist()
    except ParameterError:  # too many changes
        return []
    runs = [SpeedRun(rows, [ends]) for ends in itertools.pairwise(places)]
    slow = [r for r in runs if abs(r.V) * (r.end - r.start) <= VARIABLE * r.means[0][1]]
    # levels from midway before their first row to midway after their last, and their means
    edges = np.concatenate([time[:1], 0.5 * (time[1:] + time[:-1]), time[-1:]])
    levels = [(edges[r.first], edges[r.last], r.means[0][1]) for r in slow]
    while levels and min(rests := _relative_rests(levels)) < MIN_REST:
        del levels[int(np.argmin(rests))]
    return [
        _step_between(time, sigma, begin, before, after, end)
        for (_, begin, before), (end, _, after) in itertools.pairwise(levels)
        if abs(after - before) > VARIABLE * before
    ]


def _step_between(time, sigma, begin, before, after, end):
    """Return the `StressStep` between two levels; `begin` and `end` may be too far apart."""
    rows = np.arange(*np.searchsorted(time, (begin, end))) if end > begin else np.array([], int)
    if 0 < rows.size <= SUDDEN_ROWS:
        part = (sigma[rows] - before) / (after - before)
        # from the first row that has left one level to the last that has not reached the other
        edges = time[rows[0] - 1 : rows[-1] + 2]
        edges = 0.5 * (edges[1:] + edges[:-1])
        first = int(np.argmax(np.append(part > EDGE_PART, True)))
        last = rows.size - int(np.argmax(np.append(part[::-1] < 1.0 - EDGE_PART, True)))
        begin, end = edges[first], edges[max(first, last)]
    return StressStep(float(begin), before, after, float(end))


def stress_range(data, rows=slice(None)):
    """Return the range of normal stress beyond its noise, as a multiple of its mean.

    data : Dataset
    rows : slice of the samples to use

    The range is 0 if it is only noise, or if no positive normal stress is recorded along ``time``.
    Samples without a finite normal stress are left out.

    Notes
    -----
    Means are taken over 1, 2, 4, ... rows.  The result is the largest range of the means, minus the
    range that white noise adds.  The noise of the means is estimated from their second differences,
    as the least value for this or fewer rows.  A sinusoid adds to the second differences only near
    its period.  With more rows, white noise decreases and 1/f noise stays constant.
    """
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return 0.0
    sigma = np.asarray(data["sigma"].values, float)[rows]
    sigma = sigma[np.isfinite(sigma)]
    if not _is_positive(sigma):
        return 0.0
    largest, noise, rows = 0.0, np.inf, max(sigma.size // MAX_MEANS, 1)
    while sigma.size >= MIN_MEANS * rows:
        means = sigma[: sigma.size // rows * rows].reshape(-1, rows).mean(axis=1)
        noise = min(noise, np.abs(np.diff(means, 2)).mean() * SD_PER_MEAN_SIZE / OF_SECOND)
        noise_range = 2.0 * np.sqrt(2.0 * np.log(means.size)) * noise
        if np.ptp(means) > RANGE_RATIO * noise_range:
            largest = max(largest, np.ptp(means) - noise_range)
        rows *= 2
    return float(largest / sigma.mean())


def _relative_rests(levels):
    """Return the duration of each level divided by the longer change beside it; inf if none."""
    begin, end, _ = np.transpose(levels)
    changes = np.concatenate([[0.0], begin[1:] - end[:-1], [0.0]])
    length = np.maximum(changes[:-1], changes[1:])
    return np.where(length > 0.0, (end - begin) / np.where(length > 0.0, length, 1.0), np.inf)


def _is_positive(sigma):
    return np.isfinite(sigma).all() and (sigma > 0.0).all()
