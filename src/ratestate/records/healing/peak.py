"""Where friction peaks after a hold: the window about it, and the maximum of a polynomial there.

The largest of noisy samples is above the peak, by two or three standard deviations of the noise.
The maximum of a polynomial fitted to samples about the peak is above it by far less, by half the
variance of the slope over the curvature, which is subtracted.
"""

import math

import numpy as np
from scipy.ndimage import uniform_filter1d

from ..kit.polynomial_windows import (
    CERTAIN,
    GROWTH,
    SIGNIFICANT,
    curvature,
    fewest_samples,
    window_of,
)

#: orders: of the polynomial that is tested, and of the one that is used; orders of a test
TESTED, USED, ORDERS = 3, 5, 2
#: noise about a peak, as a multiple of the record's, if samples are too few for all its orders
FEW = math.sqrt(CERTAIN / ORDERS)
#: successive windows that must fail: noise about the largest sample may be odd in one
FAILED = 2
#: a peak is within this part of its window about the middle
INSIDE = 0.9
#: points at which a polynomial is searched for its maximum
POINTS = 801


def peak_window(record, slide, noise):
    """The `Window` about the peak of a slide (rows), the next smaller one, and the noise in them.

    If no smaller window passes the test, it is None, and the noise is at least the misfit.
    """
    t, friction = record.t, record.friction
    best = smaller = None
    width, failed = float(fewest_samples(USED)), 0
    while width <= slide.size and failed < FAILED:
        rows = _about_maximum(record.level, slide, int(width))
        width *= GROWTH
        # (the smallest ones may need all orders that are used)
        order, least = (USED, CERTAIN) if best is None else (TESTED, SIGNIFICANT)
        if curvature(t, t, friction, rows, order, noise) > least:
            failed += 1
        else:
            smaller, best, failed = best, rows, 0
    if best is None:
        best = _about_maximum(record.level, slide, fewest_samples(USED))
    if smaller is not None:
        return window_of(t, best, USED), window_of(t, smaller, USED), noise
    excess = curvature(t, t, friction, best, USED, noise)
    return window_of(t, best, USED), None, _enlarged(noise, max(math.sqrt(excess / ORDERS), 1.0))


def _enlarged(noise, factor):
    """A `Noise` with standard deviations larger by a factor."""
    return noise._replace(white=factor * noise.white, red=factor * noise.red)


def _about_maximum(friction, slide, width):
    """So many rows about the largest moving average of a slide, as far as the slide goes."""
    smooth = uniform_filter1d(friction[slide], max(width // 3, 1), mode="nearest")
    centre = int(np.argmax(smooth))
    first = min(max(centre - width // 2, 0), slide.size - width)
    return slide[first : first + width]


def maximum_of(window, coefficients):
    """Abscissa of the maximum of a window's polynomial; None if that is at an end, or none."""
    edge = 0.5 * (1.0 - INSIDE) * (window.high - window.low)
    x = np.linspace(window.low, window.high, POINTS)
    at = x[int(np.argmax(window.basis(x) @ coefficients))]
    if not window.low + edge < at < window.high - edge:
        return None
    # (once is enough: the points are so close)
    slope, curvature = (float((window.basis(at, k) @ coefficients)[0]) for k in (1, 2))
    return float(at - slope / curvature) if curvature < 0.0 else None
