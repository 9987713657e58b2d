"""The samples of a record as a fit uses them: from t = 0 on, with a loading."""

from typing import NamedTuple

import numpy as np

from ...model.loading import Loading
from ..load_point.stress_steps import VARIABLE
from ..loading import loading_of
from ..messages import fitting as sentences
from ..raw_record import raw_record

#: most samples: a march stores all of them for a dozen sliders at once
MOST = 200_000
#: fewest samples before the first step, and after the last
FEWEST = 8


class Samples(NamedTuple):
    """The samples that are fitted.  Times count from the record's first sample.

    The measured displacement is replaced by the `loading` alone: constant speeds between steps.
    """

    t: np.ndarray  # (m,) [s], increasing
    friction: np.ndarray  # (m,)
    trend_variable: np.ndarray  # (m,) factor of the trend: time [s] or load-point displacement [m]
    trend: str | None  # "slip", "time" or None
    loading: Loading
    kind: str  # of friction: "tau" is tau/sigma of the spring, "mu" that of the interface
    time: np.ndarray  # (m,) recorded time [s]

    def regressors(self, along=None):
        """Return name -> derivative of friction by each of its linear parameters.

        along : (..., m) slip or time, by default `trend_variable`
        """
        along = self.trend_variable if along is None else along
        level = {"level": np.ones_like(along)}
        return level | {"trend": along} if self.trend else level

    @property
    def level(self):
        """Friction before the first change of speed or normal stress."""
        return float(np.median(self.friction[before_first_change(self.loading, self.t)]))

    @property
    def scale(self):
        """Range of friction."""
        return float(np.ptp(self.friction))

    @property
    def spacing(self):
        """Median time between samples [s]."""
        return float(np.median(np.diff(self.t)))

    def thinned(self, stride):
        """Return the `Samples` with every stride-th sample and all samples near steps."""
        keep = np.zeros(self.t.size, bool)
        keep[::stride] = True
        for step in change_times(self.loading):
            at = np.searchsorted(self.t, step)
            keep[max(at - 5, 0) : at + 40] = True
        columns = ("t", "friction", "trend_variable", "time")
        return self._replace(**{name: getattr(self, name)[keep] for name in columns})


def samples_of(data, slider, *, loading, trend, against):
    """Return the `Samples` in a Dataset of `read_lab` or `simulate`."""
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
        t, order = _times_at_displacements(raw.displacement, loading, t)
    _check_steps(loading, t)
    along = t if trend == "time" else np.asarray(loading.delta_lp(t))
    friction, time = raw.friction[order], raw.time[order]
    return Samples(t, friction, along, trend, loading, raw.kind, time)


def change_times(loading):
    """Return times [s] > 0 of changes of speed, or of normal stress by over 1 %."""
    if (stress := loading.normal_stress) is None:
        return loading.t[1:]
    moves = np.abs(stress.end - stress.start) > VARIABLE * stress.start
    jumps = np.abs(stress.start[1:] - stress.end[:-1]) > VARIABLE * stress.start[1:]
    return np.union1d(loading.t[1:], stress.t[1:][jumps | moves[1:] | moves[:-1]])


def before_first_change(loading, t):
    """Return which times (m,) precede the first change; all, if under `FEWEST`."""
    events = change_times(loading)
    early = t < (events[0] if events.size else np.inf)
    return early if early.sum() >= FEWEST else np.ones(t.size, bool)


def _check_steps(loading, t):
    if loading.normal_stress is not None or (loading.t.size < 2 and loading.rate[0]):
        return
    if loading.t.size < 2:
        raise sentences.refusal("load_point.no_step", V=float(loading.V[0]))
    before = int(np.searchsorted(t, loading.t[1]))
    after = t.size - int(np.searchsorted(t, loading.t[-1]))
    if min(before, after) < FEWEST:
        side = "before the first" if before < after else "after the last"
        samples = min(before, after)
        raise sentences.refusal("load_point.few_beside", samples=samples, side=side, fewest=FEWEST)


def _times_at_displacements(displacement, loading, t):
    """Return sorted times at which the load point passed displacements, and rows."""
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
