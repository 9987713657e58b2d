"""The noise of a record about its folded cycle."""

from typing import NamedTuple

import numpy as np


class Noise(NamedTuple):
    """Noise of first-order correlation from sample to sample."""

    sd: float
    correlation: float

    def draw(self, n, rng):
        """(n,) values."""
        white = rng.standard_normal(n) * self.sd
        if self.correlation == 0.0:
            return white
        from scipy.signal import lfilter

        white[1:] *= np.sqrt(1.0 - self.correlation**2)
        return lfilter([1.0], [1.0, -self.correlation], white)


def residual_noise(segment, cycles):
    """`Noise` of a record about its folded cycle; robust against a few outliers."""
    inside = (cycles.phase >= 0.0) & (cycles.phase < cycles.n)
    t, phase = segment.t[inside], cycles.phase[inside]
    residual = segment.y[inside] - cycles.at(t)
    middles = np.arange(cycles.n) + 0.5
    residual -= np.interp(phase, middles, cycles.means)
    sd = 1.4826 * float(np.median(np.abs(residual)))
    sd *= np.sqrt(residual.size / max(residual.size - cycles.profile.size, 0.25 * residual.size))
    residual = np.clip(residual, -3.0 * sd, 3.0 * sd)
    power = float(residual @ residual)
    correlation = float(residual[1:] @ residual[:-1]) / power if power > 0.0 else 0.0
    # white noise has 0 within 3 standard errors
    correlation = 0.0 if abs(correlation) < 3.0 / np.sqrt(residual.size) else correlation
    return Noise(sd, float(np.clip(correlation, 0.0, 0.99)))
