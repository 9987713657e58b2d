"""Classify the runs of a record: steps, holds, jumps and ramps of the load point."""

import functools
import itertools

import numpy as np

from ..kit.sample_noise import sample_noise
from ..messages import load_point as sentences
from .runs import (
    JUMP_SIGMAS,
    SpeedRun,
    jump_between,
    jump_size,
    noise_variances,
    refine_breakpoints,
)
from .splits import MIN_RUN_ROWS, RowSums, drop_weak_cuts, find_cuts

#: least change of speed in a step, as a fraction of the larger speed.  Motors hold a speed to a few
#: per cent.
MIN_STEP = 0.05
#: least deflection of the displacement by a step, as a multiple of its noise: machines wander by
#: smaller amounts
MIN_DEFLECTION = 3.0
#: a run is a hold if its speed is below so many standard errors, or if the load point moves by less
#: than this multiple of the scatter
HOLD_ERRORS, HOLD_SCATTER = 3.0, 1.5
#: largest backward speed, or error of the speed, in a hold, as a fraction of the speed beside it:
#: machines relax a little
MAX_BACKWARD = 0.01
#: longest ramp that counts as a step, as a fraction of the shorter run beside it, in general and
#: if the ramp displaces the load point by less than `MAX_TRANSIENT_SLIP`
MAX_RAMP, MAX_RAMP_OF_SMALL_SLIP = 0.05, 0.2
#: largest deviation of the displacement by a transient that counts as a part of a step, as a
#: fraction of the displacement at either speed.  If an experiment slides 10 Dc at each speed, this
#: is 5 % of Dc.
MAX_TRANSIENT_SLIP = 0.005
#: lowest nonzero speed, as a fraction of the largest; below it, rounding in a hold
MIN_SPEED_RATIO = 1e-9
#: least scatter about the lines of a wandering load point, as a multiple of the scatter from row to
#: row
WANDER_RATIO = 10.0
#: most decimal places of a file; largest distance from a rounded value, in units of its last place;
#: least part of the values that are rounded
MAX_PLACES, GRID_TOLERANCE, ROUNDED_PART = 9, 1e-3, 0.9
#: rows of the runs that give the noise in a second search; least ratio of the first scatter to the
#: second
SHORT_ROWS, MIN_IMPROVEMENT = 16, 5.0


def find_runs(t, x):
    """Return the `SpeedRun`s (list) of the load point at constant speeds, and notes (list of str).

    t, x : (n,) [s], increasing, and [m]; not checked here

    ParameterError if there are no constant speeds.  Runs with V < 0 are returned.
    """
    digit = _rounding_step(x)
    runs = _steps_and_jumps(RowSums(t, x, digit=digit))
    scatter, steps = _scatter_of(runs)
    # the noise may be too large because steps in quick succession looked like wandering
    if scatter > max(WANDER_RATIO * steps, MIN_SPEED_RATIO * np.ptp(x)):
        short_runs = _steps_and_jumps(RowSums(t, x, longest=SHORT_ROWS, digit=digit))
        if MIN_IMPROVEMENT * _scatter_of(short_runs)[0] < scatter:
            runs = short_runs
    runs, holds = _mark_holds(runs)
    runs, ramps = _remove_ramps(runs)
    return runs, holds + ramps + _anomaly_notes(runs)


def _steps_and_jumps(rows):
    """Return the runs (list) between steps; a jump at one speed separates lines of one run."""

    @functools.cache
    def run_of(i, j):
        return SpeedRun(rows, [(i, j)])

    def least_change(before, after):
        error = (1.0 / before.spread + 1.0 / after.spread) ** 0.5
        return max(MIN_STEP * max(abs(before.V), abs(after.V)), HOLD_ERRORS * error)

    @functools.cache
    def change(i, j, k):
        """Return the change at row j as a multiple of the least step; inf for a jump of x."""
        before, after = run_of(i, j), run_of(j, k)
        dV = abs(before.V - after.V)
        T = [run.end - run.start for run in (before, after)]
        least = least_change(before, after)
        deflection = dV * T[0] * T[1] / sum(T) / (MIN_DEFLECTION * rows.noise[j] ** 0.5)
        size = min(dV / least if least else 0.0, deflection)
        jumps = size < 1.0 and jump_size(rows, j, 0.5 * (before.V + after.V)) != 0.0
        return np.inf if jumps else size

    @functools.cache
    def jumps_within(i, j, k, m):
        """Return whether rows j to k only surround a jump: at most one is off both lines."""
        if k - j >= 2 * MIN_RUN_ROWS:
            return False
        before, after = run_of(i, j), run_of(k, m)
        t, x, least = rows.t[j:k], rows.x[j:k], JUMP_SIGMAS * rows.noise[j:k] ** 0.5
        is_off = np.minimum(abs(x - before.x_at(t, -1)), abs(x - after.x_at(t, 0))) > least
        return bool(is_off.sum() <= 1 and abs(before.V - after.V) < least_change(before, after))

    def changes(at):
        sizes = [change(*three) for three in zip(at, at[1:], at[2:], strict=False)]
        for n, four in enumerate(zip(at, at[1:], at[2:], at[3:], strict=False)):
            if jumps_within(*four):
                sizes[n] = 0.0
        return sizes

    at = drop_weak_cuts(rows, find_cuts(rows), changes, 1.0)
    first, *runs = [run_of(*ends) for ends in itertools.pairwise(at)]
    joined = [first]
    for run, size in zip(runs, changes(at), strict=True):
        if size == np.inf:
            joined[-1] = joined[-1].join(run)
        else:
            joined.append(run)
    return refine_breakpoints(joined)


def _mark_holds(runs):
    """Set V = 0 in runs whose speed cannot be distinguished from 0; return runs and notes."""
    scatter = float(np.concatenate([run.whitened_residuals() for run in runs]).std())
    largest = max(abs(run.V) for run in runs)
    marked: list[SpeedRun] = []
    notes = []
    for m, (run, noise) in enumerate(zip(runs, noise_variances(runs), strict=True)):
        duration = run.end - run.start
        error = (max(1.0, noise) / run.spread) ** 0.5
        moves = scatter * float(run.select_rows(run.samples.noise).mean()) ** 0.5
        least = max(HOLD_ERRORS * error, HOLD_SCATTER * moves / duration, MIN_SPEED_RATIO * largest)
        hold = abs(run.V) <= least
        fastest = max((abs(r.V) for r in runs[max(0, m - 1) : m + 2] if r is not run), default=0.0)
        if hold and least > MAX_BACKWARD * fastest > 0.0:
            notes.append(sentences("notes.short_hold", first=run.start, last=run.end, V=least))
        if not hold and -MAX_BACKWARD * fastest <= run.V < 0.0:
            hold = True
            notes.append(sentences("notes.runs_back", by=-run.V * duration, first=run.start))
        if hold and marked and marked[-1].hold:
            marked[-1] = marked[-1].join(run, hold=True)
        else:
            marked.append(SpeedRun(run.samples, run.rows, hold))
    return refine_breakpoints(marked), notes


def _remove_ramps(runs):
    kept, notes = leave_out_ramps(*np.transpose([(run.V, run.start, run.end) for run in runs]))
    return refine_breakpoints([runs[k] for k in kept]), notes


def leave_out_ramps(V, start, end):
    """Return the indices (list) of the runs that are not part of a ramp, and notes.

    V, start, end : (n,) speed [m/s], and times [s] of the first and the last row of each run

    A ramp is a sequence of short runs of monotonic speeds between two longer ones.
    """

    def is_ramp(before, after):
        span, ends = V[before : after + 1], [before, after]
        changes, ramp = np.diff(span), start[after] - end[before]
        shorter = (end - start)[ends].min()
        if not (changes * changes[0] > 0.0).all() or ramp >= MAX_RAMP_OF_SMALL_SLIP * shorter:
            return False
        slips = abs(V * (end - start))[ends]
        nearer = np.minimum(abs(span - span[0]), abs(span - span[-1]))[1:-1]
        deviation = nearer @ np.diff(start[before + 1 : after + 1])
        allowed = MAX_TRANSIENT_SLIP * slips[slips > 0.0].min(initial=np.inf)
        return bool(ramp < MAX_RAMP * shorter or deviation <= allowed)

    kept = leave_out_transients(len(V), is_ramp)
    ramps = [(i, j) for i, j in itertools.pairwise(kept) if j > i + 1]
    return kept, [sentences("notes.ramp", ramp=start[j] - end[i], first=end[i]) for i, j in ramps]


def leave_out_transients(runs, is_transient):
    """Return the indices (list) of the runs that are not transients; the longest count first.

    runs : number of runs
    is_transient : function of two indices that returns whether all runs between them are transients
    """
    kept = [0]
    while kept[-1] < runs - 1:
        others = range(runs - 1, kept[-1] + 1, -1)
        after = (k for k in others if is_transient(kept[-1], k))
        kept.append(next(after, kept[-1] + 1))
    return kept


def _scatter_of(runs):
    """Return the standard deviations [m] about the lines and from row to row.

    If the noise varies along the record, they are scaled to its median.
    """
    residuals = np.concatenate([run.whitened_residuals() for run in runs])
    residuals *= np.median(runs[0].samples.noise) ** 0.5
    return float(residuals.std()), sample_noise(residuals)


def _rounding_step(x):
    """Return the step between digits of nearly all values (n,); 0 if none.

    It is 1, 2 or 5 times a power of 10.
    """
    steps = np.abs(np.diff(x))
    x, steps = np.abs(x[1:][steps > 0.0]), steps[steps > 0.0]  # a load point at rest counts once
    if not x.any():
        return 0.0
    largest = 10.0 ** np.floor(np.log10(x.max()))
    for place, multiple in itertools.product(range(1, MAX_PLACES), (5.0, 2.0, 1.0)):
        digit = multiple * largest / 10.0**place
        is_rounded = np.abs(x / digit - np.round(x / digit)) < GRID_TOLERANCE
        if is_rounded.mean() > ROUNDED_PART and np.median(steps) > 0.5 * digit:
            return float(digit)
    return 0.0


def _anomaly_notes(runs):
    notes, samples = [], runs[0].samples
    t, x = samples.t, samples.x
    for run in runs:
        for first, _ in run.rows[1:]:
            if gap := jump_size(run.samples, first, run.V):
                lost = f" (as in {gap / run.V:.2g} s at that speed)" if run.V else ""
                notes.append(sentences("notes.jump", gap=gap, t=t[first], lost=lost))
    for before, after in itertools.pairwise(runs):
        if gap := jump_between(before, after):
            notes.append(sentences("notes.jump_at_step", gap=gap, t=t[after.first]))
    scatter, steps = _scatter_of(runs)
    if scatter > max(WANDER_RATIO * steps, MIN_SPEED_RATIO * np.ptp(x), samples.digit):
        notes.append(sentences("notes.wanders", scatter=scatter, steps=steps))
    return notes
