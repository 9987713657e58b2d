"""Whether falls of the shear stress are stick-slip, or no more than noise that wanders.

Noise has no direction of time: it falls as slowly as it rises, and at any time.  Stick-slip falls
faster than the load point loads the spring, or it is regular.
"""

import math

import numpy as np
from scipy.stats import mannwhitneyu

#: probability of falls as short as these beside the rises, if they are noise, that is too small
CHANCE = 0.02
#: fewest falls for such a test; of fewer each must be this much shorter than the rise before it,
#: as steep as its middle half is: its ends are round, or lost in the noise
FEWEST, SHORTER = 4, 0.1
#: standard deviation of the times between falls, over their mean, of what is regular: of a few
#: falls, and from `MANY` on
REGULAR, MANY = (0.1, 0.25), 8


def is_stick_slip(series, rough):
    """Whether `Rough` events of a record are no noise, by their times."""
    whole = [one for one in rough if min(one) >= 0]
    peaks, troughs = (series.t[np.array([one[i] for one in whole], int)] for i in (0, 1))
    starts = np.concatenate([series.t[:1], troughs[:-1]])[: peaks.size]
    # after a change of V_lp stress moves by itself
    changes = np.concatenate([[-math.inf], series.load.t])
    changed = changes[np.searchsorted(series.load.t, peaks, side="right")]
    halves = np.array([_half(series, one) for one in whole])
    return are_stick_slip(np.maximum(starts, changed), peaks, troughs, halves)


def _half(series, rough):
    """How long the middle half of the drop of a whole `Rough` event takes [s]; a step at least."""
    t, y = (x[rough.peak : rough.trough + 1] for x in (series.t, series.tau))
    below, quarter = 0.5 * (y[0] + y[-1]) - y, 0.25 * (y[0] - y[-1])
    middle = int(np.argmax(below > 0.0))
    each = np.gradient(t)  # time that a sample stands for
    return max(float(each[np.abs(below) < quarter].sum()), float(t[middle] - t[middle - 1]))


def are_stick_slip(starts, peaks, troughs, halves):
    """Whether falls between peaks and troughs, (m,) times each, are stick-slip by their times.

    starts : (m,) times from which stress rises to each peak: the trough before, or later
    halves : (m,) how long the middle half of each drop takes
    """
    falls, rises = troughs - peaks, peaks - starts
    if falls.size >= FEWEST and mannwhitneyu(falls, rises, alternative="less").pvalue < CHANCE:
        return True
    intervals = np.diff(0.5 * (peaks + troughs))
    if intervals.size > 1 and intervals.std() < REGULAR[falls.size >= MANY] * intervals.mean():
        return True
    return 0 < falls.size < FEWEST and bool((2.0 * halves < SHORTER * rises).all())
