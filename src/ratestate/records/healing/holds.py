"""The record for `healing`: samples, holds, slides, slip of the fault, and the noise."""

import math
from typing import NamedTuple

import numpy as np
import scipy
import xarray

from ..kit.noise import Noise, RestrictedLikelihood, estimated_noise
from ..kit.sample_noise import rounding
from ..load_point.segments import Segments
from ..messages import healing as sentences
from ..raw_record import raw_record, segments_of
from .polynomials import basis

#: samples left out on either side of a change of speed, the error of its time
GUARD = 1
#: samples averaged for friction at a slide's end; largest relative difference of equal speeds
LAST, SPEEDS = 12, 0.05
#: fewest samples of a reloading that gives k
FEWEST_OF_RELOADING = 3
#: final fraction of a slide that may be steady; its fewest samples
STEADY, FEWEST = 0.5, 12
#: most samples of a slide, and most slides, from which noise is estimated
MAX_SAMPLES, MAX_SLIDES = 2000, 8
#: order of the polynomial in a slide; noise, as a multiple of the least, that means a transient
SMOOTH, NOISIER = 3, 2.0
#: least relative noise of a sample: values of an instrument have at most 24 bits
SINGLE = 2.0**-24
NO_ROWS = np.arange(0)


class Part(NamedTuple):
    """A segment of the load point's history: a hold, or a slide before or after one."""

    start: float  # [s], as recorded
    end: float
    V: float  # [m/s]
    rows: np.ndarray  # samples
    tail: np.ndarray = NO_ROWS  # samples from the peak on; all if the slide follows no hold
    follows_hold: bool = False


class Hold(NamedTuple):
    """A hold, and the slides before and after it; `NO_PART` if the record lacks one."""

    number: int  # index of its segment
    before: Part
    during: Part
    after: Part

    @property
    def duration(self):
        """Return how long the load point rests [s]."""
        return self.during.end - self.during.start

    @property
    def is_at_one_speed(self):
        """Return whether the speeds before and after the hold count as one."""
        return is_same_speed(self.before.V, self.after.V)


#: stands for a part before the first segment or after the last
NO_PART = Part(0.0, 0.0, np.nan, NO_ROWS)


class HealingRecord(NamedTuple):
    """Samples (m,) of a record, and the motion of the load point."""

    t: np.ndarray  # [s], as recorded
    friction: np.ndarray
    kind: str  # "tau": the spring's stress divided by sigma; "mu": of the interface
    trend: str | None  # variable with which friction drifts: "slip", "time" or None
    segments: Segments
    holds: list
    slides: dict  # index of a segment -> `Part`
    slip: np.ndarray  # slip of the fault [m]; of the load point if k is not resolved
    k: float  # stiffness divided by normal stress [1/m]; inf if it is not resolved
    level: np.ndarray  # friction minus a rough estimate of its drift
    data: xarray.Dataset  # the given data in SI

    @property
    def drift_coordinate(self):
        """Return the variable with which friction drifts (m,): time [s] or fault slip [m]."""
        return self.t if self.trend == "time" else self.slip

    def drift_coordinate_at(self, t, friction):
        """Return t [s] if the trend is in time, else fault slip [m], from friction at this time."""
        if self.trend == "time":
            return t
        return float(self.segments.displacement(t)) - friction / self.k


def healing_record(data, loading, trend):
    """Return the `HealingRecord` of a Dataset; raise ParameterError if it has no hold.

    loading : `Loading`, or None for the recorded motion
    """
    names = getattr(data, "variables", ())
    if "tau" in names and "friction" not in names and "sigma" not in names:
        raise sentences.refusal("record.no_sigma")
    raw = raw_record(data, None)
    segments = segments_of(raw, loading)
    holds = _holds(raw.time, segments)
    if not holds:
        raise sentences.refusal("record.no_hold")
    friction, displacement = raw.friction, segments.displacement(raw.time)
    _, k = max(_reloading(friction, displacement, hold) for hold in holds)
    slip = displacement - friction / k
    level = friction - (_drift(friction, slip, holds) * slip if trend else 0.0)
    slides = _slides(level, holds)
    return HealingRecord(
        raw.time, friction, raw.kind, trend, segments, holds, slides, slip, k, level, data
    )


def is_same_speed(V_1, V_2):
    return abs(V_1 - V_2) <= SPEEDS * max(V_1, V_2)


def _holds(time, segments):
    starts, ends, n = segments.t, segments.ends, segments.t.size
    # (the record's first and last samples are not next to a change of speed)
    first = np.searchsorted(time, starts) + np.where(np.arange(n) > 0, GUARD, 0)
    last = np.searchsorted(time, ends) - np.where(np.arange(n) < n - 1, GUARD, 0)
    rows = map(np.arange, first, np.maximum(first, last))
    columns = starts.tolist(), ends.tolist(), segments.V.tolist(), rows
    parts = [*map(Part, *columns), NO_PART]  # (index -1 gives `NO_PART`, too)
    rests = np.flatnonzero(segments.V == 0.0).tolist()
    return [Hold(i, parts[i - 1], parts[i], parts[i + 1]) for i in rests]


def _reloading(friction, displacement, hold):
    """Return relaxation in a hold, and the slope k [1/m] of reloading; (0, inf) if unresolved.

    The slope ends at half the relaxation, because the fault creeps least before.
    """
    if min(part.rows.size for part in hold[1:]) < FEWEST_OF_RELOADING:
        return 0.0, np.inf
    before, low = (friction[part.rows[-FEWEST_OF_RELOADING:]].mean() for part in hold[1:3])
    rising = friction[hold.after.rows] < 0.5 * (before + low)
    rows = hold.after.rows[: int(np.argmin(rising))]
    if rows.size < FEWEST_OF_RELOADING:
        return 0.0, np.inf
    slope = float(np.polyfit(displacement[rows] - displacement[rows[0]], friction[rows], 1)[0])
    return (float(before - low), slope) if slope > 0.0 else (0.0, np.inf)


def _drift(friction, slip, holds):
    """Return the median change of friction with slip [1/m] from one slide's end to the next."""
    slopes = []
    for hold in holds:
        before, after = hold.before.rows[-LAST:], hold.after.rows[-LAST:]
        if min(before.size, after.size) == LAST and hold.is_at_one_speed:
            slip_between = slip[after].mean() - slip[before].mean()
            slopes.append((friction[after].mean() - friction[before].mean()) / slip_between)
    return float(np.median(slopes)) if slopes else 0.0


def _slides(level, holds):
    """Return index of a segment -> `Part`, for all slides next to holds in order of time."""
    slides: dict[int, Part] = {}
    for number, before, _, after in holds:
        if before.rows.size:
            slides.setdefault(number - 1, before._replace(tail=before.rows))
        if after.rows.size:
            tail = after.rows[int(np.argmax(level[after.rows])) :]
            slides[number + 1] = after._replace(tail=tail, follows_hold=True)
    return slides


def noise_of_slides(record):
    """Estimate the `Noise` of friction from the later parts of slides.

    Slides that are noisier than the quietest one by a factor of `NOISIER` are not yet steady, and
    are left out.  The noise is at least the resolution of friction.  If no part has `FEWEST`
    samples: ParameterError.
    """
    friction, slides = record.friction, [slide.rows for slide in record.slides.values()]
    parts = [rows[rows.size - int(STEADY * rows.size) :][-MAX_SAMPLES:] for rows in slides]
    parts = [rows for rows in parts if rows.size >= FEWEST]
    if not parts:
        raise sentences.refusal("record.no_slide", fewest=FEWEST)
    chosen = np.unique(np.linspace(0, len(parts) - 1, MAX_SLIDES).round().astype(int))
    parts = [parts[i] for i in chosen]
    least = max(rounding(friction), SINGLE * np.abs(friction).max())
    levels = np.array([_noise(record.t, friction, [rows], least).level for rows in parts])
    limit = NOISIER * levels.min()
    return _noise(record.t, friction, [parts[i] for i in np.flatnonzero(levels <= limit)], least)


def _noise(t, friction, parts, least):
    """Return the `Noise` about a cubic polynomial of time in each part (rows) of slides.

    least : smallest standard deviation of a sample
    """
    rows = np.concatenate(parts)
    blocks = [basis(t[part], t[part[0]], t[part[-1]], SMOOTH) for part in parts]
    columns = scipy.linalg.block_diag(*blocks)
    residual = friction[rows] - columns @ np.linalg.lstsq(columns, friction[rows])[0]
    if np.std(residual) <= least:
        return Noise(least)
    noise, _ = estimated_noise(RestrictedLikelihood(t[rows], residual, columns))
    # parts determine only the ratio red^2/time of noise that is slower than they are long
    longest = max(float(t[part[-1]] - t[part[0]]) for part in parts)
    if noise.exponent is not None or noise.time <= longest:
        return noise
    return noise._replace(red=noise.red * math.sqrt(longest / noise.time), time=longest)
