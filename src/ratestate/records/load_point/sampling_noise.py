"""The noise of a record as it affects cuts: at each sampling rate, and at each place.

A recorder that averages over its sampling interval leaves less noise at a lower rate.
"""

import numpy as np
import scipy  # `scipy.ndimage` is imported once it is used: it is slow

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
#: least variance of the noise, over the sum of squares of all values (rounding) and over the
#: largest variance at any rate (sums have no digits for more)
ROUNDING, QUIETEST = 1e-15, 1e-6


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
