"""A laboratory record as the fit sees it: samples from t = 0 on, and what the load point did."""

from typing import NamedTuple

import numpy as np
import xarray

from ..errors import ParameterError
from ..lab.segments import find_segments
from ..loading import Loading
from ..quantities import readable
from ..units import to_si

#: name of the variable -> kind of friction it is: the spring's or the interface's
KINDS = {"friction": "tau", "tau": "tau", "mu": "mu"}
#: friction that is possible, also as a change from its level; how far a load point moves [m]
LOW, HIGH, FARTHEST = -0.1, 3.0, 10.0
#: by what part of its way a given loading may differ from the recorded displacement
APART = 0.1
#: most samples: a march keeps each of them for a dozen sliders at once
MOST = 200_000
#: samples that a window needs, and a step on each side
FEWEST, BESIDE = 30, 8


class Record(NamedTuple):
    """What is fitted.  Times count from the record's first sample on."""

    t: np.ndarray  # (m,) [s], increasing
    friction: np.ndarray  # (m,)
    along: np.ndarray  # (m,) what the trend multiplies: time [s] or load-point displacement [m]
    trend: str | None  # "slip", "time" or None
    loading: Loading
    kind: str  # "tau": of the spring over sigma; "mu": of the interface
    time: np.ndarray  # (m,) as recorded [s]
    order: np.ndarray  # (m,) rows of the Dataset

    @property
    def scale(self):
        """How far friction ranges."""
        return float(np.ptp(self.friction))

    @property
    def spacing(self):
        """The usual time between samples [s]."""
        return float(np.median(np.diff(self.t)))

    def every(self, stride):
        """The same with one sample in `stride`, and all of those about each step."""
        keep = np.zeros(self.t.size, bool)
        keep[::stride] = True
        for step in self.loading.t[1:]:
            at = np.searchsorted(self.t, step)
            keep[max(at - 5, 0) : at + 40] = True
        picked = {n: getattr(self, n)[keep] for n in ("t", "friction", "along", "time", "order")}
        return self._replace(**picked)


def record_of(data, slider, *, loading, trend, against):
    """The `Record` in a Dataset of `read_lab`, or of `simulate`; checked.

    Raises
    ------
    ParameterError
        It is no Dataset of one record, lacks what is needed, or holds nothing to fit.
    """
    if not isinstance(data, xarray.Dataset):
        raise ParameterError(
            f"data is of type {type(data).__name__}; expected the Dataset of read_lab, or one with "
            f"time, friction and delta_lp"
        )
    time = column(data, "time")
    kind, friction = friction_of(data, slider)
    increasing(time)
    if time.size < FEWEST:
        raise ParameterError(
            f"the record has {time.size} samples, too few to fit; expected {FEWEST} or more: widen "
            f"the window"
        )
    if time.size > MOST:
        every = -(-time.size // MOST)
        raise ParameterError(
            f"the record has {time.size:,} samples, more than {MOST:,}, which a fit needs at most; "
            f"choose a window about the steps, or average: "
            f"data.coarsen(time={every}, boundary='trim').mean()"
        )
    if not np.ptp(friction) > 1e-9 * np.abs(friction).max():
        raise ParameterError(
            f"friction is constant, {friction[0]:.6g} in all {time.size} samples: nothing to fit; "
            f"look at the column that was read"
        )
    _of_usual_size(friction, data)
    t = time - time[0]
    order = np.arange(t.size)
    displacement = displacement_of(data, t)
    loading = loading_of(data, displacement, time, loading)
    if against == "displacement":
        t, order = _times_of(displacement, loading, t)
        friction, time = friction[order], time[order]
    _has_steps(loading, t)
    along = t if trend == "time" else np.asarray(loading.delta_lp(t))
    return Record(t, friction, along, trend, loading, kind, time, order)


def column(data, name):
    """(m,) values of a variable along time [SI]; whatever is not finite is refused by row."""
    if name not in data.variables:
        raise ParameterError(f"the record has no variable {name!r}; it has {_listed(data)}")
    variable = data[name]
    if variable.dims != ("time",):
        raise ParameterError(
            f"{name} has the dimensions {variable.dims}; a record has its values along time alone: "
            f"pick one case with .isel(...)"
        )
    values = np.ascontiguousarray(variable.values, float)
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise ParameterError(
            f"{name} is {values[row]} in row {row} (counted from 0 on); drop such rows, for "
            f"example data.dropna('time')"
        )
    return values


def _listed(data):
    return ", ".join(map(str, data.variables)) or "no variable at all"


def _of_usual_size(friction, data):
    """Refuse values that no laboratory has: of another unit, or sign."""
    typical = float(np.median(friction))
    if not LOW < typical < HIGH:
        what = "turn its sign" if -HIGH < typical < 0.0 else "is it a stress, or in per cent?"
        raise ParameterError(
            f"friction is {typical:.4g} (its median); expected shear over normal stress, {HIGH:g} "
            f"at most: {what}"
        )
    if "delta_lp" in data.variables:
        far = float(np.ptp(column(data, "delta_lp")))
        if far > FARTHEST:
            raise ParameterError(
                f"delta_lp ranges over {far:.4g} m; expected metres, {FARTHEST:g} at most: if it "
                f"is in um, divide it by 1e6"
            )


def increasing(time):
    """Refuse times that do not increase, by row."""
    if not (np.diff(time) > 0.0).all():
        row = int(np.argmin(np.diff(time) > 0.0)) + 1
        raise ParameterError(
            f"time goes from {time[row - 1]!r} to {time[row]!r} s in row {row} (counted from 0 "
            f"on); times must increase: sort the record and drop repeated ones"
        )


def friction_of(data, slider):
    """Kind and values of the friction that was recorded."""
    if "friction" in data.variables:
        return "tau", column(data, "friction")
    found = [name for name in ("tau", "mu") if name in data.variables]
    if len(found) == 2:
        raise ParameterError(
            "the record has both tau and mu, of which only one can be fitted; drop the other, or "
            "assign friction, for example data.assign(friction=data.tau / sigma)"
        )
    if not found:
        raise ParameterError(f"the record has no friction; it has {_listed(data)}")
    values = column(data, found[0])
    if found[0] == "tau":
        sigma = data["sigma"] if "sigma" in data.variables else slider.sigma
        values = values / np.asarray(sigma, float)
    return KINDS[found[0]], values


def displacement_of(data, t):
    """(m,) load-point displacement [m], from the speed where only that was recorded; or None."""
    if "delta_lp" in data.variables:
        return column(data, "delta_lp")
    if "V_load" in data.variables:
        V = column(data, "V_load")
        return np.concatenate([[0.0], np.cumsum(0.5 * (V[1:] + V[:-1]) * np.diff(t))])
    return None


def loading_of(data, displacement, time, loading):
    """What the load point did from the record's first sample on."""
    if loading is not None:
        if not isinstance(loading, Loading) or np.ndim(loading.V) != 1:
            raise ParameterError(
                "loading is not a Loading of one case; make it with Loading.steps(...), its t = 0 "
                "being the record's first sample"
            )
        loading.covers(time[-1] - time[0])
        if not loading.V[0] > 0.0:
            raise ParameterError("loading begins at rest; a record must begin in sliding")
        _agrees(loading, displacement, time - time[0])
        return loading
    if displacement is None:
        raise ParameterError(
            f"the record has neither delta_lp nor V_load, so what the load point did is unknown; "
            f"give loading=Loading.steps(...). It has {_listed(data)}"
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


def _agrees(loading, displacement, t):
    """Refuse a loading that is not the one recorded: of other units, or with other times."""
    if displacement is None:
        return
    said = np.asarray(loading.delta_lp(t))
    apart = displacement - said
    worst, far = float(np.ptp(apart)), float(np.ptp(displacement))
    if worst > APART * far:
        raise ParameterError(
            f"loading moves the load point by {readable('delta_lp', float(said[-1]))} in all, the "
            f"record by {readable('delta_lp', far)}, and on the way they differ by "
            f"{readable('delta_lp', worst)}: check units and times (t = 0 is the first sample), "
            f"or drop delta_lp from the record"
        )


def _has_steps(loading, t):
    """Refuse a record of one speed, and steps at its very ends."""
    if loading.t.size < 2 and not np.any(loading.rate):
        raise ParameterError(
            f"the load point moves at {to_si('V_lp', float(loading.V[0])):.4g} m/s all the time: "
            f"without a velocity step or hold the record tells nothing of a, b and Dc; widen the "
            f"window, or, if the record is of stick-slip, use against='cycles'"
        )
    before = int(np.searchsorted(t, loading.t[1]))
    after = t.size - int(np.searchsorted(t, loading.t[-1]))
    if min(before, after) < BESIDE:
        side = "before the first" if before < after else "after the last"
        raise ParameterError(
            f"the record has {min(before, after)} samples {side} step, too few to fit; expected "
            f"{BESIDE} or more: widen the window"
        )


def _times_of(displacement, loading, t):
    """Times at which the load point passed the displacements, in order, and their rows."""
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
    found = loading.t[segment] + (advance - breaks[segment]) / loading.V[segment]
    order = np.argsort(found, kind="stable")
    return np.maximum(found[order], 0.0), order
