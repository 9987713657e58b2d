"""The load point's history from its recorded velocity."""

import itertools

import numpy as np

from ...errors import ParameterError
from ...model.quantities import readable
from .segments import Segments, check_count, checked_arrays
from .splits import Rows, cut, remove_cut
from .steps import HOLD_ERRORS, ROUNDED, STEP

#: variance of the position of a jump by k standard deviations, from least squares: so many samples
#: squared, over k^4 (Yao, Annals of Statistics 15, 1987, for small k)
POSITION = 26.0


def segments_from_velocity(t, V):
    """`Segments` from recorded speeds [m/s]; steps lie midway between two rows.

    Raises
    ------
    ParameterError
        As in `find_segments`.
    """
    t, V = checked_arrays(t, V, "V_load")
    rows = Rows(t, V, degree=0)
    cuts = check_count(cut(rows), t)
    while True:
        at = rows.at[cuts].tolist()
        means = np.array([V[i:j].mean() for i, j in itertools.pairwise(at)])
        errors = np.sqrt(rows.noise / np.diff(at))
        means[np.abs(means) <= np.maximum(HOLD_ERRORS * errors, ROUNDED * np.abs(means).max())] = (
            0.0
        )
        jumps = np.abs(np.diff(means))
        changes = jumps / np.maximum(np.maximum(np.abs(means[1:]), np.abs(means[:-1])), 1e-300)
        if not changes.size or changes.min() >= STEP:
            break
        cuts = remove_cut(rows, cuts, int(np.argmin(changes)) + 1)
    if means.min() < 0.0:
        i = int(np.argmin(means))
        raise ParameterError(
            f"V_load is {readable('V_lp', means[i], 3)} from {t[at[i]]:.7g} s on; a load point "
            f"moves at V >= 0: leave that span out with time=..."
        )
    before, after = t[np.array(at[1:-1], int) - 1], t[np.array(at[1:-1], int)]
    relative = np.sqrt(1.0 / 12.0 + POSITION * (rows.noise / jumps**2) ** 2)
    return Segments(
        np.append(t[0], 0.5 * (before + after)),
        means,
        np.append(0.0, (after - before) * relative),
        np.where(means == 0.0, 0.0, errors),
        [],
    )
