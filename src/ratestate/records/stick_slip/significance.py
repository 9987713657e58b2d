"""Whether falls of the shear stress are stick-slip, or no more than noise that wanders.

Noise has no direction of time: it falls as slowly as it rises, and at any time.  Stick-slip falls
faster than the load point loads the spring, or it is regular.
"""

import numpy as np
from scipy.stats import mannwhitneyu

#: probability of falls as short as these beside the rises, if they are noise, that is too small
CHANCE = 0.02
#: fewest falls for such a test; of fewer each must be this much shorter than the rise before it
FEWEST, SHORTER = 4, 0.1
#: standard deviation of the times between falls, over their mean, of what is regular: of a few
#: falls, and from `MANY` on
REGULAR, MANY = (0.1, 0.25), 8


def are_stick_slip(starts, peaks, troughs):
    """Whether falls between peaks and troughs, (m,) times each, are stick-slip by their times.

    starts : (m,) times from which stress rises to each peak: the trough before, or later
    """
    falls, rises = troughs - peaks, peaks - starts
    if falls.size >= FEWEST and mannwhitneyu(falls, rises, alternative="less").pvalue < CHANCE:
        return True
    intervals = np.diff(0.5 * (peaks + troughs))
    if intervals.size > 1 and intervals.std() < REGULAR[falls.size >= MANY] * intervals.mean():
        return True
    return 0 < falls.size < FEWEST and bool((falls < SHORTER * rises).all())
