"""Healing and relaxation of one hold, with standard errors.

The largest noisy sample is two or three standard deviations of the noise above the peak.  So the
peak is taken from a polynomial fitted to the samples around it, or after it if friction rises fast.
"""

import math
from typing import NamedTuple

import numpy as np
import scipy

from ..kit.regression import (
    CERTAIN,
    SIGNIFICANT,
    curvature,
    fitted_polynomial,
    windows_that_pass,
)
from ..kit.sample_noise import OF_STEP, resolution
from .holds import FEWEST, GUARD, LAST
from .steady import Level

#: orders of polynomials in ln(time since the hold began): tested, and used; fewest samples
TESTED, USED = 1, 3
FEWEST_OF_HOLD = USED + 3
#: orders of the polynomial around a peak: tested, and used; fewest samples; coefficients tested
PEAK_TESTED, PEAK_USED, ORDERS = 3, 5, 2
FEWEST_OF_PEAK = PEAK_USED + 3
#: noise around a peak, as a multiple of the record's, above which the samples are too few
MAX_NOISE = math.sqrt(CERTAIN / ORDERS)
#: successive windows that must fail, because noise may make a single one fail
FAILED = 2
#: least height of a peak above friction at the end of the slide, in standard errors
RESOLVED = 3.0
#: largest error of the level before, as a fraction of healing; largest error of a peak with too few
#: samples, as a fraction of its rise from the end of the hold
UNKNOWN, COARSE = 0.5, 0.02

#: last part of a slide, in which friction must be steady before a hold; number of means there;
#: largest deviation of one of them by noise, in standard deviations; fewest samples of a mean
ENDING, PARTS, LIKELY, SMALLEST = 0.125, 8, 3.0, 4

#: statuses of holds; the number of each is its index, and its message is in messages.toml
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

#: measured quantities of a hold; each has a standard error
DIFFERENCES = ("delta_mu", "delta_mu_c")
NAMES = ("friction_before", "friction_min", "friction_peak", "friction_after", *DIFFERENCES)


class MeasuredHold(NamedTuple):
    """The measured quantities of a hold."""

    status: int
    values: dict  # name -> (value, standard error) for those of `NAMES` that are known
    peak_time: float = np.nan  # [s]
    before: Level | None = None  # level of the slide before, if healing is evaluated
    drift_coordinate: float = np.nan  # at the peak


def measure(record, hold, noise, levels):
    """Return the `MeasuredHold` quantities of a `Hold`, given the result of `levels_of`.

    No standard error is less than the error from rounding friction to its digits.  A difference has
    two rounding errors.  If the noise is larger than the last digit, a mean of samples has less of
    this error (Widrow, Kollar & Liu 1996 doi:10.1109/19.492748).
    """
    measured = _measured_with_noise(record, hold, noise, levels)
    step = resolution(record.friction)
    other = max(noise.level**2 - (OF_STEP * step) ** 2, 0.0)
    least = OF_STEP * step * np.exp(-2.0 * np.pi**2 * other / step**2) if step else 0.0
    values = {
        name: (value, max(error, math.sqrt(2.0 if name in DIFFERENCES else 1.0) * least))
        for name, (value, error) in measured.values.items()
    }
    return measured._replace(values=values)


def _measured_with_noise(record, hold, noise, levels):
    if hold.before.rows.size < FEWEST:
        return MeasuredHold(NO_SLIDE, {})
    if hold.during.rows.size < FEWEST_OF_HOLD:
        return MeasuredHold(SHORT, {})
    before, after = levels.get(hold.number - 1), levels.get(hold.number + 1)
    if before is None:
        return MeasuredHold(UNSTEADY, {})
    end = _end_of_hold(record, hold, noise)
    unsteady = _distance_from_steady(record, hold.before.rows, before, noise)
    level = before.at(record.drift_coordinate_at(hold.during.end, end[0]))
    values = {"friction_before": before.at(before.end), "friction_min": end}
    values["delta_mu_c"] = _difference(level, end, unsteady)
    if hold.after.rows.size < FEWEST:
        return MeasuredHold(ENDS, values)
    status, at, peak = _peak(record, hold, noise, end[0])
    if status:
        return MeasuredHold(status, values)
    drift_coordinate = record.drift_coordinate_at(at, peak[0])
    level = before.at(drift_coordinate)
    values |= {"friction_peak": peak, "delta_mu": _difference(peak, level, unsteady)}
    if after is not None:
        values["friction_after"] = after.at(after.end)
    largest = UNKNOWN * abs(values["delta_mu"][0])
    if level[1] > largest:
        return MeasuredHold(UNSTEADY, {})
    if math.hypot(level[1], unsteady) > largest:
        del values["delta_mu"]
        return MeasuredHold(UNSTEADY, values, at)
    return MeasuredHold(EVALUATED, values, at, before, drift_coordinate)


def _difference(value, reference, unsteady):
    return value[0] - reference[0], math.hypot(value[1], reference[1], unsteady)


def _distance_from_steady(record, rows, level, noise):
    """Return how far friction is from its level when a hold begins; 0 if noise explains it.

    A hold that begins before the slide is steady heals differently, by up to about this much.  It
    is the largest distance in the last part of the slide, because friction may cross its level
    while the state is far from steady.

    rows : samples of the slide before the hold
    """
    last = rows[-max(int(ENDING * rows.size), LAST) :]
    distances = record.friction[last] - level.at(record.drift_coordinate[last])[0]
    count = min(PARTS, last.size // SMALLEST)
    largest = max(abs(float(part.mean())) for part in np.array_split(distances, count))
    size = -(-last.size // count)  # of the first part
    duration = record.t[last[size - 1]] - record.t[last[0]]
    red = noise.red * min(1.0, math.sqrt(2.0 * noise.time / duration)) if noise.red else 0.0
    by_noise = LIKELY * math.hypot(noise.white * size**-0.5, red)
    return math.sqrt(max(largest**2 - by_noise**2, 0.0))


def _end_of_hold(record, hold, noise):
    """Return friction at the end of a hold, from a polynomial in log time, and its error."""
    spacing, rows = float(np.median(np.diff(record.t))), hold.during.rows
    age = np.log(np.maximum(record.t - hold.during.start, 0.5 * spacing))
    columns = record.t, age, record.friction

    def passes(size, _):
        return curvature(*columns, rows[-size:], TESTED, noise) <= SIGNIFICANT

    size = max(windows_that_pass(FEWEST_OF_HOLD, rows.size, passes, 1), default=FEWEST_OF_HOLD)
    fit = fitted_polynomial(*columns, rows[-size:], USED, noise)
    return fit.at(np.log(hold.duration))


def _peak(record, hold, noise, low):
    """Return status, time [s], and (friction, standard error) of the peak after a hold.

    low : friction at the end of the hold
    """
    t, slide = record.t, hold.after.rows
    columns = t, t, record.friction

    def passes(size, sizes):
        rows = _about_maximum(record.level, slide, size)
        # (until a window passes, test all orders that are used)
        order, most = (PEAK_TESTED, SIGNIFICANT) if sizes else (PEAK_USED, CERTAIN)
        return curvature(*columns, rows, order, noise) <= most

    sizes = windows_that_pass(FEWEST_OF_PEAK, slide.size, passes, FAILED)
    rows, *smaller = (
        _about_maximum(record.level, slide, size) for size in sizes[:-3:-1] or [FEWEST_OF_PEAK]
    )
    excess = 0.0 if smaller else curvature(*columns, rows, PEAK_USED, noise)
    local = noise.times(max(math.sqrt(excess / ORDERS), 1.0))  # (enlarged by a misfit)
    found = fitted_polynomial(*columns, rows, PEAK_USED, local).peak
    if found is None and rows[-1] == slide[-1]:
        return ENDS, np.nan, None
    too_few = local.level > MAX_NOISE * noise.level
    # friction that rises in fewer samples than half a window has a peak between two samples
    high = record.level[slide[0] - GUARD : slide[-1] + 1]
    first = slide[0] - GUARD + int(np.argmax(high >= high.max() - LIKELY * noise.level))
    is_sharp = found is None or first < slide[FEWEST_OF_PEAK // 2]
    if is_sharp or (too_few and found[2] > COARSE * (found[1] - low)):
        found, smaller = _sharp_peak(record, slide, first, noise), []
        too_few = found[2] > noise.level
    at, peak, error = found
    if np.count_nonzero(t[slide] > t[rows[-1]]) < FEWEST:
        return ENDS, np.nan, None
    if too_few and error > COARSE * (peak - low):
        return UNRESOLVED, np.nan, None
    change = np.interp(at, t, record.level - record.friction)
    height = peak + change - record.level[slide[-FEWEST:]].mean()
    if height < RESOLVED * np.hypot(error, np.hypot(noise.white * FEWEST**-0.5, noise.red)):
        return NO_PEAK, np.nan, None
    if smaller and (other := fitted_polynomial(*columns, smaller[0], PEAK_USED, local).peak):
        # (the distance between both peaks beyond the random error is part of the error)
        misfit = (other[1] - peak) ** 2 - (other[2] ** 2 - error**2)
        error = math.hypot(error, math.sqrt(max(misfit, 0.0)))
    return EVALUATED, at, (peak, error)


def _sharp_peak(record, slide, first, noise):
    """Return time [s], friction and standard error of a peak to which friction rises in few steps.

    The peak is between a sample and the one before.  There it is between friction at the sample and
    the extrapolated curve of friction after it.

    first : the sample
    """
    t, columns = record.t, (record.t, record.t, record.friction)
    rows = np.arange(first, slide[-1] + 1)

    def passes(size, _):
        return curvature(*columns, rows[:size], TESTED, noise) <= SIGNIFICANT

    sizes = windows_that_pass(FEWEST_OF_HOLD, rows.size, passes, FAILED)
    rows = rows[: max(sizes, default=FEWEST_OF_HOLD)]
    excess = 0.0 if sizes else curvature(*columns, rows, USED, noise)
    fit = fitted_polynomial(*columns, rows, USED, noise.times(max(math.sqrt(excess / ORDERS), 1.0)))
    at = 0.5 * (t[first - 1] + t[first])
    value, error = fit.at(t[first])
    beyond = max(fit.at(at)[0] - value, 0.0)
    return at, value + beyond, math.hypot(error, beyond)


def _about_maximum(friction, slide, width):
    """Return rows of a window of this width around the largest moving average of a slide."""
    smooth = scipy.ndimage.uniform_filter1d(friction[slide], max(width // 3, 1), mode="nearest")
    first = min(max(int(np.argmax(smooth)) - width // 2, 0), slide.size - width)
    return slide[first : first + width]
