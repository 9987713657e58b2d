"""The history of the load point: speeds that are constant between breaks."""

import itertools
from typing import NamedTuple

import numpy as np

from ..errors import ParameterError
from ..quantities import readable
from .lines import Line, Run, breaks, fitted, joined, jump, noise_of, settled
from .splits import MOST, Rows, cut, without

#: least change of speed, over the larger one, that is a step.  Motors keep to a few per cent.
STEP = 0.05
#: least bend of the displacement that is a step, over its noise: machines wander by as much
BEND = 3.0
#: standard errors, and noise in the displacement, up to which a speed is that of a hold
STILL, CREPT = 3.0, 3.0
#: longest ramp between two speeds, over the shorter of the times at these, that is no segment
RAMP = 0.05
#: lowest speed but 0, over the largest there is: what rounding leaves of a hold
ROUNDED = 1e-9


class Segments(NamedTuple):
    """What was found: starts [s] and speeds [m/s] with their standard errors, and notes."""

    t: np.ndarray
    V: np.ndarray
    t_error: np.ndarray
    V_error: np.ndarray
    notes: list[str]


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
    """
    found = segments_of(t, delta_lp)
    return found.t, found.V


def segments_of(t, x):
    """`find_segments` with errors and notes: `Segments`."""
    t, x = checked(t, x)
    rows = Rows(t, x)
    runs = _steps_and_jumps(rows, _few(cut(rows), t), t, x)
    runs = _still(t, x, settled(t, x, runs), rows.noise)
    runs, notes = _without_ramps(t, x, runs)
    noise = noise_of(t, x, runs)
    _forward(t, runs)
    at = breaks(t, runs)
    V = np.array([run.V for run in runs])
    variance = [
        (s * one.variance(tau, -1) + z * other.variance(tau, 0)) / (one.V - other.V) ** 2
        for tau, one, other, s, z in zip(at, runs, runs[1:], noise, noise[1:], strict=False)
    ]
    V_error = [0.0 if r.hold else (s / r.spread) ** 0.5 for r, s in zip(runs, noise, strict=True)]
    notes += _jumps(t, x, runs)
    starts = np.append(t[0], at)
    return Segments(starts, V, np.append(0.0, np.sqrt(variance)), np.array(V_error), notes)


def levels_of(t, V):
    """`Segments` out of speeds that were recorded; a step lies midway between two rows."""
    t, V = checked(t, V, "V_load")
    rows = Rows(t, V, degree=0)
    cuts = _few(cut(rows), t)
    while True:
        at = rows.at[cuts]
        means = np.array([V[i:j].mean() for i, j in zip(at[:-1], at[1:], strict=True)])
        sizes = np.diff(at)
        errors = np.sqrt(rows.noise / sizes)
        means[np.abs(means) <= np.maximum(STILL * errors, ROUNDED * np.abs(means).max())] = 0.0
        small = _changes(means)
        if not small.size or small.min() >= STEP:
            break
        cuts = without(rows, cuts, int(np.argmin(small)) + 1)
    if means.min() < 0.0:
        i = int(np.argmin(means))
        raise ParameterError(
            f"V_load is {readable('V_lp', means[i], 3)} from {t[at[i]]:.6g} s on; a load point "
            f"moves at V >= 0: leave that span out, or turn the sign of the column"
        )
    before, after = t[at[1:-1] - 1], t[at[1:-1]]
    starts = np.append(t[0], 0.5 * (before + after))
    spread = np.append(0.0, (after - before) / 12**0.5)
    return Segments(starts, means, spread, np.where(means == 0.0, 0.0, errors), [])


def checked(t, x, symbol="delta_lp"):
    """Times and values as arrays of numbers, or ParameterError."""
    t, x = np.asarray(t, float), np.asarray(x, float)
    if t.ndim != 1 or t.shape != x.shape or t.size < 4:
        raise ParameterError(
            f"t and {symbol} have shapes {t.shape} and {x.shape}; expected two columns of equal "
            f"length, 4 rows at least"
        )
    if not (np.isfinite(t).all() and np.isfinite(x).all()):
        raise ParameterError(f"t or {symbol} has values that are not finite; leave their rows out")
    if not (np.diff(t) > 0.0).all():
        row = int(np.argmin(np.diff(t) > 0.0)) + 1
        raise ParameterError(f"t does not increase at index {row}; sort the rows by time")
    return t, x


def _few(cuts, t):
    """The cuts, if they are not as many as a history without constant speeds would make."""
    if len(cuts) > MOST:
        raise ParameterError(
            f"the load point has no constant speeds from {t[0]:.6g} s to {t[-1]:.6g} s: more than "
            f"{MOST} pieces would be needed; choose a shorter window, for example "
            f"time=('{t[0]:.6g} s', '{t[0] + (t[-1] - t[0]) / 10:.6g} s')"
        )
    return cuts


def _steps_and_jumps(rows, cuts, t, x):
    """Runs between cuts at which the speed changes by as much as a step.

    Other cuts go, but for those where the displacement jumps: its speed is the same beyond.
    """
    while True:
        at = rows.at[cuts].tolist()
        runs = [fitted(t, x, Run((Line(i, j),))) for i, j in itertools.pairwise(at)]
        weak = [_weakness(rows, one, other, t) for one, other in itertools.pairwise(runs)]
        jumps = [
            weakness < 1.0 and jump(t, x, other.first, 0.5 * (one.V + other.V)) != 0.0
            for weakness, (one, other) in zip(weak, itertools.pairwise(runs), strict=True)
        ]
        weak = np.where(jumps, 1.0, weak)
        if not weak.size or weak.min() >= 1.0:
            break
        cuts = without(rows, cuts, int(np.argmin(weak)) + 1)
    found = runs[:1]
    for run, same in zip(runs[1:], jumps, strict=True):
        if same:
            found[-1] = joined(found[-1], run)
        else:
            found.append(run)
    return found


def _weakness(rows, one, other, t):
    """How much the change of speed between two runs is, over the least that is a step."""
    turn = abs(one.V - other.V)
    T = [t[run.last - 1] - t[run.first] for run in (one, other)]
    error = (rows.noise / one.spread + rows.noise / other.spread) ** 0.5
    least = max(STEP * max(abs(one.V), abs(other.V)), STILL * error)
    bend = turn * T[0] * T[1] / sum(T) / (BEND * rows.noise**0.5)
    return min(turn / least if least else 0.0, bend)


def _changes(V):
    """Change from each speed to the next, over the larger."""
    larger = np.maximum(np.abs(V[1:]), np.abs(V[:-1]))
    return np.abs(np.diff(V)) / np.where(larger > 0.0, larger, 1.0)


def _still(t, x, runs, noise):
    """The same with holds: V = 0 where it cannot be told from 0; holds in a row are one."""
    largest = max(abs(run.V) for run in runs)
    found: list[Run] = []
    for run, own in zip(runs, noise_of(t, x, runs), strict=True):
        error = (max(noise, own) / run.spread) ** 0.5
        crept = CREPT * noise**0.5 / (t[run.last - 1] - t[run.first])
        hold = abs(run.V) <= max(STILL * error, crept, ROUNDED * largest)
        if hold and found and found[-1].hold:
            found[-1] = joined(found[-1], run, hold=True)
        else:
            found.append(run._replace(hold=bool(hold)))
    return settled(t, x, found)


def _forward(t, runs):
    """Refuse a load point that moves backwards."""
    for run in runs:
        if run.V < 0.0:
            raise ParameterError(
                f"delta_lp runs backwards, at {readable('V_lp', -run.V, 3)} from "
                f"{t[run.first]:.6g} s to {t[run.last - 1]:.6g} s; a load point moves at V >= 0: "
                f"leave that span out, for example time=(None, '{t[run.first]:.6g} s')"
            )


def _jumps(t, x, runs):
    """A note for each jump of the displacement at one speed."""
    notes = []
    for run in runs:
        for line in run.lines[1:]:
            if gap := jump(t, x, line.first, run.V):
                lost = f", as much as in {gap / run.V:.2g} s at that speed" if run.V else ""
                notes.append(
                    f"delta_lp jumps by {readable('delta_lp', gap, 3)} at {t[line.first]:.7g} s "
                    f"while the speed stays the same{lost}; speeds and steps are found beside it"
                )
    return notes


def _without_ramps(t, x, runs):
    """Short runs whose speeds lead from one speed to another left out: a step, with a note."""
    notes, m = [], 1
    while m < len(runs) - 1:
        for last in range(min(m + 4, len(runs) - 1), m, -1):
            span = runs[m - 1 : last + 1]
            V = np.diff([run.V for run in span])
            ramp = t[span[-1].first] - t[span[0].last - 1]
            around = min(t[r.last - 1] - t[r.first] for r in (span[0], span[-1]))
            if ramp < RAMP * around and ((V > 0.0).all() or (V < 0.0).all()):
                notes.append(
                    f"the load point's speed changes over some {ramp:.2g} s at "
                    f"{t[span[0].last]:.6g} s; taken as a step"
                )
                del runs[m:last]
                break
        m += 1
    return settled(t, x, runs), notes
