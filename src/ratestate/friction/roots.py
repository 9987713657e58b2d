"""Roots of increasing functions of arrays, most of them nearly linear, as friction is in ln V."""

import numpy as np


def root(off, start, where):
    """The root (n,) of an increasing function; not finite where none is found.

    off : of (n,), giving (n,)
    start : (n,) near the root
    where : (n,) whether the root matters
    """
    with np.errstate(all="ignore"):  # (where it does not matter there may be no root)
        found, slope = start, off(start + 1.0) - off(start)
        for _ in range(2):  # (the second makes up for the rounding of the slope)
            found = found - off(found) / slope
        wrong = where & ~(np.abs(off(found)) <= 1e-11 * np.maximum(1.0, np.abs(found)))
    return np.where(wrong, _bisected(off, start), found) if wrong.any() else found


def _bisected(off, start):
    """`root` of functions that are not nearly linear."""
    low, high = start - 1.0, start + 1.0
    with np.errstate(all="ignore"):
        for width in 2.0 ** np.arange(12):
            low = np.where(off(low) > 0.0, low - width, low)
            high = np.where(off(high) < 0.0, high + width, high)
        inside = (off(low) <= 0.0) & (off(high) >= 0.0)
        for _ in range(70):
            middle = 0.5 * (low + high)
            below = off(middle) < 0.0
            low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.where(inside, 0.5 * (low + high), np.nan)
