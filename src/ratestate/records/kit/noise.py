"""The noise of a record: its level and correlation.

The noise is white noise plus a correlated part (engine/noise.py).  White noise comes from a load
cell's digits and electronics, correlated noise from filters, gouge, temperature and machine.  The
correlated part is one relaxation (an Ornstein-Uhlenbeck process).  For noise whose spectrum is a
power of frequency, such as 1/f, it is a sum of relaxations, about one per decade.  The user gives
the parameters, or they are estimated (estimated_noise.py).
"""

import functools
import math
from typing import NamedTuple

import numpy as np

from ...engine.noise import whiten
from ...model.units import one_in_si
from ..messages import kit as sentences


class Noise(NamedTuple):
    """Standard deviations of the white and the correlated part, and the correlation time [s].

    With an exponent, the spectrum of the correlated part is proportional to frequency to the power
    of -exponent above 1/time.  It is a sum of relaxations, about one per decade, with times from
    `time` down to the time between samples.
    """

    white: float
    red: float = 0.0
    time: float = 1.0
    exponent: float | None = None

    def relaxations(self, spacing):
        """Return variances (m,) and times (m,) [s] of relaxations for a sample spacing [s]."""
        if self.exponent is None:
            return np.array([self.red**2]), np.array([self.time])
        times = _decades(self.time, spacing)
        weights = (times / self.time) ** (self.exponent - 1.0)
        return self.red**2 * weights / weights.sum(), times

    def whiten(self, t, columns):
        """Transform columns (n, k) at times t (n,) to unit white noise; return ln det(cov) too."""
        columns = np.ascontiguousarray(np.reshape(columns, (t.size, -1)))
        dt = np.diff(t)
        return self.whiten_steps(dt, float(np.median(dt)) if self.red else 0.0, columns)

    def whiten_steps(self, dt, spacing, columns):
        """Do the same as `whiten` for steps dt (n - 1,) between samples [s].

        spacing : median of dt
        columns : (n, k), contiguous
        """
        if self.red == 0.0:
            return columns / self.white, 2.0 * len(columns) * math.log(self.white)
        variances, times = self.relaxations(spacing)
        return whiten(dt, self.white**2, variances, times, columns)

    @property
    def level(self):
        """Return the standard deviation of one sample."""
        return math.hypot(self.white, self.red)

    def times(self, factor):
        """Return noise of the same shape multiplied by a factor."""
        return self._replace(white=factor * self.white, red=factor * self.red)


@functools.lru_cache(maxsize=16)
def _decades(longest, shortest):
    """Return times [s], about one per decade, from the longest down to the shortest."""
    times = np.geomspace(longest, shortest, 1 + max(round(math.log10(longest / shortest)), 1))
    times.flags.writeable = False
    return times


#: white noise of unit variance
WHITE = Noise(1.0)


def given_noise(noise):
    """Return the `Noise` that the user gives, or None if it must be estimated.

    noise : None, a standard deviation of friction, or a dict of "white", "red" and "time".
        Anything else, "red" without "time", or no positive part raises ParameterError.
    """
    if noise is None:
        return None
    if not isinstance(noise, dict):
        return Noise(one_in_si("noise", noise))
    if not set(noise) <= {"white", "red", "time"} or not noise:
        raise sentences.refusal("noise.form", noise=noise)
    if "red" in noise and "time" not in noise:
        raise sentences.refusal("noise.no_time")
    white, red = (
        one_in_si("noise", noise.get(k, 0.0), label=f"noise {k}", bound=">= 0")
        for k in ("white", "red")
    )
    if not white + red > 0.0:
        raise sentences.refusal("noise.zero")
    time = one_in_si("t", noise.get("time", 1.0), label="noise time", bound="> 0")
    return Noise(white, red, time)
