"""Normal stress in a record: whether it varies, and its history as few straight lines."""

import numpy as np
from scipy.interpolate import make_lsq_spline

from ...model.history import NormalStress
from ..reading.stress_steps import VARIABLE, stress_range
from ..sample_noise import sample_noise
from .refusals import refusal

#: of the noise, by which lines may miss samples; of the mean, if there is no noise
NOISES, LEAST = 4.0, 1e-6
#: tolerances by which a change from one sample to the next is a jump
JUMP = 5.0
#: most lines: each is a break at which all sliders stop
MOST = 5000


def recorded_stress(data, t, sigma):
    """`NormalStress` of a record with a normal stress that varies, else None.

    In proportion, from the slider's sigma on.  ParameterError where it has too many lines.

    data : the Dataset, with ``sigma`` along time or not; t : (m,) times from its first sample on
    sigma : of the slider [Pa]
    """
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return None
    recorded = np.asarray(data["sigma"].values, float)
    if not np.isfinite(recorded).all() or stress_range(data) <= VARIABLE:
        return None
    tolerance = max(NOISES * sample_noise(recorded), LEAST * recorded.mean())
    knots = corners(t, recorded, tolerance)
    if knots.size > MOST:
        raise refusal("record.stress_lines", lines=knots.size, most=MOST)
    at = t[knots]
    values = make_lsq_spline(t, recorded, [at[0], *at, at[-1]], 1).c
    values *= sigma / values[0]
    end = np.append(values[1:], values[-1])
    # from one sample to the next it jumps, and the later one is after it
    jumps = np.diff(knots, append=t.size) == 1
    jumps &= np.abs(end - values) > JUMP * tolerance
    end[jumps] = values[jumps]
    return NormalStress(at, values, end)


def corners(t, values, tolerance):
    """Rows (k,) between which straight lines pass all values within the tolerance.

    By Douglas & Peucker: the row farthest from a line between two others becomes a corner.
    """
    kept = np.zeros(t.size, bool)
    kept[[0, -1]] = True
    open_ends = [(0, t.size - 1)]
    while open_ends:
        first, last = open_ends.pop()
        if last - first < 2:
            continue
        inside = slice(first + 1, last)
        slope = (values[last] - values[first]) / (t[last] - t[first])
        off = np.abs(values[inside] - values[first] - slope * (t[inside] - t[first]))
        farthest = int(np.argmax(off))
        if off[farthest] > tolerance:
            middle = first + 1 + farthest
            kept[middle] = True
            open_ends += [(first, middle), (middle, last)]
    return np.flatnonzero(kept)
