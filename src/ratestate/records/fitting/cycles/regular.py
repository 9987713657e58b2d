"""Which cycles of a stretch of record repeat."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ....errors import ParameterError
from ....model.quantities import readable
from .folding import FEWEST_CYCLES, cut_cycles

# Scatter of the periods beyond which nothing repeats; a swing of cycles counts as a transient
# beyond so many of their deviations and this part of it.
IRREGULAR, TRANSIENT, SETTLED = 0.2, 6.0, 0.05


class Segment(NamedTuple):
    """A stretch of record at one load-point speed."""

    t: np.ndarray  # (samples,) [s]
    y: np.ndarray  # (samples,) tau/sigma
    V_lp: float  # [m/s]


def regular_cuts(segment, period):
    """Where to cut a segment into cycles that repeat, and what is left out, in words (tuple).

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
    swing = np.array(
        [np.ptp(np.percentile(y[(t >= i) & (t < j)], (1, 99))) for i, j in pairwise(cuts)]
    )
    left_out: tuple = ()
    first = _transient(swing)
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


def _transient(swing):
    """How many cycles swing unlike the later ones before one does not."""
    late = swing[swing.size // 2 :]
    typical = float(np.median(late))
    spread = 1.4826 * max(float(np.median(np.abs(x - np.median(x)))) for x in (late, swing))
    return int(np.argmin(np.abs(swing - typical) > max(TRANSIENT * spread, SETTLED * typical)))
