"""The history of the load point: speeds that are constant between breaks, without overshoots."""

from typing import NamedTuple

import numpy as np

from ...model.quantities import power_of, prefixed_unit, readable, readable_change
from ..messages import load_point as sentences
from .runs import breakpoints, is_gap, noise_variances
from .splits import RowSums, cut, drop_weak_cuts
from .steps import HOLD_ERRORS, ROUNDED, STEP, find_runs

#: variance of the position of a jump by k standard deviations, from least squares: so many samples
#: squared, over k^4 (Yao, Annals of Statistics 15, 1987, for small k)
POSITION = 26.0
#: error of a time by rounding, over the last time of a record
ROUNDING = 1e-14
#: longest overshoot, over the shorter of the times at the speeds before and after it
BRIEF = 0.05
#: largest deviation from the speed after, over the change of speed
BEYOND = 0.5
#: largest deviation of the displacement, over that at either speed.  A laboratory slides 10 Dc or
#: more at each speed: friction does not notice so small a part of Dc.
EXCESS = 0.005


class FoundSegments(NamedTuple):
    """Starts and speeds of n segments as found in a record, with standard errors, and notes."""

    t: np.ndarray  # (n,) [s]; the first is that of the record
    V: np.ndarray  # (n,) [m/s]; exactly 0 in a hold, never negative
    t_error: np.ndarray  # (n,) [s]; 0 of the first
    V_error: np.ndarray  # (n,) [m/s]; 0 of a hold
    notes: list[str]  # from a velocity none

    def history(self, t, displacement=None, stress_steps=()):
        """Steps and holds, such as "velocity step 3.00 -> 10.0 um/s at 11676.4 s (8710 um)".

        t, displacement : (m,) of the record; without the latter none is mentioned
        stress_steps : `StressStep`s of the record
        """
        texts = self._of_load_point(t, displacement)
        for step in stress_steps:
            change = readable_change("sigma", step.before, step.after)
            moved = _moved(step.t, t, displacement)
            what = f"step of normal stress {change} at {_time(step.t)}"
            if step.end > step.t:
                what = f"ramp of normal stress {change} from {_time(step.t)} to {_time(step.end)}"
            texts.append((step.t, what + moved))
        return "; ".join(text for _, text in sorted(texts, key=lambda one: one[0]))

    def _of_load_point(self, t, displacement):
        """Pairs of a time [s] and what the load point does then."""
        starts, speeds, _ = without_overshoots(self.t, self.V, t[-1])
        if speeds.size == 1:
            V = speeds[0]
            what = "a hold" if V == 0.0 else f"steady at {_speed(V)}"
            return [(starts[0], f"no step: {what} throughout")]
        ends = np.append(starts[1:], t[-1])
        texts = []
        for i, (start, V) in enumerate(zip(starts, speeds, strict=True)):
            at, moved = _time(start), _moved(start, t, displacement)
            before = speeds[i - 1] if i else None
            if V == 0.0:
                since = f"{at}{moved if i else ''}"
                texts.append((start, f"hold of {readable('t', ends[i] - start, 4)} from {since}"))
            elif before == 0.0:
                texts.append((start, f"slide at {_speed(V)} from {at}"))
            elif before is not None:
                texts.append((start, f"velocity step {_speeds(before, V)} at {at}{moved}"))
        return texts


def stored_segments(data):
    """(n,) starts [s] and speeds [m/s] of the segments that a record already has; None if none.

    ParameterError for an altered record, whose segments are incomplete, empty or out of order.
    """
    names = ("segment_t", "segment_V")
    if not any(name in data.variables for name in names):
        return None
    found = [data[name].values for name in names if name in data.variables]
    usable = all(one.ndim == 1 and one.size and one.dtype.kind in "iuf" for one in found)
    usable = usable and len(found) == 2 and bool(np.isfinite(found).all())
    if not usable or (np.diff(found[0]) <= 0.0).any():
        raise sentences.refusal("segments.altered")
    return tuple(one.astype(float) for one in found)


def find_segments(t, delta_lp):
    """Constant speeds that a load point had one after the other, from its displacement.

    Parameters
    ----------
    t : array, shape (n,)
        Times [s], increasing, n >= 4.
    delta_lp : array, shape (n,)
        Load-point displacement [m], with noise or without.

    Returns
    -------
    segment_t : ndarray, shape (segments,)
        Start of each [s]; the first is ``t[0]``.
    segment_V : ndarray, shape (segments,)
        Speed [m/s]; exactly 0 in a hold.

    Raises
    ------
    ParameterError
        Times that do not increase; values that are not finite; fewer than 4; a load point that
        moves backwards, or one with no constant speeds.

    Notes
    -----
    Breaks are placed by least squares of all times and speeds together, between rows as well.  A
    step is a change of speed by 5 % or more that bends the displacement by three times its noise.
    The noise is estimated for each sampling rate, and where it is larger than usual at that rate.
    The displacement may jump at one speed (a sensor that slips, samples that were lost): that is
    no step, and does not move those beside it.

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
    """`FoundSegments` of a displacement; ParameterError as of `find_segments`."""
    t, x = _checked(t, x, "delta_lp")
    runs, notes = find_runs(t, x)
    for run in runs:
        if run.V < 0.0:
            first, last = f"{run.start:.7g} s", f"{run.end:.7g} s"
            window = f"(None, '{first}')" if run.first else f"('{last}', None)"
            option = f"',{first}'" if run.first else f"'{last},'"
            values = {"first": first, "last": last, "window": window, "option": option}
            raise sentences.refusal("segments.backwards", V=-run.V, **values)
    noise, (at, spans) = noise_variances(runs), breakpoints(runs)
    variance = [0.0]  # of the starts
    for i, (tau, span) in enumerate(zip(at, spans, strict=True)):
        one, other = runs[i : i + 2]
        of_lines = noise[i] * one.variance(tau, -1) + noise[i + 1] * other.variance(tau, 0)
        # in a jump or a gap the step may be anywhere
        variance.append(span**2 / 12.0 if span else of_lines / (one.V - other.V) ** 2)
        if span and is_gap(one, other):
            ends = {"first": tau - 0.5 * span, "last": tau + 0.5 * span}
            notes.append(sentences("notes.step_in_gap", **ends))
    # (a row at a break, to rounding, is before it: nothing has changed there)
    rounding = ROUNDING * np.abs(t[[0, -1]]).max()
    near = t[np.searchsorted(t, at - rounding)]
    at = np.where(np.abs(at - near) <= rounding, near + rounding, at)
    starts, V = np.append(t[0], at), np.array([run.V for run in runs])
    _, _, kept = without_overshoots(starts, V, t[-1])
    for i in sorted({*range(V.size)} - {*kept.tolist()}):
        lasts = np.append(starts, t[-1])[i + 1] - starts[i]
        notes.append(sentences("notes.overshoot", V=V[i], lasts=lasts, first=starts[i]))
    V_error = [0.0 if r.hold else (s / r.spread) ** 0.5 for r, s in zip(runs, noise, strict=True)]
    return FoundSegments(starts, V, np.sqrt(variance), np.array(V_error), notes)


def segments_from_velocity(t, V):
    """`FoundSegments` from recorded speeds [m/s]; steps lie midway between two rows.

    ParameterError as of `find_segments`, and for a mean speed below 0.
    """
    t, V = _checked(t, V, "V_load")
    rows = RowSums(t, V, degree=0)

    def levels(at):
        weights = np.add.reduceat(1.0 / rows.noise, at[:-1])
        first = V[at[:-1]]
        off = (V - np.repeat(first, np.diff(at))) / rows.noise
        means = first + np.add.reduceat(off, at[:-1]) / weights
        errors = weights**-0.5
        least = np.maximum(HOLD_ERRORS * errors, ROUNDED * np.abs(means).max())
        return np.where(np.abs(means) <= least, 0.0, means), errors

    def sizes(at):
        means, _ = levels(at)
        largest = np.maximum(np.abs(means[1:]), np.abs(means[:-1]))
        return np.abs(np.diff(means)) / np.maximum(largest, 1e-300)

    at = drop_weak_cuts(rows, cut(rows), sizes, STEP)
    means, errors = levels(at)
    if means.min() < 0.0:
        i = int(np.argmin(means))
        raise sentences.refusal("segments.negative", V=means[i], first=t[at[i]])
    edges = np.array(at[1:-1], int)
    before, after = t[edges - 1], t[edges]
    relative = np.sqrt(1.0 / 12.0 + POSITION * (rows.noise[edges] / np.diff(means) ** 2) ** 2)
    return FoundSegments(
        np.append(t[0], 0.5 * (before + after)),
        means,
        np.append(0.0, (after - before) * relative),
        np.where(means == 0.0, 0.0, errors),
        [],
    )


def _checked(t, x, symbol):
    t, x = np.asarray(t, float), np.asarray(x, float)
    if t.ndim != 1 or t.shape != x.shape or t.size < 4:
        raise sentences.refusal("segments.shape", t=t.shape, x=x.shape, symbol=symbol)
    if not (np.isfinite(t).all() and np.isfinite(x).all()):
        raise sentences.refusal("segments.finite", symbol=symbol)
    if not (np.diff(t) > 0.0).all():
        raise sentences.refusal("segments.order", row=int(np.argmin(np.diff(t) > 0.0)) + 1)
    return t, x


def _time(t):
    return f"{t:.1f} s" if abs(t) >= 100.0 else f"{t:.4g} s"


def _speed(V):
    return readable("V_lp", V, 3)


def _speeds(before, V):
    """Two speeds, in one unit if they are not too far apart."""
    if max(before, V) >= 100.0 * min(before, V):
        return f"{_speed(before)} -> {_speed(V)}"
    power = power_of("m/s", max(before, V))
    one, other = (f"{x / 10.0**power:#.3g}".rstrip(".") for x in (before, V))
    return f"{one} -> {other} {prefixed_unit('m/s', power)}"


def _moved(at, t, displacement):
    if displacement is None:
        return ""
    x = np.interp(at, t, displacement)
    return f" ({x * 1e6:.0f} um)" if abs(x) < 0.1 else f" ({x * 1e3:.3f} mm)"


def without_overshoots(t, V, end):
    """Return starts [s] and speeds [m/s] of the segments without overshoots, and their numbers.

    t, V : (n,) of all segments; end : of the last one [s]

    A step with an overshoot begins where the overshoot begins.
    """
    lasts = np.diff(np.append(t, end))
    starts, kept = [0], [0]
    while kept[-1] < V.size - 1:
        before = kept[-1]
        after = next(
            (k for k in range(V.size - 1, before + 1, -1) if _overshoots(V, lasts, before, k)),
            before + 1,
        )
        starts.append(before + 1)
        kept.append(after)
    return t[starts], V[kept], np.array(kept)


def _overshoots(V, lasts, before, after):
    """Whether all segments between two are overshoots of a step from the one to the other."""
    brief, ends = slice(before + 1, after), [before, after]
    off = np.abs(V[brief] - V[after])
    moved = (V * lasts)[ends]
    return bool(
        lasts[brief].sum() <= BRIEF * lasts[ends].min()
        and off.max() <= BEYOND * abs(V[after] - V[before])
        and off @ lasts[brief] <= EXCESS * moved[moved > 0.0].min(initial=np.inf)
    )
