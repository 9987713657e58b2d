"""Healing and relaxation of one hold, with standard errors."""

import math
from typing import NamedTuple

import numpy as np

from ..kit.polynomial_windows import GROWTH, fewest_samples, largest_straight, window_of
from ..kit.regression import generalized_least_squares
from ..kit.sample_noise import OF_STEP, resolution
from .peak import FEW, maximum_of, peak_window
from .slide_noise import FEWEST
from .sliding import Level

#: orders of friction in ln(time since the hold began): tested, and used
TESTED, USED = 1, 3
#: fewest samples of a hold
FEWEST_OF_HOLD = fewest_samples(USED)
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
FRICTIONS = ("friction_before", "friction_min", "friction_peak", "friction_after")
DIFFERENCES = ("delta_mu", "delta_mu_c")
NAMES = (*FRICTIONS, *DIFFERENCES)


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
    found = {}
    for name, (value, error) in one.found.items():
        values = 2 if name in DIFFERENCES else 1
        found[name] = value, max(error, math.sqrt(values) * least)
    return one._replace(found=found)


def _measure(record, hold, noise, levels):
    """As `measure`, by the noise alone."""
    before, after = (levels.get(_first(rows)) for rows in (hold.before, hold.after))
    if hold.before.size < FEWEST:
        return Measured(NO_SLIDE, {})
    if hold.during.size < FEWEST_OF_HOLD:
        return Measured(SHORT, {})
    if before is None:
        return Measured(UNSTEADY, {})
    end = _end_of_hold(record, hold, noise)
    level = before.at(record.along_at(hold.end, end[0]))
    found = {
        "friction_before": before.at(before.end),
        "friction_min": end,
        "delta_mu_c": _difference(level, end),
    }
    if hold.after.size < FEWEST:
        return Measured(ENDS, found)
    status, at, peak = _peak(record, hold, noise, end[0])
    if status:
        return Measured(status, found)
    along = record.along_at(at, peak[0])
    found |= {"friction_peak": peak, "delta_mu": _difference(peak, before.at(along))}
    if after is not None:
        found["friction_after"] = after.at(after.end)
    if before.at(along)[1] > UNKNOWN * abs(found["delta_mu"][0]):
        return Measured(UNSTEADY, {})
    return Measured(EVALUATED, found, at, before, along)


def _first(rows):
    """First of rows; -1 without any."""
    return int(rows[0]) if rows.size else -1


def _difference(one, other):
    """Difference of two independent values with standard errors."""
    return one[0] - other[0], float(np.hypot(one[1], other[1]))


def _end_of_hold(record, hold, noise):
    """Friction at the end of a hold: of a polynomial in the logarithm of its duration."""
    rows = hold.during
    age = np.log(np.maximum(record.t - hold.start, 0.5 * record.spacing))
    sizes, size = [], float(FEWEST_OF_HOLD)
    while size < rows.size:
        sizes.append(int(size))
        size *= GROWTH
    windows = [rows[-size:] for size in [*sizes, rows.size]]
    best = largest_straight(record.t, age, record.friction, windows, TESTED, noise)
    window = window_of(age, windows[0] if best is None else best, USED)
    return _value(window, np.log(hold.end - hold.start), _fit(record, window, age, noise))


def _peak(record, hold, noise, low):
    """Status, time [s], and (friction, standard error) of the peak after a hold.

    low : friction at the end of the hold
    """
    window, smaller, own = peak_window(record, hold.after, noise)
    fit = _fit(record, window, record.t, own)
    at = maximum_of(window, fit.coefficients)
    if at is None:
        return (ENDS if window.rows[-1] == hold.after[-1] else NO_PEAK), np.nan, None
    if np.count_nonzero(record.t[hold.after] > window.high) < FEWEST:
        return ENDS, np.nan, None
    peak, error = _maximum(window, at, fit)
    if own.level > FEW * noise.level and error > COARSE * (peak - low):
        return UNRESOLVED, np.nan, None
    late = hold.after[-FEWEST:]
    change = np.interp(at, record.t, record.level - record.friction)
    height = peak + change - record.level[late].mean()
    if height < RESOLVED * np.hypot(error, np.hypot(noise.white * FEWEST**-0.5, noise.red)):
        return NO_PEAK, np.nan, None
    if smaller is not None:
        error = math.hypot(error, _misfit(record, smaller, own, peak, error))
    return EVALUATED, at, (peak, error)


def _misfit(record, smaller, noise, peak, error):
    """By how much the polynomial of a peak may be off: the peak's change in the smaller window.

    A window grows until the misfit is significant.  Just before, it may exceed the standard error.
    The larger window has the samples of the smaller one, so noise changes the peak by the
    difference of their variances, which is subtracted.
    """
    fit = _fit(record, smaller, record.t, noise)
    at = maximum_of(smaller, fit.coefficients)
    if at is None:
        return 0.0
    other, larger_error = _maximum(smaller, at, fit)
    return math.sqrt(max((other - peak) ** 2 - (larger_error**2 - error**2), 0.0))


def _maximum(window, at, fit):
    """Friction at its maximum, without what noise adds on average to that of a polynomial."""
    slope, curvature = (window.basis(at, k)[0] for k in (1, 2))
    excess = 0.5 * (slope @ fit.covariance @ slope) / (curvature @ fit.coefficients)  # < 0
    value, error = _value(window, at, fit)
    return value + float(excess), error


def _fit(record, window, x, noise):
    """The `Linear` of friction by a window's polynomial in x."""
    rows = window.rows
    return generalized_least_squares(
        record.t[rows], record.friction[rows], window.basis(x[rows]), noise
    )


def _value(window, x, fit):
    """Value of a window's polynomial at x, and its standard error."""
    row = window.basis(x)[0]
    return float(row @ fit.coefficients), float(np.sqrt(row @ fit.covariance @ row))
