"""The load point's history in a record: as given, or from its recorded motion."""

import numpy as np

from ...errors import ParameterError
from ...model.loading import Loading
from ...model.quantities import readable
from ...model.units import to_si
from ..reading.segments import find_segments
from .channels import column, variable_names

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
            raise ParameterError(
                "loading is not a Loading of one case; make it with Loading.steps(...), its t = 0 "
                "being the record's first sample"
            )
        loading.covers(time[-1] - time[0])
        if not loading.V[0] > 0.0:
            raise ParameterError("loading begins at rest; a record must begin in sliding")
        _check_agreement(loading, displacement, time - time[0])
        return loading
    if displacement is None:
        raise ParameterError(
            f"the record has neither delta_lp nor V_load, so what the load point did is unknown; "
            f"give loading=Loading.steps(...). It has {variable_names(data)}"
        )
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
        raise ParameterError(
            f"the load point rests at the record's beginning, {time[0]:.6g} s; a record must begin "
            f"in sliding: move the window's start"
        )
    pairs = zip(starts[1:] - time[0], speeds[1:], strict=True)
    return Loading.steps(float(speeds[0]), *((float(t), float(V)) for t, V in pairs))


def _check_agreement(loading, displacement, t):
    """Refuse a loading that differs from the recorded one: in units, or in times."""
    if displacement is None:
        return
    given = np.asarray(loading.delta_lp(t))
    worst, far = float(np.ptp(displacement - given)), float(np.ptp(displacement))
    if worst > DIFFERENCE * far:
        raise ParameterError(
            f"loading moves the load point by {readable('delta_lp', float(given[-1]))} in all, the "
            f"record by {readable('delta_lp', far)}, and on the way they differ by "
            f"{readable('delta_lp', worst)}: check units and times (t = 0 is the first sample), "
            f"or drop delta_lp from the record"
        )


def check_steps(loading, t):
    """Refuse a record at one speed, and steps too near to its ends."""
    if loading.t.size < 2 and not np.any(loading.rate):
        raise ParameterError(
            f"the load point moves at {to_si('V_lp', float(loading.V[0])):.4g} m/s all the time: "
            f"without a velocity step or hold the record does not constrain a, b and Dc; widen "
            f"the window, or, if the record is of stick-slip, use against='cycles'"
        )
    before = int(np.searchsorted(t, loading.t[1]))
    after = t.size - int(np.searchsorted(t, loading.t[-1]))
    if min(before, after) < BESIDE:
        side = "before the first" if before < after else "after the last"
        raise ParameterError(
            f"the record has {min(before, after)} samples {side} step, too few to fit; expected "
            f"{BESIDE} or more: widen the window"
        )


def times_at(displacement, loading, t):
    """Times in order at which the load point passed these displacements, and their rows."""
    if displacement is None:
        raise ParameterError("against='displacement' needs the displacement delta_lp of the record")
    if not np.all(loading.V > 0.0) or np.any(loading.rate):
        raise ParameterError(
            "against='displacement' needs a load point that moves at constant speeds throughout; "
            "a hold has no displacement: use against='time'"
        )
    advance = displacement - np.median(displacement - loading.delta_lp(t))
    breaks = loading.delta_lp(loading.t)
    segment = np.clip(np.searchsorted(breaks, advance, side="right") - 1, 0, None)
    times = loading.t[segment] + (advance - breaks[segment]) / loading.V[segment]
    order = np.argsort(times, kind="stable")
    return np.maximum(times[order], 0.0), order
