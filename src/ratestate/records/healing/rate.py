"""Healing and relaxation per decade of hold time."""

import numpy as np

from ..kit.regression import weighted_line

#: points at which the line through the holds is given; hold times this near count as one
POINTS, SAME = 41, 1e-3


def line_of(t_hold, values, errors):
    """The `Line` of values (n,) against log10 of hold time; None without two different times.

    Values that are NaN are left out.
    """
    known = np.isfinite(values) & np.isfinite(errors) & (errors > 0.0)
    x = np.log10(t_hold[known])
    if x.size < 2 or np.ptp(x) < SAME:
        return None
    return weighted_line(x, values[known], errors[known])


def slope_of(t_hold, values, errors):
    """The slope of the line through values that are predicted where these errors were measured."""
    line = line_of(t_hold, values, np.where(np.isfinite(values), errors, np.nan))
    return np.nan if line is None else line.slope


def times_along(t_hold):
    """(POINTS,) hold times [s] from the shortest to the longest, evenly in their logarithm."""
    return np.geomspace(t_hold.min(), t_hold.max(), POINTS)
