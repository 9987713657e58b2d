"""Where a record loads or unloads its spring: after holds and steps, and between stress drops."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from ..kit.sample_noise import sample_noise
from .loading_curve import LoadingCurve, fit_loading_curve

#: part of the change of friction up to the extremum over which a curve is fitted; of the time
#: between two stress drops, from and to which
UNTIL, STICK = 0.6, (0.2, 0.6)
#: fewest samples of a slope, before it, and between stress drops; least change of friction over
#: its noise
FEWEST, FEWEST_BEFORE, FEWEST_STUCK, LEAST = 4, 4, 12, 8.0
#: part of the segment before from which friction's level is, with its noise, and most samples of it
BEFORE, MOST_BEFORE = 0.1, 500
#: part of a hold to which its relaxation is fitted, and most samples of it before the last ones
LATE, MOST_EARLY = 0.5, 1000
#: points of a curve through which its straight line is
STRAIGHT = 100
#: standard error of ln K by the state's change during loading: of the size of the deviations of
#: noiseless slopes under both laws, at k Dc from 1e-3 to 0.1; these go up to 5e-4 after holds, but
#: for what healing does, 6e-3 after steps up by a factor of 3 and 10, and 3e-2 after steps down by
#: a factor of 3
STATE_ERROR = {"reload": 5e-4, "step_up": 4e-3, "step_down": 2e-2}


class Slope(NamedTuple):
    """A loading or unloading of the spring, and the curve fitted to it."""

    kind: str
    start: float  # [s], where x = 0
    rows: np.ndarray  # with those before
    x: np.ndarray  # load-point displacement of these rows [m]
    curve: LoadingCurve

    @property
    def straight(self):
        """Slope of the best straight line through the curve [1/m]."""
        x = np.linspace(0.0, self.x[-1], STRAIGHT)
        return float(np.polyfit(x, self.curve.at(x), 1)[0])


def slopes_of(t, friction, segments, drops):
    """list of `Slope`s of a record (m,) with these `Segments`.

    drops : for each segment starts and ends [s] of the stress drops in it (m, 2)
    """
    found = []
    spans = zip(segments.t, segments.ends, segments.V, drops, strict=True)
    for i, (start, end, V, own) in enumerate(spans):
        rows = np.arange(*np.searchsorted(t, (start, end)))[1:]
        if V == 0.0 or rows.size < FEWEST:
            continue
        if len(own) > 1:
            phases = zip(own[:-1, 1], own[1:, 0], strict=True)
            found += [_stuck(t, friction, *phase, V) for phase in phases]
        elif i:
            found.append(_after_change(t, friction, rows, segments, i))
    return [one for one in found if one is not None]


def _after_change(t, friction, rows, segments, i):
    """The `Slope` after a hold or a step, or None."""
    start, V, last_V = float(segments.t[i]), segments.V[i], segments.V[i - 1]
    before = _rows_before(t, segments, i)
    if before is None:
        return None
    rested = V * (start - float(segments.t[i - 1])) if last_V == 0.0 else 0.0
    level = float(np.mean(friction[before]))
    if rested:
        level = float(
            np.polyfit(np.log1p(V * (t[before] - start) / rested), friction[before], 2)[-1]
        )
    sign = -1.0 if last_V > V else 1.0
    rise = sign * (friction[rows] - level)
    smooth = uniform_filter1d(rise, 3)
    extreme = int(np.argmax(smooth))
    noise = sample_noise(friction[rows])
    last = _reaches(t[rows] - start, rise, smooth[: extreme + 1], UNTIL * smooth[extreme])
    if last < FEWEST or smooth[extreme] < LEAST * noise:
        return None
    rows = np.concatenate([before, rows[:last]])
    moved = segments.displacement(t[rows]) - segments.displacement(start)
    x = np.where(t[rows] < start, V * (t[rows] - start), moved)
    kind = "reload" if rested else "step_down" if last_V > V else "step_up"
    errors = {"x_error": V * segments.t_error[i], "state_error": STATE_ERROR[kind]}
    curve = fit_loading_curve(t[rows], x, friction[rows], last_V / V, rested=rested, **errors)
    return None if curve is None else Slope(kind, start, rows, x, curve)


def _rows_before(t, segments, i):
    """Rows before segment i from which friction's level is; None where there are too few.

    After sliding the last part; in a hold its relaxation too, of which most rows are left out where
    they are many.
    """
    begin, start = segments.t[i - 1 : i + 1]
    late = np.arange(*np.searchsorted(t, (start - LATE * (start - begin), start)))
    rows = late[t[late] >= start - BEFORE * (start - begin)][-MOST_BEFORE:]
    if segments.V[i - 1] == 0.0:
        early = late[:-MOST_BEFORE]
        rows = np.append(early[:: early.size // MOST_EARLY + 1], late[-MOST_BEFORE:])
    if rows.size < FEWEST_BEFORE:
        rows = late[-FEWEST_BEFORE:]
    return rows if rows.size >= FEWEST_BEFORE else None


def _reaches(t, rise, smooth, level):
    """Index at which the line from t = 0 through a rise that reaches a level does so; 0 for none.

    (The first noisy value above it would come too soon.)
    """
    above = np.flatnonzero(smooth > level)
    first = int(above[0]) + 1 if above.size else 0
    slope = float(t[:first] @ rise[:first])
    return int(np.searchsorted(t, level * float(t[:first] @ t[:first]) / slope)) if slope > 0 else 0


def _stuck(t, friction, begin, end, V):
    """The `Slope` in a loading phase between stress drops, from begin to end [s], or None."""
    rows = np.arange(*np.searchsorted(t, [begin + part * (end - begin) for part in STICK]))
    if rows.size < FEWEST_STUCK:
        return None
    start = float(t[rows[0]])
    x = V * (t[rows] - start)
    curve = fit_loading_curve(t[rows], x, friction[rows], 0.0)
    return None if curve is None else Slope("stick", start, rows, x, curve)
