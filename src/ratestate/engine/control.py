"""The control of lanes: what marches and return maps have in common.

Lanes are filled from a queue, step, and stop at events and breaks.  `run_lanes` can be left and
entered again: all it knows is in the lane buffer and the queue's position.  So the caller stays in
control of a long run: progress, interruption, output.

Lanes stand in sets.  A loop over lanes takes steps of one method.  A slider that changes its method
moves to the other's set, or waits in a third one until there is room.  With twice as many sliders
under way as a set has lanes, one of the two is always full: the fuller one goes next.

A set is a lane buffer (rows.py) of its own, behind the one before.  So a slider's place is known by
one number, its column: its lane, and where its set begins.
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

#: sets of a run that may take steps of the Taylor method: for Rodas5P, for these, to wait in
SETS = 3
#: most error of a step if K = inf: small steps cost little where only states evolve
TOLERANCE_OF_RIGID = 1e-12
#: the case of a lane that is free
IDLE = -1.0


class Kernel(NamedTuple):
    """A kind of run: its units, and what it does with the lane of a column l."""

    units: type
    load: Callable  # (run, l, i): put case i there
    handle: Callable  # (run, l): see to what its accepted step holds
    commit: Callable  # (run, first, n, taylor): commit steps of n lanes
    end: Callable  # (run, l): at a break; where its case is over, write it out, and be IDLE


class Run(NamedTuple):
    """All that a kernel works on; lanes stand in `SETS` sets if `taylor`, else in one."""

    kernel: Kernel
    shape: Any  # `rows.Shape`
    units: Any  # of the kernel's kind
    width: int  # lanes of a vector of the units
    taylor: int  # 1 if steps that are not stiff are of the Taylor method, which the law allows
    s: np.ndarray  # (sets * size,) the lanes
    queue: np.ndarray  # (n,) case numbers, in the order in which to start them
    position: np.ndarray  # (3,) next in queue; cases done; rows of `path` filled
    work: Any  # (WORK,) array; on a GPU each thread has its own
    cases: Any  # `model.Cases`, or of a return map `Starts`
    results: Any  # `model.Results`, or `ReturnResults`
    # of a march
    loads: Any = ()  # `model.Loads`
    save_times: np.ndarray = np.empty((1, 0))  # (rows, n_times) [s], increasing
    # (m, 1 + len(y)) T, x, v, psi after each step of the only slider, inside Taylor steps, and
    # after each jump; empty if not wanted
    path: np.ndarray = np.empty((0, 1))
    # of a return map
    waveform: int = 0  # 1 if its integrals are wanted
    # on a GPU
    under_way: np.ndarray = np.zeros(1)  # sum of the fractions done of unfinished cases


def run_lanes(run, budget):
    """Let lanes step until all cases are done (True) or the budget is spent (False).

    run : `Run`; budget : int, sweeps over the lanes
    """
    s, shape, units, kernel, position = run.s, run.shape, run.units, run.kernel, run.position
    capacity = 2 * R.LANES if run.taylor > 0 else R.LANES
    first, n = 0, 0
    vacant = regroup = True
    for _ in range(budget):
        if vacant:
            while position[0] - position[1] < capacity:
                i = next_case(run)
                if i < 0:
                    break
                kernel.load(run, room(s, shape, 0.0), i)
            vacant = False
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
                    vacant = regroup = True
        if run.taylor > 0 and change_sets(s, shape, first):
            regroup = True
    return False


def next_case(run):
    """Number of the next case of the queue, which so is taken; -1 if there is none."""
    n = add(run.position, 0, 1)
    return run.queue[n] if n < run.queue.shape[0] else -1


def fill(run, l, i, eta0, tolerance):
    """Put what all kernels' cases have in common of case i into lane l; all else there is 0."""
    s, shape, cases = run.s, run.shape, run.cases
    for row in range(R.HOME + R.LANES, shape.kept, R.LANES):
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
    if shape.rigid:  # (its speed is not known yet)
        s[R.KAPPA + l], s[R.TOLERANCE + l] = 0.0, min(tolerance, TOLERANCE_OF_RIGID)
    else:
        call_point(run.units.begin, s, l, run.work)


def leave(run, l, numbers):
    """Put the numbers of the lane's case, which is over, into its results; the lane is idle."""
    i = int(run.s[R.CASE + l])
    run.results.numbers[i] = numbers
    run.s[R.CASE + l] = IDLE
    add(run.position, 1, 1)


def stuck(s, l):
    """Status of a case given up: too many rejections in a row, or its steps are spent."""
    if s[R.FAILURES + l] > TOO_MANY_FAILURES:
        return NOT_FINITE if s[R.BAD + l] > 0.0 else STEP_UNDERFLOW
    return STEP_LIMIT


# Sets of lanes


def idle_lanes(shape, sets):
    """A lane buffer of free lanes."""
    s, columns = np.zeros((sets, shape.size)), np.arange(R.LANES)
    s[:, R.CASE : R.CASE + R.LANES] = IDLE
    s[:, R.HOME : R.HOME + R.LANES] = np.add.outer(shape.size * np.arange(sets), columns)
    return s.ravel()


def idle_column(s, first):
    """The first column of a set that holds no slider, or -1."""
    for l in range(first, first + R.LANES):
        if s[R.CASE + l] == IDLE:
            return l
    return -1


def busy_columns(s, first):
    """How many columns of a set hold a slider."""
    busy = 0
    for l in range(first, first + R.LANES):
        busy += s[R.CASE + l] != IDLE
    return busy


def room(s, shape, taylor):
    """A column for one more slider; taylor : 1.0 if its steps are of this method, else 0.0."""
    l = idle_column(s, shape.size if taylor > 0.0 else 0)
    return l if l >= 0 else idle_column(s, 2 * shape.size)


def next_set(run):
    """Where the set begins that goes next, and how many of its lanes go: 0 without sliders.

    Of the two of the methods, or without `taylor` of the only one, that of which more lanes are
    busy, as a part of those that go.  Its sliders are then in these.
    """
    s, shape = run.s, run.shape
    first, busy = 0, busy_columns(s, 0)
    n = whole_vectors(busy, run.width)
    if run.taylor > 0:
        others = busy_columns(s, shape.size)
        n_others = whole_vectors(others, run.width)
        more = others * n - busy * n_others
        if more > 0 or (more == 0 and others > busy):
            first, n = shape.size, n_others
    for l in range(first + n, first + R.LANES):
        if s[R.CASE + l] != IDLE:
            move(s, shape, l, idle_column(s, first))
    return first, n


def whole_vectors(busy, width):
    """How many lanes go if so many are busy: those of whole vectors."""
    return (busy + width - 1) // width * width


def move(s, shape, l, to):
    """Move the slider of column l to another, which is idle."""
    for row in range(R.HOME + R.LANES, shape.kept, R.LANES):
        s[row + to] = s[row + l]
    s[R.HOME + l], s[R.HOME + to] = s[R.HOME + to], s[R.HOME + l]
    s[R.CASE + l] = IDLE


def change_sets(s, shape, first):
    """Move those of a set that change their method, and call in sliders that wait for its lanes.

    Whether any has moved.
    """
    size, moves = shape.size, False
    taylor = 1.0 if first == size else 0.0
    for l in range(first, first + R.LANES):
        if s[R.CHANGES + l] > 0.0 and s[R.CASE + l] != IDLE:
            s[R.TAYLOR + l] = 1.0 - taylor
            move(s, shape, l, room(s, shape, 1.0 - taylor))
            moves = True
    for l in range(2 * size, 2 * size + R.LANES):
        if s[R.CASE + l] != IDLE and s[R.TAYLOR + l] == taylor:
            to = idle_column(s, first)
            if to < 0:
                break
            move(s, shape, l, to)
            moves = True
    return moves
