"""The segments of a record at one load-point speed, and the cycles in them that repeat."""

from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ....model.names import Sentences
from ...loading import constant_speeds_of
from ...messages import fitting as sentences
from ...raw_record import raw_record
from .folding import FEWEST_CYCLES, cut_cycles

# Fewest samples of a segment that is used.
FEWEST = 20
# Scatter of the periods beyond which cycles do not repeat.  An amplitude counts as a transient's if
# it is off by so many standard deviations and by this part of the typical one.
IRREGULAR, TRANSIENT, DEVIATION = 0.2, 6.0, 0.05
SENTENCES = Sentences(Path(__file__).with_name("diagnostics.toml"))


class Segment(NamedTuple):
    """A part of a record at one load-point speed."""

    t: np.ndarray  # (samples,) [s]
    y: np.ndarray  # (samples,) tau/sigma
    V_lp: float  # [m/s]


def segments_of(record, slider, loading):
    """list of `Segment`s of a record, in each of which the load point moves at one speed.

    ParameterError as of `raw_record` and `constant_speeds_of`, for a record of mu, and if
    no segment has `FEWEST` samples.
    """
    raw = raw_record(record, slider)
    if raw.kind != "tau":
        raise sentences.refusal("cycles.of_mu")
    loading, t = constant_speeds_of(raw, loading), raw.t
    segments = []
    for start, end, V_lp in zip(loading.t, [*loading.t[1:], np.inf], loading.V, strict=True):
        rows = (t >= start) & (t < end)
        if V_lp > 0.0 and rows.sum() >= FEWEST:
            segments.append(Segment(raw.time[rows], raw.friction[rows], float(V_lp)))
    if not segments:
        raise sentences.refusal("cycles.no_stretch", fewest=FEWEST)
    return segments


def regular_cuts(segment, period):
    """(n + 1,) times [s] to cut a segment into n cycles, and notes (tuple) on cycles left out.

    ParameterError if there are too few, or their periods scatter by more than `IRREGULAR`.
    """
    t, y, V_lp = segment
    cuts = cut_cycles(t, y, period)
    if cuts.size <= FEWEST_CYCLES:
        raise sentences.refusal("cycles.few_whole", V_lp=V_lp, fewest=FEWEST_CYCLES)
    amplitude = np.array(
        [np.ptp(np.percentile(y[(t >= i) & (t < j)], (1, 99))) for i, j in pairwise(cuts)]
    )
    left_out: tuple = ()
    first = _transient(amplitude)
    if first and cuts.size - first > FEWEST_CYCLES:
        which = "first cycle" if first == 1 else f"first {first} cycles"
        left_out = (SENTENCES("measured.transient", cycles=which, V_lp=V_lp),)
        cuts = cuts[first:]
    periods = np.diff(cuts)
    if (scatter := float(periods.std() / periods.mean())) > IRREGULAR:
        raise sentences.refusal(
            "cycles.irregular", V_lp=V_lp, scatter=100 * scatter, most=100 * IRREGULAR
        )
    return cuts, left_out


def _transient(amplitude):
    """Number of first cycles whose amplitude (n,) is unlike that of the later ones."""
    late = amplitude[amplitude.size // 2 :]
    typical = float(np.median(late))
    spread = 1.4826 * max(float(np.median(np.abs(x - np.median(x)))) for x in (late, amplitude))
    is_unlike = np.abs(amplitude - typical) > max(TRANSIENT * spread, DEVIATION * typical)
    return int(np.argmin(is_unlike))
