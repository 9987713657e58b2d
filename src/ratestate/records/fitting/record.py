"""A laboratory record as the fit sees it: samples from t = 0 on, and what the load point did."""

from typing import NamedTuple

import numpy as np
import xarray

from ...errors import ParameterError
from ...model.loading import Loading
from .channels import column, friction_of, increasing, of_usual_size
from .load_point import displacement_of, has_steps, loading_of, times_of

#: most samples: a march keeps each of them for a dozen sliders at once
MOST = 200_000
#: samples that a window needs
FEWEST = 30


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
    of_usual_size(friction, data)
    t = time - time[0]
    order = np.arange(t.size)
    displacement = displacement_of(data, t)
    loading = loading_of(data, displacement, time, loading)
    if against == "displacement":
        t, order = times_of(displacement, loading, t)
        friction, time = friction[order], time[order]
    has_steps(loading, t)
    along = t if trend == "time" else np.asarray(loading.delta_lp(t))
    return Record(t, friction, along, trend, loading, kind, time, order)
