"""Healing and relaxation of one hold, with standard errors.

The largest noisy sample is two or three standard deviations of the noise above the peak.  So the
peak is taken from a polynomial fitted to the samples around it, or after it if friction rises fast.
"""

import math
from typing import NamedTuple

import numpy as np
import scipy

from ..kit.sample_noise import OF_STEP, resolution
from .holds import FEWEST, GUARD, LAST
from .polynomials import ADDED, largest_fits
from .steady import Level

#: orders of polynomials, tested and used, in ln(time since the hold began) and after a sharp peak,
#: and around a smooth peak; their fewest samples
ORDERS, PEAK_ORDERS = (1, 3), (3, 5)
FEWEST_OF_HOLD, FEWEST_OF_PEAK = (used + ADDED + 1 for _, used in (ORDERS, PEAK_ORDERS))
#: enlargement of the noise by a misfit around a peak, above which the samples are too few: chance
#: exceeds this fall of chi-square in 1 of 10,000 windows
MAX_MISFIT = math.sqrt(18.42 / ADDED)
#: samples in which friction rises to a sharp peak, at most; samples that are averaged there
SHARP, AVERAGED = 4, 3
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
    dither = max(noise.level**2 - (OF_STEP * step) ** 2, 0.0)
    least = OF_STEP * step * np.exp(-2.0 * np.pi**2 * dither / step**2) if step else 0.0
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
    fits, _ = largest_fits(columns, lambda size: rows[-size:], rows.size, *ORDERS, noise)
    return fits[0].at(np.log(hold.duration))


def _peak(record, hold, noise, low):
    """Return status, time [s], and (friction, standard error) of the peak after a hold.

    low : friction at the end of the hold
    """
    t, slide = record.t, hold.after.rows
    smooth, end, too_few = _smooth_peaks(record, slide, noise)
    sharp, rise = _sharp_peaks(record, slide, noise)
    is_coarse = bool(smooth) and too_few and smooth[0][2] > COARSE * (smooth[0][1] - low)
    if sharp and (not smooth or is_coarse or rise < SHARP):
        peaks, end, too_few = sharp, sharp[0][0], sharp[0][2] > noise.level
    else:
        peaks = smooth + (sharp[:1] if rise < FEWEST_OF_PEAK else [])
    if not peaks:
        return (ENDS if end == t[slide[-1]] else NO_PEAK), np.nan, None
    (at, peak, error), *smaller = peaks
    if np.count_nonzero(t[slide] > end) < FEWEST:
        return ENDS, np.nan, None
    # (the distance between the peaks beyond the random error is part of the error)
    misfits = [(y - peak) ** 2 - abs(y_error**2 - error**2) for _, y, y_error in smaller]
    error = math.hypot(error, math.sqrt(max([0.0, *misfits])))
    if too_few and error > COARSE * (peak - low):
        return UNRESOLVED, np.nan, None
    change = np.interp(at, t, record.level - record.friction)
    height = peak + change - record.level[slide[-FEWEST:]].mean()
    if height < RESOLVED * np.hypot(error, np.hypot(noise.white * FEWEST**-0.5, noise.red)):
        return NO_PEAK, np.nan, None
    return EVALUATED, at, (peak, error)


def _smooth_peaks(record, slide, noise):
    """Return peaks (time [s], friction, standard error) of polynomials around the maximum.

    The polynomial in the largest window that it describes comes first, then that in the window
    before.  Peaks at the end of a window are left out.  Also returns the end of the first window
    [s], and whether its samples are too few.
    """
    columns = record.t, record.t, record.friction

    def window(size):
        """Return the rows around the largest moving average of the slide."""
        level = record.level[slide]
        smooth = scipy.ndimage.uniform_filter1d(level, max(size // 3, 1), mode="nearest")
        first = min(max(int(np.argmax(smooth)) - size // 2, 0), slide.size - size)
        return slide[first : first + size]

    fits, misfit = largest_fits(columns, window, slide.size, *PEAK_ORDERS, noise)
    peaks = [fit.peak for fit in fits]
    found = [peak for peak in peaks if peak] if peaks[0] else []
    return found, fits[0].curve.domain[1], misfit > MAX_MISFIT


def _sharp_peaks(record, slide, noise):
    """Return peaks as `_smooth_peaks` if friction rises to the peak in few steps, and falls slowly.

    Such a peak is between a sample and the one before.  There it is between friction at the sample
    and the extrapolated curve of friction after it.  The list is empty if friction does not rise
    suddenly.  Also returns the number of samples before the peak.
    """
    t, columns = record.t, (record.t, record.t, record.friction)
    rows = np.arange(slide[0] - GUARD, slide[-1] + 1)
    level, clear = record.level[rows], LIKELY * noise.level
    top = max(scipy.ndimage.uniform_filter1d(level, AVERAGED).max(), level.max() - clear)
    rise = int(np.argmax(level >= top - clear))
    rise += int(np.argmax(level[rise : rise + AVERAGED]))
    first, rows = rows[rise], rows[rise:]
    before, after = record.level[first - 2 : first].min(), record.level[rows[:AVERAGED]]
    if rows.size < FEWEST or not before < np.median(after) - clear:
        return [], rise
    fits, _ = largest_fits(columns, lambda size: rows[:size], rows.size, *ORDERS, noise)
    at, peaks = 0.5 * (t[first - 1] + t[first]), []
    for fit in fits:
        value, error = fit.at(t[first])
        beyond = max(fit.at(at)[0] - value, 0.0)
        peaks.append((at, value + beyond, math.hypot(error, beyond)))
    return peaks, rise
