"""The load point's history in a record: as given, or from its recorded motion."""

import numpy as np

from ...model.loading import Loading
from ..reading.segments import find_segments
from .channels import column, variable_names
from .refusals import refusal

#: largest difference of a given loading from the recorded displacement, over the distance moved
DIFFERENCE = 0.1
#: samples that a step needs on each side
BESIDE = 8


def displacement_of(data, t):
    """(m,) load-point displacement [m], from the speed where only that was recorded; or None."""
    if "delta_lp" in data.variables:
        return column(data, "delta_lp")
    if "V_load" in data.variables:
        V = column(data, "V_load")
        return np.concatenate([[0.0], np.cumsum(0.5 * (V[1:] + V[:-1]) * np.diff(t))])
    return None


def loading_of(data, displacement, time, loading):
    """The `Loading` from the record's first sample on."""
    if loading is not None:
        if not isinstance(loading, Loading) or np.ndim(loading.V) != 1:
            raise refusal("load_point.no_loading")
        loading.covers(time[-1] - time[0])
        if not loading.V[0] > 0.0:
            raise refusal("load_point.begins_at_rest")
        if displacement is not None:
            _check_agreement(loading, displacement, time - time[0])
        return loading
    if displacement is None:
        raise refusal("load_point.unknown", variables=variable_names(data))
    if "segment_t" in data.variables:
        starts = np.asarray(data["segment_t"].values, float)
        speeds = np.asarray(data["segment_V"].values, float)
    else:
        starts, speeds = find_segments(time, displacement)
    # a window may have cut off segments at both ends
    inside = starts < time[-1]
    first = max(int(np.searchsorted(starts, time[0], side="right")) - 1, 0)
    starts, speeds = starts[inside][first:], speeds[inside][first:]
    if not speeds[0] > 0.0:
        raise refusal("load_point.rests", start=time[0])
    pairs = zip(starts[1:] - time[0], speeds[1:], strict=True)
    return Loading.steps(float(speeds[0]), *((float(t), float(V)) for t, V in pairs))


def _check_agreement(loading, displacement, t):
    """Refuse a loading that differs from the recorded one: in units, or in times."""
    given = np.asarray(loading.delta_lp(t))
    worst, far = float(np.ptp(displacement - given)), float(np.ptp(displacement))
    if worst > DIFFERENCE * far:
        raise refusal("load_point.differs", given=float(given[-1]), far=far, worst=worst)


def check_steps(loading, t):
    """Refuse a record at one speed, and steps too near to its ends."""
    if loading.t.size < 2 and not np.any(loading.rate):
        raise refusal("load_point.no_step", V=float(loading.V[0]))
    before = int(np.searchsorted(t, loading.t[1]))
    after = t.size - int(np.searchsorted(t, loading.t[-1]))
    if min(before, after) < BESIDE:
        side = "before the first" if before < after else "after the last"
        samples = min(before, after)
        raise refusal("load_point.few_beside", samples=samples, side=side, fewest=BESIDE)


def times_at(displacement, loading, t):
    """Times in order at which the load point passed these displacements, and their rows."""
    if displacement is None:
        raise refusal("load_point.no_displacement")
    if not np.all(loading.V > 0.0) or np.any(loading.rate):
        raise refusal("load_point.holds")
    advance = displacement - np.median(displacement - loading.delta_lp(t))
    breaks = loading.delta_lp(loading.t)
    segment = np.clip(np.searchsorted(breaks, advance, side="right") - 1, 0, None)
    times = loading.t[segment] + (advance - breaks[segment]) / loading.V[segment]
    order = np.argsort(times, kind="stable")
    return np.maximum(times[order], 0.0), order
