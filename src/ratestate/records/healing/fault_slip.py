"""Fault slip: the displacement of the load point less the stretch of the spring, friction/k."""

import numpy as np

#: fewest samples of a reloading from which k is taken
FEWEST = 3


def fault_slip(friction, displacement, holds):
    """Slip of the fault (m,) [m], and k = K/sigma [1/m].

    k is inf, and slip the load point's displacement (m,), if no reloading is resolved.
    """
    k = max((_reloading(friction, displacement, hold) for hold in holds), default=(0.0, np.inf))[1]
    return displacement - friction / k, k


def _reloading(friction, displacement, hold):
    """Relaxation in a hold, and the slope k [1/m] of friction until half of it is regained.

    The fault creeps least there, and after the hold with the largest relaxation.  inf and a
    relaxation of 0 if too few samples show the slope.
    """
    if min(hold.before.size, hold.during.size, hold.after.size) < FEWEST:
        return 0.0, np.inf
    before, low = (friction[rows[-FEWEST:]].mean() for rows in (hold.before, hold.during))
    rising = friction[hold.after] < 0.5 * (before + low)
    rows = hold.after[: int(np.argmin(rising))]
    if rows.size < FEWEST:
        return 0.0, np.inf
    slope = float(np.polyfit(displacement[rows] - displacement[rows[0]], friction[rows], 1)[0])
    return (float(before - low), slope) if slope > 0.0 else (0.0, np.inf)
