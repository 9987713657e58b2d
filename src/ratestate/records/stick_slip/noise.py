"""The noise of a record of stick-slip: in the loading, white or correlated."""

import math
from typing import NamedTuple

import numpy as np

#: part of the rise of stress, in time, whose residuals are the noise
CALM = (0.2, 0.6)
#: degree of the polynomial there
SMOOTH = 3
#: fewest samples there, and most of them from which the noise is found, in all
FEWEST, ENOUGH = 12, 20000
#: standard errors from which a correlation counts; the largest
KNOWN, MOST_CORRELATED = 3.0, 0.95


class Noise(NamedTuple):
    """White or first-order correlated noise: standard deviation, and what it does to a mean."""

    sd: float
    correlation: float = 0.0  # of neighbouring samples

    @property
    def inflation(self):
        """Variance of a mean over that with white noise."""
        return (1.0 + self.correlation) / (1.0 - self.correlation)


def loading_noise(t, y, rises, white):
    """`Noise` about smooth curves through the rises [(first, last sample)], or the white one."""
    residuals: list[np.ndarray] = []
    for first, last in rises:
        begin, end = (round(first + part * (last - first)) for part in CALM)
        if end - begin < FEWEST:
            continue
        x = (t[begin:end] - t[begin]) / (t[end - 1] - t[begin]) * 2.0 - 1.0
        curve = np.polynomial.Polynomial.fit(x, y[begin:end], SMOOTH)
        residuals.append(y[begin:end] - curve(x))
        if sum(map(len, residuals)) > ENOUGH:
            break
    power = sum(float(rest @ rest) for rest in residuals)
    if not power > 0.0:
        return Noise(white)
    samples, taken = sum(map(len, residuals)), (SMOOTH + 1) * len(residuals)
    pairs = samples - len(residuals)
    products = sum(float(rest[1:] @ rest[:-1]) for rest in residuals)
    # (a fit takes some correlation out: by its degree over the samples, to first order)
    correlation = products / power + taken / pairs
    known = correlation > KNOWN / math.sqrt(pairs)
    correlation = min(correlation, MOST_CORRELATED) if known else 0.0
    return Noise(math.sqrt(power / (samples - taken)), correlation)
