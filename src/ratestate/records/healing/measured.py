"""Healing and relaxation of one hold, with standard errors.

The largest of noisy samples is above the peak, by two or three standard deviations of the noise.
So the peak is that of a polynomial fitted to samples about it.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from ..kit.polynomial_windows import (
    CERTAIN,
    SIGNIFICANT,
    curvature,
    fewest_samples,
    fitted_polynomial,
    windows_that_pass,
)
from ..kit.sample_noise import OF_STEP, resolution
from .record import FEWEST
from .steady import Level

#: orders of friction in ln(time since the hold began): tested, and used; fewest samples of a hold
TESTED, USED = 1, 3
FEWEST_OF_HOLD = fewest_samples(USED)
#: orders of the polynomial about a peak: tested, and used; fewest samples; orders of a test
PEAK_TESTED, PEAK_USED, ORDERS = 3, 5, 2
FEWEST_OF_PEAK = fewest_samples(PEAK_USED)
#: noise about a peak, as a multiple of the record's, if samples are too few for all its orders
FEW = math.sqrt(CERTAIN / ORDERS)
#: successive windows that must fail: noise about the largest sample may be odd in one
FAILED = 2
#: standard errors by which a peak is above friction at the end of the slide
RESOLVED = 3.0
#: largest error of the level before, as a fraction of healing; and of a peak between samples, as a
#: fraction of its rise from the end of the hold
UNKNOWN, COARSE = 0.5, 0.02

#: how holds end; the number of each is its place, and its sentence is in messages.toml
STATUSES = (
    "evaluated",
    "no_slide_before",
    "not_steady_before",
    "short_hold",
    "record_ends",
    "no_peak",
    "peak_not_resolved",
)
(EVALUATED, NO_SLIDE, UNSTEADY, SHORT, ENDS, NO_PEAK, UNRESOLVED) = range(len(STATUSES))

#: what is measured of a hold; each has a standard error
DIFFERENCES = ("delta_mu", "delta_mu_c")
NAMES = ("friction_before", "friction_min", "friction_peak", "friction_after", *DIFFERENCES)


class Measured(NamedTuple):
    """What a hold shows: name -> (value, standard error) of `NAMES`, as far as there is any."""

    status: int
    found: dict
    peak_time: float = np.nan  # [s]
    before: Level | None = None  # of the slide before, if healing is evaluated
    along: float = np.nan  # what friction drifts along, at the peak


def measure(record, hold, noise, levels):
    """`Measured` of a `Hold` of a `HealingRecord` with this noise, and `levels_of` it.

    No standard error is less than that of rounding to the digits of friction; a difference is of
    two rounded values.  The mean of samples has less of it, if noise is larger than the last digit
    (Widrow, Kollar & Liu 1996 doi:10.1109/19.492748).
    """
    one = _measure(record, hold, noise, levels)
    step = resolution(record.friction)
    other = max(noise.level**2 - (OF_STEP * step) ** 2, 0.0)
    least = OF_STEP * step * np.exp(-2.0 * np.pi**2 * other / step**2) if step else 0.0
    found = {
        name: (value, max(error, math.sqrt(2.0 if name in DIFFERENCES else 1.0) * least))
        for name, (value, error) in one.found.items()
    }
    return one._replace(found=found)


def _measure(record, hold, noise, levels):
    """As `measure`, by the noise alone."""
    if hold.before.rows.size < FEWEST:
        return Measured(NO_SLIDE, {})
    if hold.during.rows.size < FEWEST_OF_HOLD:
        return Measured(SHORT, {})
    before, after = levels.get(hold.number - 1), levels.get(hold.number + 1)
    if before is None:
        return Measured(UNSTEADY, {})
    end = _end_of_hold(record, hold, noise)
    found = {
        "friction_before": before.at(before.end),
        "friction_min": end,
        "delta_mu_c": _difference(before.at(record.along_at(hold.during.end, end[0])), end),
    }
    if hold.after.rows.size < FEWEST:
        return Measured(ENDS, found)
    status, at, peak = _peak(record, hold, noise, end[0])
    if status:
        return Measured(status, found)
    along = record.along_at(at, peak[0])
    level = before.at(along)
    found |= {"friction_peak": peak, "delta_mu": _difference(peak, level)}
    if after is not None:
        found["friction_after"] = after.at(after.end)
    if level[1] > UNKNOWN * abs(found["delta_mu"][0]):
        return Measured(UNSTEADY, {})
    return Measured(EVALUATED, found, at, before, along)


def _difference(one, other):
    return one[0] - other[0], float(np.hypot(one[1], other[1]))


def _end_of_hold(record, hold, noise):
    """Friction at the end of a hold: of a polynomial in the logarithm of its duration."""
    spacing, rows = float(np.median(np.diff(record.t))), hold.during.rows
    age = np.log(np.maximum(record.t - hold.during.start, 0.5 * spacing))
    columns = record.t, age, record.friction

    def passes(size, _):
        return curvature(*columns, rows[-size:], TESTED, noise) <= SIGNIFICANT

    size = max(windows_that_pass(FEWEST_OF_HOLD, rows.size, passes, 1), default=FEWEST_OF_HOLD)
    fit = fitted_polynomial(*columns, rows[-size:], USED, noise)
    return fit.at(np.log(hold.duration))


def _peak(record, hold, noise, low):
    """Status, time [s], and (friction, standard error) of the peak after a hold.

    low : friction at the end of the hold
    """
    t, slide = record.t, hold.after.rows
    columns = t, t, record.friction

    def passes(size, passed):
        rows = _about_maximum(record.level, slide, size)
        # (the smallest ones may need all orders that are used)
        order, most = (PEAK_TESTED, SIGNIFICANT) if passed else (PEAK_USED, CERTAIN)
        return curvature(*columns, rows, order, noise) <= most

    passed = windows_that_pass(FEWEST_OF_PEAK, slide.size, passes, FAILED)
    rows, *smaller = (
        _about_maximum(record.level, slide, size) for size in passed[:-3:-1] or [FEWEST_OF_PEAK]
    )
    excess = 0.0 if smaller else curvature(*columns, rows, PEAK_USED, noise)
    own = noise.times(max(math.sqrt(excess / ORDERS), 1.0))  # (at least the misfit)
    fit = fitted_polynomial(*columns, rows, PEAK_USED, own)
    if fit.peak is None:
        return (ENDS if rows[-1] == slide[-1] else NO_PEAK), np.nan, None
    at, peak, error = fit.peak
    if np.count_nonzero(t[slide] > t[rows[-1]]) < FEWEST:
        return ENDS, np.nan, None
    if own.level > FEW * noise.level and error > COARSE * (peak - low):
        return UNRESOLVED, np.nan, None
    change = np.interp(at, t, record.level - record.friction)
    height = peak + change - record.level[slide[-FEWEST:]].mean()
    if height < RESOLVED * np.hypot(error, np.hypot(noise.white * FEWEST**-0.5, noise.red)):
        return NO_PEAK, np.nan, None
    if smaller and (other := fitted_polynomial(*columns, smaller[0], PEAK_USED, own).peak):
        # (how far both peaks are apart beyond what is random is a part of the error)
        misfit = (other[1] - peak) ** 2 - (other[2] ** 2 - error**2)
        error = math.hypot(error, math.sqrt(max(misfit, 0.0)))
    return EVALUATED, at, (peak, error)


def _about_maximum(friction, slide, width):
    """So many rows about the largest moving average of a slide, as far as the slide goes."""
    smooth = uniform_filter1d(friction[slide], max(width // 3, 1), mode="nearest")
    first = min(max(int(np.argmax(smooth)) - width // 2, 0), slide.size - width)
    return slide[first : first + width]
