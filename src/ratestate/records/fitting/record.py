"""A laboratory record as a fit uses it: samples from t = 0 on, and the load point's history."""

from typing import NamedTuple

import numpy as np

from ...model.loading import Loading
from .channels import (
    check_sizes,
    check_steps,
    displacement_of,
    friction_of,
    loading_of,
    times_at,
    times_of,
)
from .refusals import refusal

#: most samples: a march keeps each of them for a dozen sliders at once
MOST = 200_000
#: least samples of a window
FEWEST = 30


class Record(NamedTuple):
    """The samples that are fitted.  Times are from the record's first sample on."""

    t: np.ndarray  # (m,) [s], increasing
    friction: np.ndarray  # (m,)
    trend_variable: np.ndarray  # (m,) factor of the trend: time [s] or load-point displacement [m]
    trend: str | None  # "slip", "time" or None
    loading: Loading
    kind: str  # "tau": of the spring over sigma; "mu": of the interface
    time: np.ndarray  # (m,) as recorded [s]
    order: np.ndarray  # (m,) rows of the Dataset

    @property
    def regressors(self):
        """name -> (m,) what friction changes by with each parameter that it is linear in."""
        level = {"level": np.ones(self.t.size)}
        return level | {"trend": self.trend_variable} if self.trend else level

    @property
    def scale(self):
        """The range of friction."""
        return float(np.ptp(self.friction))

    @property
    def spacing(self):
        """The usual time between samples [s]."""
        return float(np.median(np.diff(self.t)))

    def thinned(self, stride):
        """The record with one sample in `stride`, and all samples about each step."""
        keep = np.zeros(self.t.size, bool)
        keep[::stride] = True
        for step in self.loading.t[1:]:
            at = np.searchsorted(self.t, step)
            keep[max(at - 5, 0) : at + 40] = True
        columns = ("t", "friction", "trend_variable", "time", "order")
        return self._replace(**{name: getattr(self, name)[keep] for name in columns})


def record_of(data, slider, *, loading, trend, against):
    """The `Record` in a Dataset of `read_lab`, or of `simulate`; refuses what cannot be fitted."""
    time = times_of(data)
    kind, friction = friction_of(data, slider)
    samples = time.size
    if samples < FEWEST:
        raise refusal("record.few", samples=samples, fewest=FEWEST)
    if samples > MOST:
        raise refusal("record.many", samples=samples, most=MOST, every=-(-samples // MOST))
    if not np.ptp(friction) > 1e-9 * np.abs(friction).max():
        raise refusal("record.constant", friction=friction[0], samples=samples)
    check_sizes(friction, data)
    t = time - time[0]
    order = np.arange(samples)
    displacement = displacement_of(data, t)
    loading = loading_of(data, displacement, time, loading)
    if against == "displacement":
        t, order = times_at(displacement, loading, t)
        friction, time = friction[order], time[order]
    check_steps(loading, t)
    trend_variable = t if trend == "time" else np.asarray(loading.delta_lp(t))
    return Record(t, friction, trend_variable, trend, loading, kind, time, order)
