"""Where a record loads or unloads its spring: after holds and steps, and between stress drops."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import find_peaks

from ..sample_noise import sample_noise
from ..slide_noise import noise_of_slides
from ..stick_slip.significance import are_stick_slip
from .loading_curve import LoadingCurve, fit_loading_curve

#: part of the change of friction up to the extremum over which a curve is fitted; of the rise
#: between two stress drops, from and to which
UNTIL, STICK = 0.5, (0.2, 0.6)
#: fewest samples of a slope, and of a hold's relaxation; least change of friction over its noise
FEWEST, FEWEST_OF_HOLD, LEAST = 12, 4, 8.0
#: fewest cycles of stick-slip; least drop over the largest, and of the noise
CYCLES, DROP, NOISES = 3, 0.3, 10.0
#: noise of the later half of a slide over that from sample to sample: a transient
NOISIER = 2.5
#: part of a segment after which stick-slip still goes on
GOES_ON = 0.6
#: slip rate over that of the load point in stick phases
STUCK = 1e-4
KINDS = ("reload", "step_up", "step_down", "stick")


class Slope(NamedTuple):
    """A loading or unloading of the spring, and the curve fitted to it."""

    kind: str
    start: float  # [s], where x = 0
    rows: np.ndarray
    x: np.ndarray  # load-point displacement [m] of these rows
    curve: LoadingCurve


def slopes_of(t, friction, segments):
    """list of `Slope`s of a record (m,) with these `Segments`."""
    found = []
    for i, (start, end, V) in enumerate(zip(segments.t, segments.ends, segments.V, strict=True)):
        rows = np.arange(*np.searchsorted(t, (start, end)))[1:]
        if V == 0.0 or rows.size < FEWEST:
            continue
        drops = stress_drops(t[rows], friction[rows])
        if drops.size:
            found += _stick_phases(t, friction, rows, drops, V)
        elif i:
            found.append(_after_change(t, friction, rows, segments, i))
    return [one for one in found if one is not None]


def _after_change(t, friction, rows, segments, i):
    """The `Slope` after a hold or a step, or None."""
    start, V, before = float(segments.t[i]), segments.V[i], segments.V[i - 1]
    sign = -1.0 if before > V else 1.0
    value = sign * friction[rows]
    smooth = uniform_filter1d(value, 3)
    extreme = int(np.argmax(smooth))
    level = value[0] + UNTIL * (smooth[extreme] - value[0])
    last = _reaches(t[rows], value, smooth[: extreme + 1], level)
    noise = sample_noise(friction[rows])
    if last < FEWEST or smooth[extreme] - value[0] < LEAST * noise:
        return None
    noise_here = noise_of_slides(t, friction, [rows])
    if noise_here is not None and noise_here.level > NOISIER * noise:
        noise_here = None  # what follows is not steady: the residuals must do
    rows = rows[:last]
    x = V * (t[rows] - start)
    kind, r, creep = ("step_down" if before > V else "step_up"), before / V, 0.0
    if before == 0.0:
        kind, r, creep = "reload", 0.0, _creep(t, friction, segments, i) / V
        creep = max(creep, 1e-12)
    curve = fit_loading_curve(t[rows], x, friction[rows], r, creep, noise_here)
    return None if curve is None else Slope(kind, start, rows, x, curve)


def _reaches(t, value, smooth, level):
    """Index at which the line through values until they reach a level does so; 0 if none does.

    (The first noisy value above it would come too soon.)
    """
    above = np.flatnonzero(smooth > level)
    first = int(above[0]) if above.size else 0
    if first < FEWEST:
        return 0
    slope, at = np.polyfit(t[:first] - t[0], value[:first], 1)
    return int(np.searchsorted(t - t[0], (level - at) / slope)) if slope > 0.0 else 0


def _creep(t, friction, segments, i):
    """-dmu/dt [1/s] at the end of the hold before segment i."""
    rows = np.arange(*np.searchsorted(t, (segments.t[i - 1], segments.t[i])))
    late = rows[rows.size // 2 :]
    if late.size < FEWEST_OF_HOLD:
        return 0.0
    # (friction falls with the logarithm of time)
    log_t = np.log(t[late] - segments.t[i - 1] + 1e-9)
    return -float(np.polyfit(log_t, friction[late], 1)[0]) / (segments.t[i] - segments.t[i - 1])


def stress_drops(t, friction):
    """Indices of the maxima before the stress drops of stick-slip.

    None of what only rings down, or of noise that wanders.
    """
    noise = sample_noise(friction)
    largest = float(np.ptp(friction))
    if largest < NOISES * noise:
        return np.arange(0)
    drops = find_peaks(friction, prominence=max(DROP * largest, NOISES * noise))[0]
    if drops.size < CYCLES or drops[-1] <= GOES_ON * friction.size:
        return np.arange(0)
    between = pairwise([*drops, friction.size])
    lowest = np.array([first + int(np.argmin(friction[first:last])) for first, last in between])
    starts = np.append(t[0], t[lowest[:-1]])
    return drops if are_stick_slip(starts, t[drops], t[lowest]) else np.arange(0)


def _stick_phases(t, friction, rows, drops, V):
    """`Slope`s (list) between successive stress drops."""
    found = []
    for first, last in pairwise(drops):
        low = first + int(np.argmin(friction[rows[first:last]]))
        bottom, top = friction[rows[low]], friction[rows[last]]
        share = (friction[rows[low : last + 1]] - bottom) / (top - bottom)
        inside = np.flatnonzero(share > STICK[1])
        begin = int(np.flatnonzero(share < STICK[0])[-1])
        end = int(inside[inside > begin][0]) if (inside > begin).any() else 0
        chosen = rows[low + begin : low + end]
        if chosen.size < FEWEST:
            continue
        start = float(t[chosen[0]])
        x = V * (t[chosen] - start)
        curve = fit_loading_curve(t[chosen], x, friction[chosen], STUCK)
        if curve is not None:
            found.append(Slope("stick", start, chosen, x, curve))
    return found
