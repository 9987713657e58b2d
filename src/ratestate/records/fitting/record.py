"""A laboratory record as a fit moves sliders through it: samples from t = 0 on, and a loading."""

from typing import NamedTuple

import numpy as np

from ...model.loading import Loading
from ..load_point.stress_steps import VARIABLE
from ..loading import loading_of
from ..messages import fitting as sentences
from ..raw_record import raw_record

#: most samples: a march keeps each of them for a dozen sliders at once
MOST = 200_000
#: least samples before the first step, and after the last
BESIDE = 8


class Record(NamedTuple):
    """The samples that are fitted.  Times are from the record's first sample on.

    The displacement of the load point is in it as the `loading` alone, the speeds between steps.
    """

    t: np.ndarray  # (m,) [s], increasing
    friction: np.ndarray  # (m,)
    trend_variable: np.ndarray  # (m,) factor of the trend: time [s] or load-point displacement [m]
    trend: str | None  # "slip", "time" or None
    loading: Loading
    kind: str  # "tau": of the spring over sigma; "mu": of the interface
    time: np.ndarray  # (m,) as recorded [s]
    order: np.ndarray  # (m,) rows of the Dataset

    def regressors(self, along=None):
        """name -> derivative of friction by each parameter that it is linear in.

        along : (..., m) slip or time, by default `trend_variable`
        """
        along = self.trend_variable if along is None else along
        level = {"level": np.ones_like(along)}
        return level | {"trend": along} if self.trend else level

    @property
    def level(self):
        """Friction before anything changes, where normal stress varies."""
        return float(np.median(self.friction[before_changes(self.loading, self.t)]))

    @property
    def scale(self):
        """Largest less smallest friction."""
        return float(np.ptp(self.friction))

    @property
    def spacing(self):
        """The usual time between samples [s]."""
        return float(np.median(np.diff(self.t)))

    def thinned(self, stride):
        """The `Record` with one sample in `stride`, and all samples about each step."""
        keep = np.zeros(self.t.size, bool)
        keep[::stride] = True
        for step in changes(self.loading):
            at = np.searchsorted(self.t, step)
            keep[max(at - 5, 0) : at + 40] = True
        columns = ("t", "friction", "trend_variable", "time", "order")
        return self._replace(**{name: getattr(self, name)[keep] for name in columns})


def record_of(data, slider, *, loading, trend, against):
    """The `Record` in a Dataset of `read_lab`, or of `simulate`.

    ParameterError as of `raw_record` and `loading_of`, and: too many samples; constant friction; no
    step, or one too near to an end; against displacement none, a hold or a ramp.
    """
    raw = raw_record(data, slider)
    if raw.friction.size > MOST:
        every = -(-raw.friction.size // MOST)
        raise sentences.refusal("record.many", samples=raw.friction.size, most=MOST, every=every)
    if not np.ptp(raw.friction) > 1e-9 * np.abs(raw.friction).max():
        first = raw.friction[0]
        raise sentences.refusal("record.constant", friction=first, samples=raw.friction.size)
    loading = loading_of(raw, loading, slider.sigma)
    t, order = raw.t, np.arange(raw.t.size)
    if against == "displacement":
        t, order = _times_at(raw.displacement, loading, t)
    _check_steps(loading, t)
    trend_variable = t if trend == "time" else np.asarray(loading.delta_lp(t))
    friction, time = raw.friction[order], raw.time[order]
    return Record(t, friction, trend_variable, trend, loading, raw.kind, time, order)


def changes(loading):
    """Times [s], after the start, at which speed changes, or normal stress by more than 1 %."""
    if (stress := loading.normal_stress) is None:
        return loading.t[1:]
    moves = np.abs(stress.end - stress.start) > VARIABLE * stress.start
    jumps = np.abs(stress.start[1:] - stress.end[:-1]) > VARIABLE * stress.start[1:]
    return np.union1d(loading.t[1:], stress.t[1:][jumps | moves[1:] | moves[:-1]])


def before_changes(loading, t):
    """Which of the times t (m,) are before the first change; all, if that is at the start."""
    events = changes(loading)
    early = t < (events[0] if events.size else np.inf)
    return early if early.sum() >= BESIDE else np.ones(t.size, bool)


def _check_steps(loading, t):
    """Refuse a record at one speed, and steps of it too near to the ends of the record."""
    if loading.normal_stress is not None or (loading.t.size < 2 and loading.rate[0]):
        return
    if loading.t.size < 2:
        raise sentences.refusal("load_point.no_step", V=float(loading.V[0]))
    before = int(np.searchsorted(t, loading.t[1]))
    after = t.size - int(np.searchsorted(t, loading.t[-1]))
    if min(before, after) < BESIDE:
        side = "before the first" if before < after else "after the last"
        samples = min(before, after)
        raise sentences.refusal("load_point.few_beside", samples=samples, side=side, fewest=BESIDE)


def _times_at(displacement, loading, t):
    """Times in order at which the load point passed these displacements, and their rows."""
    if displacement is None:
        raise sentences.refusal("load_point.no_displacement")
    if not np.all(loading.V > 0.0) or np.any(loading.rate):
        raise sentences.refusal("load_point.holds")
    advance = displacement - np.median(displacement - loading.delta_lp(t))
    breaks = loading.delta_lp(loading.t)
    segment = np.clip(np.searchsorted(breaks, advance, side="right") - 1, 0, None)
    times = loading.t[segment] + (advance - breaks[segment]) / loading.V[segment]
    order = np.argsort(times, kind="stable")
    return np.maximum(times[order], 0.0), order
