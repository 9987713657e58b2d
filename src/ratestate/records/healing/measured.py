"""Healing and relaxation of one hold, with errors that have the correlation of the noise in them.

Steady friction before the hold, friction at its end, the peak and steady friction after it are
functions of the coefficients of one linear regression, whose covariance has what the noise makes
them share.
"""

from typing import Any, NamedTuple

import numpy as np

from ..regression import generalized_least_squares
from .peak import maximum_of, peak_window
from .polynomial_windows import GROWTH, fewest_samples, largest_straight, window_of
from .slide_noise import FEWEST
from .sliding import steady_part

#: orders of friction in ln(time since the hold began): tested, and used
TESTED, USED = 1, 3
#: fewest samples of a hold
FEWEST_OF_HOLD = fewest_samples(USED)
#: standard errors by which a peak is above friction after it
RESOLVED = 3.0
#: a drift over the part that is taken as steady, over healing, from which on it is not
DRIFT = 0.5

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
NAMES = (
    "friction_before",
    "friction_min",
    "friction_peak",
    "friction_after",
    "delta_mu",
    "delta_mu_c",
)


class Measured(NamedTuple):
    """What a hold shows: name -> (value, standard error) of `NAMES`, as far as there is any."""

    status: int
    found: dict
    peak_time: float = np.nan  # [s]


def measure(record, hold, noise):
    """`Measured` of a `Hold` of a `HealingRecord` with this noise."""
    t, friction = record.t, record.friction
    if hold.before.size < FEWEST:
        return Measured(NO_SLIDE, {})
    if hold.during.size < FEWEST_OF_HOLD:
        return Measured(SHORT, {})
    level = steady_part(t, friction, hold.before, noise)
    if level is None:
        return Measured(UNSTEADY, {})
    regression = _Regression(record, hold, noise, level)
    regression.add_end_of_hold()
    if hold.after.size < FEWEST:
        return Measured(ENDS, regression.solved(None).found())
    status, window, at = _peak(record, hold, noise)
    if status:
        return Measured(status, regression.solved(None).found())
    late = regression.add_peak(window)
    found = regression.solved(at).found()
    if late is None:
        return Measured(ENDS, _without_peak(found))
    (peak, peak_error), (after, after_error) = found["friction_peak"], found["friction_after"]
    if peak - after < RESOLVED * np.hypot(peak_error, after_error):
        return Measured(NO_PEAK, _without_peak(found))
    drift, drift_error = regression.drift_over_level()
    if abs(drift) > max(DRIFT * abs(found["delta_mu"][0]), RESOLVED * drift_error):
        return Measured(UNSTEADY, {})
    return Measured(EVALUATED, found, at)


def _peak(record, hold, noise):
    """Status, `Window` and time of the peak after a hold."""
    window = peak_window(record.t, record.friction, hold.after, noise)
    if window is None:
        return UNRESOLVED, None, None
    rows = window.rows
    alone = generalized_least_squares(
        record.t[rows], record.friction[rows], window.basis(record.t[rows]), noise
    )
    at = maximum_of(window, alone.coefficients)
    if at is None:
        return (ENDS if rows[-1] == hold.after[-1] else NO_PEAK), None, None
    return EVALUATED, window, at


def _without_peak(found):
    """What is found up to the hold's end."""
    return {name: found[name] for name in ("friction_before", "friction_min", "delta_mu_c")}


class _Regression:
    """Friction about one hold as one linear regression: blocks of rows, each with its columns."""

    def __init__(self, record, hold, noise, level):
        self.record, self.hold, self.noise, self.level = record, hold, noise, level
        self.blocks = {"before": (level, self._drift(record.t[level]))}
        self.end: Any = None
        self.window: Any = None
        self.at: float | None = None

    def add_end_of_hold(self):
        """Add friction at the end of the hold, a polynomial in the logarithm of its duration."""
        record, rows = self.record, self.hold.during
        age = np.log(np.maximum(record.t - self.hold.start, 0.5 * record.spacing))
        sizes, size = [], float(FEWEST_OF_HOLD)
        while size < rows.size:
            sizes.append(int(size))
            size *= GROWTH
        windows = [rows[-size:] for size in [*sizes, rows.size]]
        best = largest_straight(record.t, age, record.friction, windows, TESTED, self.noise)
        self.end = window_of(age, windows[0] if best is None else best, USED)
        self.blocks["end"] = self.end.rows, self.end.basis(age[self.end.rows])

    def add_peak(self, window):
        """Add the window of the peak, and steady friction after it; that one's rows, or None."""
        record = self.record
        self.window = window
        self.blocks["peak"] = window.rows, window.basis(record.t[window.rows])
        late = steady_part(record.t, record.friction, self.hold.after, self.noise)
        late = self.hold.after[-FEWEST:] if late is None else late
        late = late[record.t[late] > window.high]
        if late.size < FEWEST:
            return None
        away = record.t[late] - record.t[late].mean()
        self.blocks["after"] = late, np.column_stack([np.ones(late.size), away])
        return late

    def solved(self, at):
        """Itself, solved; at : time of the peak [s], if it has one."""
        rows = np.concatenate([rows for rows, _ in self.blocks.values()])
        k = [columns.shape[1] for _, columns in self.blocks.values()]
        design, first, self.places = np.zeros((rows.size, sum(k))), 0, {}
        starts = np.cumsum([0, *k])
        for (name, (own, columns)), start in zip(self.blocks.items(), starts, strict=False):
            place = slice(start, start + columns.shape[1])
            design[first : first + own.size, place] = columns
            self.places[name] = place
            first += own.size
        t, friction = self.record.t[rows], self.record.friction[rows]
        self.fit = generalized_least_squares(t, friction, design, self.noise)
        if at is not None:
            self.at = maximum_of(self.window, self.fit.coefficients[self.places["peak"]]) or at
        return self

    def found(self):
        """name -> (value, standard error) of `NAMES`."""
        start = self.hold.start
        before = self._row("before", self._drift(start))
        end = self._row("end", self.end.basis(np.log(self.hold.end - start)))
        at_end = self._row("before", self._drift(self.hold.end))
        rows = {"friction_before": before, "friction_min": end, "delta_mu_c": at_end - end}
        shift = 0.0
        if self.at is not None:
            peak = self._row("peak", self.window.basis(self.at))
            rows |= {
                "friction_peak": peak,
                "delta_mu": peak - self._row("before", self._drift(self.at)),
            }
            slope, curvature = (self._row("peak", self.window.basis(self.at, k)) for k in (1, 2))
            variance = float(slope @ self.fit.covariance @ slope)
            shift = 0.5 * variance / float(curvature @ self.fit.coefficients)  # < 0
        if "after" in self.places:
            rows["friction_after"] = self._row("after", np.array([[1.0, 0.0]]))
        found = {}
        for name, row in rows.items():
            value = float(row @ self.fit.coefficients)
            value += shift if name in ("friction_peak", "delta_mu") else 0.0
            found[name] = value, float(np.sqrt(row @ self.fit.covariance @ row))
        return found

    def drift_over_level(self):
        """Change of friction over the part that is taken as steady, and its standard error."""
        ends = self._drift(self.record.t[self.level[[0, -1]]])
        row = self._row("before", ends[1:] - ends[:1])
        error = float(np.sqrt(row @ self.fit.covariance @ row))
        return float(row @ self.fit.coefficients), error

    def _row(self, name, values):
        """A function of one block's coefficients, (1, k), as a row of all coefficients."""
        row = np.zeros(self.fit.coefficients.size)
        row[self.places[name]] = values[0]
        return row

    def _drift(self, t):
        """Columns (n, 1 or 2) of friction before the hold and of its drift, at times t."""
        t = np.atleast_1d(t)
        columns = [np.ones(t.size)]
        if self.record.trend is not None:
            columns.append(self.record.along(t) - self.record.along(self.hold.start))
        return np.column_stack(columns)
