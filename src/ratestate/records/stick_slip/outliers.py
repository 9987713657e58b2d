"""Samples that stand out of a record by themselves: friction is back at once where it was."""

import numpy as np

#: most samples of an outlier; samples on either side of it that it stands out of
LONGEST, SIDE = 2, 2
#: standard deviations of the noise by which it stands out of them
OUT = 5.0


def without_outliers(y, noise):
    """A series (n,) with a line in place of each outlier beyond noise of this standard deviation.

    An outlier stands out of the samples on both its sides, by more than these differ: after a drop
    stress is not back where it was, and a steep loading moves on.
    """
    y = y.copy()
    for length in range(1, LONGEST + 1):
        padded = np.pad(y, SIDE, mode="edge")
        parts = np.lib.stride_tricks.sliding_window_view(padded, length + 2 * SIDE)
        sides, inside = np.delete(parts, np.s_[SIDE:-SIDE], axis=1), parts[:, SIDE:-SIDE]
        low, high = sides.min(axis=1), sides.max(axis=1)
        out = np.maximum(inside.min(axis=1) - high, low - inside.max(axis=1))
        for i in np.flatnonzero((out > OUT * noise) & (out > high - low)):
            y[i : i + length] = np.linspace(padded[i + 1], padded[i + 2 + length], length + 2)[1:-1]
    return y
