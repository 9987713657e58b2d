"""Runs between cuts, joined where there is no step: speeds, holds, jumps and ramps."""

import functools
import itertools

import numpy as np

from ..kit.sample_noise import sample_noise
from ..messages import load_point as sentences
from .runs import JUMP, Run, jump_between, jump_size, noise_variances, refine_breakpoints
from .splits import SHORTEST, RowSums, cut, drop_weak_cuts

#: least change of speed, over the larger one, that is a step.  Motors keep to a few per cent.
STEP = 0.05
#: least deflection of the displacement by a step, over its noise: machines wander by as much
DEFLECTION = 3.0
#: standard errors of a speed up to which it is that of a hold, and of the noise that it moves
HOLD_ERRORS, HOLD_SCATTER = 3.0, 1.5
#: a hold's speed backwards, or its error, over the speed beside it: machines give a little
BACK = 0.01
#: longest ramp between two speeds, over the shorter of the times at these, that is no segment
RAMP = 0.05
#: lowest speed but 0, over the largest there is: what rounding leaves of a hold
ROUNDED = 1e-9
#: scatter about the lines, over that from row to row, from which on it is no noise
WANDER = 10.0
#: most decimal places that a file has; distance from one, over its size, that is none
PLACES, ON_GRID = 9, 1e-3
#: rows in which noise is looked for by a second search, and by how much it must lessen the scatter
SHORT, SUCCESS = 16, 5.0


def find_runs(t, x):
    """`Run`s (list) of the load point from break to break, and notes on them (list of str).

    t, x : (n,) [s], increasing, and [m]; not checked here

    ParameterError where there are no constant speeds.  V < 0 is not refused here.
    """
    runs = _steps_and_jumps(RowSums(t, x))
    scatter, steps = _scatter_of(runs)
    # steps in quick succession may be taken for a load point that wanders
    if scatter > max(WANDER * steps, ROUNDED * np.ptp(x)):
        closer = _steps_and_jumps(RowSums(t, x, longest=SHORT))
        if SUCCESS * _scatter_of(closer)[0] < scatter:
            runs = closer
    runs, holds = _mark_holds(runs)
    runs, ramps = _without_ramps(runs)
    return runs, holds + ramps + _oddities(runs)


def _steps_and_jumps(rows):
    """Runs between steps; where a displacement jumps, lines of one run."""

    @functools.cache
    def run_of(i, j):
        return Run(rows, [(i, j)])

    def least_change(one, other):
        error = (1.0 / one.spread + 1.0 / other.spread) ** 0.5
        return max(STEP * max(abs(one.V), abs(other.V)), HOLD_ERRORS * error)

    @functools.cache
    def change(i, j, k):
        """Of the speed at row j, over the least that is a step; inf where x jumps at one speed."""
        one, other = run_of(i, j), run_of(j, k)
        dV = abs(one.V - other.V)
        T = [run.end - run.start for run in (one, other)]
        least = least_change(one, other)
        deflection = dV * T[0] * T[1] / sum(T) / (DEFLECTION * rows.noise[j] ** 0.5)
        size = min(dV / least if least else 0.0, deflection)
        jumps = size < 1.0 and jump_size(rows, j, 0.5 * (one.V + other.V)) != 0.0
        return np.inf if jumps else size

    @functools.cache
    def jumps_within(i, j, k, m):
        """Whether rows j to k are those beside a jump, one at most between the lines beside it."""
        if k - j >= 2 * SHORTEST:
            return False
        one, other = run_of(i, j), run_of(k, m)
        t, x, least = rows.t[j:k], rows.x[j:k], JUMP * rows.noise[j:k] ** 0.5
        off = np.minimum(abs(x - one.at(t, -1)), abs(x - other.at(t, 0))) > least
        return bool(off.sum() <= 1 and abs(one.V - other.V) < least_change(one, other))

    def changes(at):
        sizes = [change(*three) for three in zip(at, at[1:], at[2:], strict=False)]
        for n, four in enumerate(zip(at, at[1:], at[2:], at[3:], strict=False)):
            if jumps_within(*four):
                sizes[n] = 0.0
        return sizes

    at = drop_weak_cuts(rows, cut(rows), changes, 1.0)
    first, *runs = [run_of(*two) for two in itertools.pairwise(at)]
    joined = [first]
    for run, size in zip(runs, changes(at), strict=True):
        if size == np.inf:
            joined[-1] = joined[-1].joined(run)
        else:
            joined.append(run)
    return refine_breakpoints(joined)


def _mark_holds(runs):
    """Runs with V = 0 where it cannot be distinguished from 0 (holds), and notes."""
    scatter = float(np.concatenate([run.whitened() for run in runs]).std())
    largest = max(abs(run.V) for run in runs)
    marked: list[Run] = []
    notes = []
    for m, (run, own) in enumerate(zip(runs, noise_variances(runs), strict=True)):
        lasts = run.end - run.start
        error = (max(1.0, own) / run.spread) ** 0.5
        moves = scatter * float(run.of_rows(run.samples.noise).mean()) ** 0.5
        least = max(HOLD_ERRORS * error, HOLD_SCATTER * moves / lasts, ROUNDED * largest)
        hold = abs(run.V) <= least
        beside = max((abs(r.V) for r in runs[max(0, m - 1) : m + 2] if r is not run), default=0.0)
        if hold and least > BACK * beside > 0.0:
            notes.append(sentences("notes.short_hold", first=run.start, last=run.end, V=least))
        if not hold and -BACK * beside <= run.V < 0.0:
            hold = True
            notes.append(sentences("notes.runs_back", by=-run.V * lasts, first=run.start))
        if hold and marked and marked[-1].hold:
            marked[-1] = marked[-1].joined(run, hold=True)
        else:
            marked.append(Run(run.samples, run.rows, hold))
    return refine_breakpoints(marked), notes


def _without_ramps(runs):
    """Short runs whose speeds lead from one speed to another left out: a step, with a note."""
    notes, m = [], 1
    while m < len(runs) - 1:
        for last in range(len(runs) - 1, m, -1):
            span = runs[m - 1 : last + 1]
            changes = np.diff([run.V for run in span])
            ramp = span[-1].start - span[0].end
            around = min(run.end - run.start for run in (span[0], span[-1]))
            if ramp < RAMP * around and ((changes > 0.0).all() or (changes < 0.0).all()):
                notes.append(sentences("notes.ramp", ramp=ramp, first=span[0].t[span[0].last]))
                del runs[m:last]
                break
        m += 1
    return refine_breakpoints(runs), notes


def _scatter_of(runs):
    """Standard deviation of a displacement about its lines, and that from row to row [m].

    At the median of the noise, where it differs along the record.
    """
    left = np.concatenate([run.whitened() for run in runs])
    left *= np.median(runs[0].samples.noise) ** 0.5
    return float(left.std()), sample_noise(left)


def _digit(x):
    """The decimal place to which half of the values (n,) are rounded, as a size; 0 for none."""
    x = np.abs(x[1:][np.diff(x) != 0.0])  # of a load point at rest one value says all
    if not x.any():
        return 0.0
    largest = 10.0 ** np.floor(np.log10(x.max()))
    for place in range(1, PLACES):
        digit = largest / 10.0**place
        if np.median(np.abs(x / digit - np.round(x / digit))) < ON_GRID:
            return float(digit)
    return 0.0


def _oddities(runs):
    """Notes on jumps of the displacement at one speed, and on a load point that wanders."""
    notes, t, x = [], runs[0].samples.t, runs[0].samples.x
    for run in runs:
        for first, _ in run.rows[1:]:
            if gap := jump_size(run.samples, first, run.V):
                lost = f" (as in {gap / run.V:.2g} s at that speed)" if run.V else ""
                notes.append(sentences("notes.jump", gap=gap, t=t[first], lost=lost))
    for one, other in itertools.pairwise(runs):
        if gap := jump_between(one, other):
            notes.append(sentences("notes.jump_at_step", gap=gap, t=t[other.first]))
    scatter, steps = _scatter_of(runs)
    if scatter > max(WANDER * steps, ROUNDED * np.ptp(x), _digit(x)):
        notes.append(sentences("notes.wanders", scatter=scatter, steps=steps))
    return notes
