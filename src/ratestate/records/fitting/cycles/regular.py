"""The cycles of a segment of record that repeat."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ....errors import ParameterError
from ....model.quantities import readable
from .folding import FEWEST_CYCLES, cut_cycles

# Scatter of the periods beyond which cycles do not repeat.  An amplitude counts as a transient's if
# it is off by so many standard deviations and by this part of the typical one.
IRREGULAR, TRANSIENT, DEVIATION = 0.2, 6.0, 0.05


class Segment(NamedTuple):
    """A part of a record at one load-point speed."""

    t: np.ndarray  # (samples,) [s]
    y: np.ndarray  # (samples,) tau/sigma
    V_lp: float  # [m/s]


def regular_cuts(segment, period):
    """Times to cut a segment into cycles that repeat, and notes on cycles left out (tuple).

    Raises
    ------
    ParameterError
        Fewer than three cycles, or periods that scatter by more than 20 %.
    """
    t, y, V_lp = segment.t, segment.y, readable("V_lp", segment.V_lp)
    cuts = cut_cycles(t, y, period)
    if cuts.size <= FEWEST_CYCLES:
        raise ParameterError(
            f"friction at {V_lp} has fewer than {FEWEST_CYCLES} whole cycles; give a longer "
            f"record, or fit against time"
        )
    amplitude = np.array(
        [np.ptp(np.percentile(y[(t >= i) & (t < j)], (1, 99))) for i, j in pairwise(cuts)]
    )
    left_out: tuple = ()
    first = _transient(amplitude)
    if first and cuts.size - first > FEWEST_CYCLES:
        which = "first cycle" if first == 1 else f"first {first} cycles"
        left_out = (f"a transient, the {which} at {V_lp}, is left out",)
        cuts = cuts[first:]
    periods = np.diff(cuts)
    if (scatter := float(periods.std() / periods.mean())) > IRREGULAR:
        raise ParameterError(
            f"cycles at {V_lp} are irregular: their periods scatter by {100 * scatter:.0f} % (at "
            f"most {100 * IRREGULAR:.0f} % can be fitted as a limit cycle); cut a regular stretch "
            f"out of the record, or fit against time"
        )
    return cuts, left_out


def _transient(amplitude):
    """Number of first cycles whose amplitude (n,) is unlike that of the later ones."""
    late = amplitude[amplitude.size // 2 :]
    typical = float(np.median(late))
    spread = 1.4826 * max(float(np.median(np.abs(x - np.median(x)))) for x in (late, amplitude))
    return int(
        np.argmin(np.abs(amplitude - typical) > max(TRANSIENT * spread, DEVIATION * typical))
    )
