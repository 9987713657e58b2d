"""The loop that takes cases from a queue and steps them; marches and return maps share it.

The control fills lanes from a queue, lets them step, and stops them at events and breaks.  All its
state is in the lane buffer and in the queue's position.  So `run_lanes` can be left and entered
again, and the caller can report progress, write output or interrupt a long run.

Lanes are grouped in sets.  One loop over lanes takes steps of one method.  A slider that changes
its method moves to the other method's set, or waits in a third set if that one is full.  Twice as
many sliders run as a set has lanes, so one of both sets is always full: the fuller one steps next.

Each set is a lane buffer (rows.py), and all sets are stored in one array, one after the other.  So
one number locates a slider: its column, which is the start of the set plus the lane.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..friction.functions import sqrt
from . import rows as R
from .lanes import TOO_MANY_FAILURES
from .model import NOT_FINITE, RUNNING, STEP_LIMIT, STEP_UNDERFLOW
from .rows import add, call_lanes, call_point

#: sets of a run with both methods: for Rodas5P, for the Taylor method, and for waiting
SETS = 3
#: largest tolerance of a step if K = inf: small steps cost little if only the states evolve
RIGID_TOLERANCE = 1e-12
#: CASE of a lane without a slider
IDLE = -1.0


class Kernel(NamedTuple):
    """A kind of run: its units, and the functions that handle the lane in a column l."""

    units: type
    load: Callable  # (run, l, i): put case i into the lane
    handle: Callable  # (run, l): handle the events of the accepted step
    commit: Callable  # (run, first, n, taylor): commit the steps of n lanes
    end: Callable  # (run, l): handle a break; if the case is over, store it and set CASE to IDLE


class KernelRun(NamedTuple):
    """The record of a kernel; there are `SETS` sets of lanes if `taylor`, else one."""

    kernel: Kernel
    shape: Any  # `rows.Shape`
    units: Any  # the law's units, of the kernel's kind
    width: int  # lanes of a vector of the units
    taylor: int  # 1 if steps that are not stiff use the Taylor method
    s: np.ndarray  # (sets * size,) the lanes
    queue: np.ndarray  # (n,) case numbers, in the order in which to start them
    position: np.ndarray  # (3,) next in queue; cases done; rows of `path` filled
    work: Any  # (WORK_SIZE,) array; on a GPU one per thread
    cases: Any  # `model.Cases`, or `Starts` of a return map
    results: Any  # `model.Results`, or `ReturnResults`
    # only for a march:
    loads: Any = ()  # `model.Loads`
    save_times: np.ndarray = np.empty((1, 0))  # (rows, n_times) [s], increasing
    # (m, 1 + len(y)) T, x, v, psi of the only slider, after each step and jump and at points
    # inside Taylor steps; empty if no path is wanted
    path: np.ndarray = np.empty((0, 1))
    # only for a return map:
    waveform: int = 0  # 1 if integrals of the waveform are wanted
    # only on a GPU:
    partly_done: np.ndarray = np.zeros(1)  # sum of the completed fractions of unfinished cases


def run_lanes(run, budget):
    """Step the lanes until all cases are done (True) or the budget is spent (False).

    run : `KernelRun`; budget : int, sweeps over the lanes
    """
    s, shape, units, kernel, position = run.s, run.shape, run.units, run.kernel, run.position
    capacity = 2 * R.LANES if run.taylor > 0 else R.LANES
    first, n = 0, 0
    has_vacancy = regroup = True
    for _ in range(budget):
        if has_vacancy:
            while position[0] - position[1] < capacity:
                i = next_case(run)
                if i < 0:
                    break
                kernel.load(run, free_column(s, shape, 0.0), i)
            has_vacancy = False
        if regroup:
            first, n = next_set(run)
            if n == 0:
                return True
            regroup = False
        call_lanes(units.taylor if first > 0 else units.step, s, first, n)
        for l in range(first, first + n):
            if s[R.CALL + l] > 0.0 and s[R.CASE + l] != IDLE:
                kernel.handle(run, l)
        kernel.commit(run, first, n, first > 0)
        for l in range(first, first + n):
            if s[R.BREAK + l] > 0.0 and s[R.CASE + l] != IDLE:
                kernel.end(run, l)
                if s[R.CASE + l] == IDLE:
                    has_vacancy = regroup = True
        if run.taylor > 0:
            regroup = leave_set(s, shape, first, n) or regroup
            if regroup:
                enter_set(s, shape, first)
    return False


def next_case(run):
    """Take the next case from the queue; return its number, or -1 if it is empty."""
    n = add(run.position, 0, 1)
    return run.queue[n] if n < run.queue.shape[0] else -1


def fill_lane(run, l, i, eta0, tolerance):
    """Load the part of case i that all kernels share into lane l; clear other rows."""
    s, shape, cases = run.s, run.shape, run.cases
    for row in range(R.RING_COLUMN + R.LANES, shape.z_new, R.LANES):
        s[row + l] = 0.0
    s[R.CASE + l], s[R.STATUS + l] = i, RUNNING
    s[R.KAPPA + l] = cases.kappa[i]
    for k in range(shape.coefficients):
        s[shape.p + k * R.LANES + l] = cases.p[i, k]
    for k in range(2 + shape.states):
        s[R.y_row(shape, k) + l] = cases.y[i, k]
    s[R.OBSERVE + l], s[R.V_LIMIT + l] = cases.observe[i], cases.v_limit[i]
    s[R.MAX_STEPS + l] = cases.max_steps[i]
    s[R.V_HIGH + l], s[R.V_LOW + l] = -math.inf, math.inf
    s[R.F_LOW + l] = s[R.XF_LOW + l] = math.inf
    s[R.ETA0 + l], s[R.TOLERANCE + l] = eta0, tolerance
    s[R.FREQUENCY + l] = sqrt(s[R.KAPPA + l] / eta0) if eta0 > 0.0 else math.inf
    if shape.rigid:  # (the speed is not known until the kernel enters a segment)
        s[R.KAPPA + l], s[R.TOLERANCE + l] = 0.0, min(tolerance, RIGID_TOLERANCE)
    else:
        call_point(run.units.begin, s, l, run.work)


def close_case(run, l, numbers):
    """Store the numbers of the lane's finished case, and free the lane."""
    i = int(run.s[R.CASE + l])
    run.results.numbers[i] = numbers
    run.s[R.CASE + l] = IDLE
    add(run.position, 1, 1)


def failure_status(s, l):
    """Return why a case failed: too many rejections in a row, or too many steps."""
    if s[R.FAILURES + l] > TOO_MANY_FAILURES:
        return NOT_FINITE if s[R.BAD + l] > 0.0 else STEP_UNDERFLOW
    return STEP_LIMIT


# Sets of lanes


def idle_lanes(shape, sets):
    """Return a lane buffer in which all lanes are free."""
    s, first = np.zeros((sets, shape.size)), shape.size * np.arange(sets)
    s[:, R.CASE : R.CASE + R.LANES] = IDLE
    s[:, R.RING_COLUMN : R.RING_COLUMN + R.LANES] = np.add.outer(first, np.arange(R.LANES))
    return s.ravel()


def idle_column(s, first):
    """Return the first column of a set that holds no slider, or -1."""
    for l in range(first, first + R.LANES):
        if s[R.CASE + l] == IDLE:
            return l
    return -1


def count_busy(s, first):
    """Return how many columns of a set hold a slider."""
    count = 0
    for l in range(first, first + R.LANES):
        count += s[R.CASE + l] != IDLE
    return count


def free_column(s, shape, taylor):
    """Return a free column for a slider; taylor : 1.0 for Taylor steps, else 0.0."""
    l = idle_column(s, shape.size if taylor > 0.0 else 0)
    return l if l >= 0 else idle_column(s, 2 * shape.size)


def next_set(run):
    """Choose the set that steps next; return its first column and number of lanes.

    The number of lanes is 0 if no slider is left.  Of the sets for the two methods, the one with
    the larger share of busy lanes goes.  Its sliders are moved into the lanes that step.
    """
    s, shape = run.s, run.shape
    first, busy = 0, count_busy(s, 0)
    n = whole_vectors(busy, run.width)
    if run.taylor > 0:
        others = count_busy(s, shape.size)
        n_others = whole_vectors(others, run.width)
        gain = others * n - busy * n_others
        if gain > 0 or (gain == 0 and others > busy):
            first, n = shape.size, n_others
    for l in range(first + n, first + R.LANES):
        if s[R.CASE + l] != IDLE:
            move(s, shape, l, idle_column(s, first))
    return first, n


def whole_vectors(busy, width):
    """Round a number of busy lanes up to whole vectors."""
    return (busy + width - 1) // width * width


def move(s, shape, l, new):
    """Move the slider of column l to an idle column."""
    for row in range(R.RING_COLUMN + R.LANES, shape.z_new, R.LANES):
        s[row + new] = s[row + l]
    s[R.RING_COLUMN + l], s[R.RING_COLUMN + new] = s[R.RING_COLUMN + new], s[R.RING_COLUMN + l]
    s[R.CASE + l] = IDLE


def leave_set(s, shape, first, n):
    """Move sliders that change their method out of a set of n lanes; return whether any has."""
    has_moved = False
    to_taylor = 0.0 if first > 0 else 1.0
    for l in range(first, first + n):
        if s[R.CHANGES + l] > 0.0 and s[R.CASE + l] != IDLE:
            s[R.TAYLOR + l] = to_taylor
            move(s, shape, l, free_column(s, shape, to_taylor))
            has_moved = True
    return has_moved


def enter_set(s, shape, first):
    """Move sliders that wait for a set into it, as far as it has room."""
    taylor = 1.0 if first > 0 else 0.0
    for l in range(2 * shape.size, 2 * shape.size + R.LANES):
        if s[R.CASE + l] != IDLE and s[R.TAYLOR + l] == taylor:
            column = idle_column(s, first)
            if column < 0:
                break
            move(s, shape, l, column)
