"""The segments of a record at one load-point speed, and the features of their cycles."""

import numpy as np

from ....errors import ParameterError
from ....model.quantities import readable
from ..channels import check_increasing, column, friction_of
from ..load_point import displacement_of, loading_of
from .features import FEATURES
from .measured import measure
from .regular import Segment

# Fewest samples of a segment that is used.
FEWEST = 20


def segments_of(record, slider, loading):
    """`Segment`s of a record, in each of which the load point moves at one speed."""
    time = column(record, "time")
    check_increasing(time)
    kind, friction = friction_of(record, slider)
    if kind != "tau":
        raise ParameterError(
            "the record has mu, the friction of the interface; cycles are fitted by the spring's: "
            "give friction (tau/sigma) or tau"
        )
    t = time - time[0]
    loading = loading_of(record, displacement_of(record, t), time, loading)
    ends = np.append(loading.t[1:], np.inf)
    segments = []
    for start, end, V_lp in zip(loading.t, ends, loading.V, strict=True):
        rows = (t >= start) & (t < end)
        if V_lp > 0.0 and rows.sum() >= FEWEST:
            segments.append(Segment(time[rows], friction[rows], float(V_lp)))
    if not segments:
        raise ParameterError(
            f"the record has no stretch of {FEWEST} samples at one load-point speed > 0; give a "
            f"longer one"
        )
    return segments


def measured_of(segments):
    """`Measured` of the segments that have cycles, and warnings on the others."""
    measured, refused = [], []
    for segment in segments:
        try:
            measured.append(measure(segment))
        except ParameterError as error:
            refused.append((segment.V_lp, error))
    if not measured:
        raise refused[0][1]
    return tuple(measured), [
        f"the record at {readable('V_lp', V_lp)} is left out: {error}" for V_lp, error in refused
    ]


def check_feature_count(space, measured):
    """Refuse more unknowns than features."""
    count = sum(int(one.used.sum()) for one in measured)
    if space.size + 1 <= count:
        return
    listed = "; ".join(
        f"at {readable('V_lp', one.segment.V_lp)} "
        + ", ".join(name for name, used in zip(FEATURES, one.used, strict=True) if used)
        for one in measured
    )
    raise ParameterError(
        f"{space.size} free parameters ({', '.join(space.names)}) and mu0, but the record has only "
        f"{count} features of cycles: {listed}; leave known parameters out of free, or give a "
        f"record with another speed"
    )
