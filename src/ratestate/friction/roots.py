"""Roots of functions of arrays that are linear, or nearly so, as friction is in ln V."""

import warnings

import numpy as np


def root(off, start, where):
    """The root (n,) of a function, linear or nearly so; not finite where none is found.

    off : of (n,), giving (n,)
    start : (n,) near the root
    where : (n,) whether the root matters
    """
    with np.errstate(all="ignore"):  # (where it does not matter there may be no root)
        found, slope = start, off(start + 1.0) - off(start)
        for _ in range(2):  # (the second makes up for the rounding of the slope)
            found = found - off(found) / slope
        wrong = where & (np.abs(off(found)) > 1e-11 * np.maximum(1.0, np.abs(found)))
    if not wrong.any():
        return found
    from scipy.optimize import newton  # slow to import, and seldom needed

    guess = np.where(wrong & np.isfinite(found), found, start)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)  # of those that do not matter
        try:
            found, converged, _ = newton(off, guess, tol=1e-13, full_output=True)
        except RuntimeError:  # none has converged
            converged = np.zeros(start.shape, bool)
    return np.where(converged, found, np.nan)
