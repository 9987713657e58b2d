"""A record as `healing` looks at it: samples, holds, slides, slip of the fault, and the noise."""

import math
from typing import NamedTuple

import numpy as np
import xarray
from scipy.linalg import block_diag

from ..kit.estimated_noise import estimated_noise
from ..kit.noise import Noise
from ..kit.polynomial_windows import basis
from ..kit.sample_noise import rounding
from ..loading import Segments, segments_of
from ..messages import healing as sentences
from ..raw_record import raw_record

#: samples left out on either side of a change of speed, whose time is found no better
GUARD = 1
#: samples of which the mean is friction at a slide's end; speeds that differ by more are two speeds
LAST, SPEEDS = 12, 0.05
#: fewest samples of a reloading from which k is taken
FEWEST_OF_RELOADING = 3
#: part of a slide that may be steady: its end; fewest samples of it
STEADY, FEWEST = 0.5, 12
#: most samples of a slide, and most slides, from which noise is estimated
MOST, SLIDES = 2000, 8
#: order of friction in these; noise of one, as a multiple of the least, that counts as a transient
SMOOTH, NOISIER = 3, 2.0
#: least relative noise of a sample: numbers of an instrument have 24 bits at most
SINGLE = 2.0**-24
NO_ROWS = np.arange(0)


class Part(NamedTuple):
    """A segment of the load point's history: a hold, or a slide before or after one."""

    start: float  # [s], as recorded
    end: float
    V: float  # [m/s]
    rows: np.ndarray  # of samples
    tail: np.ndarray = NO_ROWS  # of a slide after a hold from the peak on; of another all
    follows_hold: bool = False


class Hold(NamedTuple):
    """A hold, with the slides before and after it, or `NOTHING` where the record has none."""

    number: int  # of its segment
    before: Part
    during: Part
    after: Part

    @property
    def duration(self):
        """How long the load point rests [s]."""
        return self.during.end - self.during.start

    @property
    def is_at_one_speed(self):
        """Whether the speeds before and after it count as one."""
        return is_same(self.before.V, self.after.V)


#: the part before the first segment, and after the last
NOTHING = Part(0.0, 0.0, np.nan, NO_ROWS)


class HealingRecord(NamedTuple):
    """Samples (m,), and what the load point does."""

    t: np.ndarray  # [s], as recorded
    friction: np.ndarray
    kind: str  # "tau": of the spring over sigma; "mu": of the interface
    trend: str | None  # along what friction drifts: "slip", "time" or None
    segments: Segments
    holds: list
    slides: dict  # number of a segment -> `Part`
    slip: np.ndarray  # of the fault [m]; of the load point if k is not resolved
    k: float  # stiffness over normal stress [1/m]; inf if it is not resolved
    level: np.ndarray  # friction without a rough estimate of its drift
    data: xarray.Dataset  # as given, in SI

    @property
    def along(self):
        """What friction drifts along (m,): time [s], or slip of the fault [m]."""
        return self.t if self.trend == "time" else self.slip

    def along_at(self, t, friction):
        """What friction drifts along, at a time [s] when it has this value."""
        if self.trend == "time":
            return t
        return float(self.segments.displacement(t)) - friction / self.k


def healing_record(data, loading, trend):
    """`HealingRecord` of a Dataset; ParameterError as of `raw_record`, and if there is no hold.

    loading : `Loading`, or None for the recorded one
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


def is_same(one, other):
    """Whether two speeds count as one."""
    return abs(one - other) <= SPEEDS * max(one, other)


def _holds(time, segments):
    starts, ends, n = segments.t, segments.ends, segments.t.size
    # (the record's own first and last samples are beside no change)
    first = np.searchsorted(time, starts) + np.where(np.arange(n) > 0, GUARD, 0)
    last = np.searchsorted(time, ends) - np.where(np.arange(n) < n - 1, GUARD, 0)
    rows = map(np.arange, first, np.maximum(first, last))
    columns = starts.tolist(), ends.tolist(), segments.V.tolist(), rows
    parts = [*map(Part, *columns), NOTHING]  # (number -1 is that of nothing, too)
    rests = np.flatnonzero(segments.V == 0.0).tolist()
    return [Hold(i, parts[i - 1], parts[i], parts[i + 1]) for i in rests]


def _reloading(friction, displacement, hold):
    """Relaxation in a hold, and the slope k [1/m] of friction until half of it is regained.

    The fault creeps least there, and after the hold with the largest relaxation.  inf and a
    relaxation of 0 if too few samples show the slope.
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
    """Change of friction with slip [1/m], the median over slides, each to the next one's end."""
    slopes = []
    for hold in holds:
        before, after = hold.before.rows[-LAST:], hold.after.rows[-LAST:]
        if min(before.size, after.size) == LAST and hold.is_at_one_speed:
            moved = slip[after].mean() - slip[before].mean()
            slopes.append((friction[after].mean() - friction[before].mean()) / moved)
    return float(np.median(slopes)) if slopes else 0.0


def _slides(level, holds):
    """Number of a segment -> `Part` before or after a hold, in order of time."""
    found: dict[int, Part] = {}
    for number, before, _, after in holds:
        if before.rows.size:
            found.setdefault(number - 1, before._replace(tail=before.rows))
        if after.rows.size:
            tail = after.rows[int(np.argmax(level[after.rows])) :]
            found[number + 1] = after._replace(tail=tail, follows_hold=True)
    return found


def noise_of_slides(record):
    """The `Noise` of friction in the later parts of slides, in which it may be steady.

    Slides that seem noisier than the quietest one, by `NOISIER`, are not yet steady and left out.
    The resolution of friction is noise, too.  ParameterError if no such part has `FEWEST` samples.
    """
    friction, slides = record.friction, [one.rows for one in record.slides.values()]
    parts = [rows[rows.size - int(STEADY * rows.size) :][-MOST:] for rows in slides]
    parts = [rows for rows in parts if rows.size >= FEWEST]
    if not parts:
        raise sentences.refusal("record.no_slide", fewest=FEWEST)
    chosen = np.unique(np.linspace(0, len(parts) - 1, SLIDES).round().astype(int))
    parts = [parts[i] for i in chosen]
    least = max(rounding(friction), SINGLE * np.abs(friction).max())
    levels = np.array([_noise(record.t, friction, [rows], least).level for rows in parts])
    most = NOISIER * levels.min()
    return _noise(record.t, friction, [parts[i] for i in np.flatnonzero(levels <= most)], least)


def _noise(t, friction, parts, least):
    """The `Noise` in parts of slides, in each of which friction is a cubic polynomial of time.

    least : smallest standard deviation of a sample
    """
    rows = np.concatenate(parts)
    blocks = [basis(t[part], t[part[0]], t[part[-1]], SMOOTH) for part in parts]
    columns = block_diag(*blocks)
    residual = friction[rows] - columns @ np.linalg.lstsq(columns, friction[rows])[0]
    if np.std(residual) <= least:
        return Noise(least)
    noise = estimated_noise(t[rows], residual, columns)
    # of what is slower than a part nothing is known but how fast it spreads, as red^2/time
    longest = max(float(t[part[-1]] - t[part[0]]) for part in parts)
    if noise.exponent is not None or noise.time <= longest:
        return noise
    return noise._replace(red=noise.red * math.sqrt(longest / noise.time), time=longest)
