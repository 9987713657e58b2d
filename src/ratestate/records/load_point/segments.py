"""Segments of constant load-point speed in a record, with standard errors; overshoots."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...model.quantities import readable, readable_change
from ..messages import load_point as sentences
from .classification import (
    HOLD_ERRORS,
    MAX_TRANSIENT_SLIP,
    MIN_SPEED_RATIO,
    MIN_STEP,
    find_runs,
    leave_out_ramps,
    leave_out_transients,
)
from .runs import breakpoints, is_gap, noise_variances, rounding_variances
from .splits import RowSums, drop_weak_cuts, find_cuts

#: the least-squares position of a jump by k standard deviations has a variance of this number
#: divided by k^4, in samples squared (Yao, Annals of Statistics 15, 1987, for small k)
POSITION_FACTOR = 26.0
#: rounding error of a time, as a fraction of the largest time of a record
TIME_ROUNDING = 1e-14
#: longest overshoot, as a fraction of the shorter of the two segments before and after it
MAX_OVERSHOOT_TIME = 0.05
#: largest deviation from the speed after the step, as a fraction of the change of speed
MAX_OVERSHOOT_SPEED = 0.5


class Segments(NamedTuple):
    """The n segments of constant speed of a load point, with standard errors."""

    t: np.ndarray  # (n,) starts [s]; the first is at or before the start of the record
    V: np.ndarray  # (n,) speeds [m/s]; exactly 0 in a hold, never negative
    end: float  # end of the last segment [s]
    t_error: np.ndarray  # (n,) [s]; 0 for the first start, and for a given loading
    V_error: np.ndarray  # (n,) [m/s]; 0 in a hold
    notes: Sequence[str] = ()  # on segments that were found
    #: all segments, overshoots included, if these are without them
    all_segments: "Segments | None" = None

    @property
    def ends(self):
        """(n,) end of each segment [s]."""
        return np.append(self.t[1:], self.end)

    def at(self, t):
        """Return the index of the segment at times t; at its start, of the later segment."""
        return np.maximum(np.searchsorted(self.t, t, side="right") - 1, 0)

    def displacement(self, t):
        """Return the load-point displacement [m] at times t since the first segment began."""
        if self.all_segments:
            return self.all_segments.displacement(t)
        ends = np.append(self.t, self.end)
        x = np.concatenate([[0.0], np.cumsum(self.V * np.diff(ends))])
        return np.interp(t, ends, x)

    @property
    def steady(self):
        """Indices (list) of the segments that are not overshoots."""
        durations = self.ends - self.t
        return leave_out_transients(
            self.V.size, lambda before, after: _overshoots(self.V, durations, before, after)
        )

    def without_overshoots(self):
        """Return the steady segments; a step begins when its overshoot begins."""
        kept = self.steady
        starts = [0, *(k + 1 for k in kept[:-1])]
        return self._replace(
            t=self.t[starts],
            V=self.V[kept],
            t_error=self.t_error[starts],
            V_error=self.V_error[kept],
            all_segments=self,
        )

    def describe(self, t, displacement=None, stress_steps=()):
        """Describe steps and holds: "velocity step 3 -> 10 um/s at 11676.4 s (8710 um)".

        t, displacement : (m,) of the record; displacements are omitted if `displacement` is None
        stress_steps : `StressStep`s of the record
        """
        texts = self._of_load_point(t, displacement)
        for step in stress_steps:
            change = readable_change("sigma", step.before, step.after)
            position_text = _format_position(step.t, t, displacement)
            begin, end = _format_time(step.t), _format_time(step.end)
            event = f"step of normal stress {change} at {begin}"
            if step.end > step.t:
                event = f"ramp of normal stress {change} from {begin} to {end}"
            texts.append((step.t, event + position_text))
        return "; ".join(text for _, text in sorted(texts, key=lambda item: item[0]))

    def _of_load_point(self, t, displacement):
        """Return (time [s], description) of each step and hold of the load point."""
        steady = self.without_overshoots()
        starts, speeds, ends = steady.t, steady.V, steady.ends
        if speeds.size == 1:
            V = speeds[0]
            motion = "a hold" if V == 0.0 else f"steady at {readable('V_lp', V, 3)}"
            return [(starts[0], f"no step: {motion} throughout")]
        texts = []
        for i, (start, V) in enumerate(zip(starts, speeds, strict=True)):
            at, position_text = _format_time(start), _format_position(start, t, displacement)
            before = speeds[i - 1] if i else None
            if V == 0.0:
                begin = f"{at}{position_text if i else ''}"
                texts.append((start, f"hold of {readable('t', ends[i] - start, 4)} from {begin}"))
            elif before == 0.0:
                texts.append((start, f"slide at {readable('V_lp', V, 3)} from {at}"))
            elif before is not None:
                change = readable_change("V_lp", before, V)
                texts.append((start, f"velocity step {change} at {at}{position_text}"))
        return texts


def segments_from(t, columns):
    """Return the `Segments` of a record from its ``delta_lp`` or, without it, its ``V_load``."""
    if "delta_lp" in columns:
        return segments_from_displacement(t, columns["delta_lp"])
    return segments_from_velocity(t, columns["V_load"])


def find_segments(t, delta_lp):
    """Find the successive constant speeds of a load point from its displacement.

    Parameters
    ----------
    t : array, shape (n,)
        Times [s], increasing, n >= 4.
    delta_lp : array, shape (n,)
        Load-point displacement [m], with noise or without.

    Returns
    -------
    segment_t : ndarray, shape (segments,)
        Start of each segment [s]; the first is ``t[0]``.  Without a step there is one segment.  An
        overshoot of a step is a segment.
    segment_V : ndarray, shape (segments,)
        Speed [m/s]; exactly 0 in a hold.

    Raises
    ------
    ParameterError
        If the times do not increase, a value is not a finite number, there are fewer than 4 values,
        or the load point moves backwards or has no constant speeds.

    Notes
    -----
    The times and speeds of all steps are fitted together by least squares; a step may lie between
    two rows.  A step is a change of speed by 5 % or more that deflects the displacement by at least
    three times its noise.  The noise is estimated for each sampling rate, and locally if it is
    larger than usual at that rate.  The displacement may jump while the speed is constant, for
    example if a sensor slips or samples are lost.  Such a jump is not a step, and does not shift
    the steps beside it.

    Examples
    --------
    >>> t = np.arange(101.0)
    >>> segment_t, segment_V = find_segments(t, 1e-6 * np.maximum(t, 10 * t - 405))
    >>> segment_t.round(6).tolist(), segment_V.round(12).tolist()
    ([0.0, 45.0], [1e-06, 1e-05])
    """
    segments = segments_from_displacement(t, delta_lp)
    return segments.t, segments.V


def segments_from_displacement(t, x):
    """Return the `Segments` of a displacement; raise ParameterError as `find_segments`."""
    t, x = _check_arrays(t, x, "delta_lp")
    runs, notes = find_runs(t, x)
    for run in runs:
        if run.V < 0.0:
            first, last = f"{run.start:.7g} s", f"{run.end:.7g} s"
            window = f"(None, '{first}')" if run.first else f"('{last}', None)"
            option = f"',{first}'" if run.first else f"'{last},'"
            values = {"first": first, "last": last, "window": window, "option": option}
            raise sentences.refusal("segments.backwards", V=-run.V, **values)
    noise, (at, spans) = noise_variances(runs), breakpoints(runs)
    offsets = rounding_variances(runs)
    variance = [0.0]  # of the starts
    for i, (tau, span) in enumerate(zip(at, spans, strict=True)):
        before, after = runs[i : i + 2]
        of_lines = noise[i] * before.x_variance(tau, -1) + noise[i + 1] * after.x_variance(tau, 0)
        of_lines += offsets[i] + offsets[i + 1]
        # a step in a jump or a gap is uniformly distributed over the span
        variance.append(span**2 / 12.0 if span else of_lines / (before.V - after.V) ** 2)
        if span and is_gap(before, after):
            ends = {"first": tau - 0.5 * span, "last": tau + 0.5 * span}
            notes.append(sentences("notes.step_in_gap", **ends))
    # a row at a breakpoint, to rounding, belongs to the segment before it
    rounding = TIME_ROUNDING * np.abs(t[[0, -1]]).max()
    near = t[np.searchsorted(t, at - rounding)]
    at = np.where(np.abs(at - near) <= rounding, near + rounding, at)
    starts, V = np.append(t[0], at), np.array([run.V for run in runs])
    V_error = [0.0 if r.hold else (s / r.spread) ** 0.5 for r, s in zip(runs, noise, strict=True)]
    found = Segments(starts, V, float(t[-1]), np.sqrt(variance), np.array(V_error))
    for i in sorted({*range(V.size)} - {*found.steady}):
        duration = found.ends[i] - starts[i]
        notes.append(sentences("notes.overshoot", V=V[i], duration=duration, first=starts[i]))
    return found._replace(notes=notes)


def segments_from_velocity(t, V):
    """Return the `Segments` of recorded speeds [m/s].

    A step lies midway between two rows.  In a ramp, it lies where it keeps the displacement.
    ParameterError as for `find_segments`.
    """
    t, V = _check_arrays(t, V, "V_load")
    rows = RowSums(t, V, degree=0)

    def levels(at):
        weights = np.add.reduceat(1.0 / rows.noise, at[:-1])
        first = V[at[:-1]]
        scaled = (V - np.repeat(first, np.diff(at))) / rows.noise
        means = first + np.add.reduceat(scaled, at[:-1]) / weights
        errors = weights**-0.5
        least = np.maximum(HOLD_ERRORS * errors, MIN_SPEED_RATIO * np.abs(means).max())
        return np.where(np.abs(means) <= least, 0.0, means), errors

    def sizes(at):
        means, _ = levels(at)
        largest = np.maximum(np.abs(means[1:]), np.abs(means[:-1]))
        return np.abs(np.diff(means)) / np.maximum(largest, 1e-300)

    at = drop_weak_cuts(rows, find_cuts(rows), sizes, MIN_STEP)
    means, errors = levels(at)
    if means.min() < 0.0:
        i = int(np.argmin(means))
        raise sentences.refusal("segments.negative", V=means[i], first=t[at[i]])
    kept, notes = leave_out_ramps(means, t[at[:-1]], t[np.array(at[1:]) - 1])
    middles = np.concatenate([t[:1], 0.5 * (t[1:] + t[:-1]), t[-1:]])[at]
    x = np.append(0.0, np.cumsum(means * np.diff(middles)))
    # a change of speed extends from `first` to `last`; the step keeps the displacement after it
    first, last = np.array(kept[:-1], int) + 1, np.array(kept[1:], int)
    V, change = means[kept], np.diff(means[kept])
    delay = (V[1:] * (middles[last] - middles[first]) - (x[last] - x[first])) / change
    first_row, last_row = np.array(at)[first], np.array(at)[last]
    interval = np.maximum(t[first_row] - t[first_row - 1], t[last_row] - t[last_row - 1])
    noise = np.maximum(rows.noise[first_row], rows.noise[last_row]) / change**2
    relative = np.sqrt(1.0 / 12.0 + (last_row - first_row) * noise + POSITION_FACTOR * noise**2)
    return Segments(
        np.append(t[0], middles[first] + delay),
        V,
        float(t[-1]),
        np.append(0.0, interval * relative),
        np.where(V == 0.0, 0.0, errors[kept]),
        notes,
    )


def _check_arrays(t, x, symbol):
    try:
        t, x = np.asarray(t, float), np.asarray(x, float)
    except (TypeError, ValueError):
        raise sentences.refusal("segments.numbers", symbol=symbol) from None
    if t.ndim != 1 or t.shape != x.shape or t.size < 4:
        raise sentences.refusal("segments.shape", t=t.shape, x=x.shape, symbol=symbol)
    if not (np.isfinite(t).all() and np.isfinite(x).all()):
        raise sentences.refusal("segments.finite", symbol=symbol)
    if not (np.diff(t) > 0.0).all():
        raise sentences.refusal("segments.order", row=int(np.argmin(np.diff(t) > 0.0)) + 1)
    return t, x


def _format_time(t):
    return f"{t:.1f} s" if abs(t) >= 100.0 else f"{t:.4g} s"


def _format_position(at, t, displacement):
    if displacement is None:
        return ""
    x = np.interp(at, t, displacement)
    return f" ({x * 1e6:.0f} um)" if abs(x) < 0.1 else f" ({x * 1e3:.3f} mm)"


def _overshoots(V, durations, before, after):
    """Return whether all segments between two others are overshoots of the step between them."""
    inner, ends = slice(before + 1, after), [before, after]
    jumps = np.abs(V[inner] - V[after])
    slips = (V * durations)[ends]
    return bool(
        durations[inner].sum() <= MAX_OVERSHOOT_TIME * durations[ends].min()
        and jumps.max() <= MAX_OVERSHOOT_SPEED * abs(V[after] - V[before])
        and jumps @ durations[inner] <= MAX_TRANSIENT_SLIP * slips[slips > 0.0].min(initial=np.inf)
    )
