"""Times, friction and the load point's history in the Dataset of a record, checked."""

import numpy as np
import xarray

from ...model.loading import Loading
from ..reading.segments import find_segments
from .refusals import refusal

#: bounds of friction, which may be a change from some level; farthest that a load point moves [m]
LOW, HIGH, FARTHEST = -0.1, 3.0, 10.0
#: largest difference of a given loading from the recorded displacement, over the distance moved
DIFFERENCE = 0.1
#: samples that a step needs on each side
BESIDE = 8


def column(data, name):
    """(m,) values of a variable along time [SI]; refuses values that are not finite, by row."""
    if name not in data.variables:
        raise refusal("channels.absent", name=name, variables=variable_names(data))
    variable = data[name]
    if variable.dims != ("time",):
        raise refusal("channels.dimensions", name=name, dims=variable.dims)
    values = np.ascontiguousarray(variable.values, float)
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise refusal("channels.not_finite", name=name, value=values[row], row=row)
    return values


def variable_names(data):
    """The names of all variables, as a message lists them."""
    return ", ".join(map(str, data.variables)) or "no variable at all"


def check_sizes(friction, data):
    """Refuse values that no laboratory has: they are in another unit, or of another sign."""
    typical = float(np.median(friction))
    if not LOW < typical < HIGH:
        advice = "turn its sign" if -HIGH < typical < 0.0 else "is it a stress, or in per cent?"
        raise refusal("channels.size", typical=typical, high=HIGH, advice=advice)
    if "delta_lp" in data.variables:
        far = float(np.ptp(column(data, "delta_lp")))
        if far > FARTHEST:
            raise refusal("channels.far", far=far, farthest=FARTHEST)


def times_of(data):
    """(m,) times of the record [s], which must increase."""
    if not isinstance(data, xarray.Dataset):
        raise refusal("record.type", type=type(data).__name__)
    time = column(data, "time")
    if not (np.diff(time) > 0.0).all():
        row = int(np.argmin(np.diff(time) > 0.0)) + 1
        raise refusal("channels.not_increasing", before=time[row - 1], after=time[row], row=row)
    return time


def friction_of(data, slider):
    """The friction that was recorded: of "tau", the spring, or "mu", the interface; its values."""
    if "friction" in data.variables:
        return "tau", column(data, "friction")
    names = [name for name in ("tau", "mu") if name in data.variables]
    if len(names) == 2:
        raise refusal("channels.tau_and_mu")
    if not names:
        raise refusal("channels.no_friction", variables=variable_names(data))
    (kind,) = names
    values = column(data, kind)
    if kind == "mu":
        return kind, values
    sigma = data["sigma"] if "sigma" in data.variables else slider.sigma
    return kind, values / np.asarray(sigma, float)


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
