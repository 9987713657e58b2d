"""The march: lanes are filled from a queue, step to breakpoints and events, and are written out.

`march` can be left and entered again: all it knows is in the lane buffer and the queue
position.  So the caller stays in control of a long run: progress, interruption, output.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from ..friction.functions import log
from . import rows as R
from .calls import FOUND, call_lanes, call_point
from .events import handle_events
from .lane_case import IDLE, fill, next_case, stuck
from .lane_sets import any_changes, change_sets, next_set, room
from .lanes import saves
from .model import FINISHED, RUNNING, Cases, Loads, Numbers, Results
from .normal_stress import enter_stress
from .periodicity import last_period
from .saving import POINTS, await_save, keep, keep_inside, save, save_state


class Run(NamedTuple):
    """All that a march works on.

    The lanes stand in `SETS` sets (lane_sets.py) if `taylor`, else in one; CASE = IDLE in those
    that are free.
    """

    shape: R.Shape
    units: Any  # `units.MarchUnits`, or `units.RigidUnits` if K = inf
    taylor: int  # 1 if steps that are not stiff are of the Taylor method, which the law allows
    s: np.ndarray  # (sets * size,) the lanes
    queue: np.ndarray  # (n,) case numbers, in the order in which to start them
    position: np.ndarray  # (3,) next in queue; cases done; rows of `path` filled
    work: np.ndarray  # (WORK,)
    cases: Cases
    loads: Loads
    save_times: np.ndarray  # (rows, n_times) [s], increasing
    results: Results
    # (m, 1 + len(y)) T, x, v, psi after each step of the only slider, inside Taylor steps, and
    # after each jump; empty if not wanted
    path: np.ndarray


def enter_segment(run, l):
    """Put the lane at the start of the segment that holds its time (zero-length ones pass).

    Returns whether its state jumps there: normal stress does or, if K = inf, x.
    """
    s, cases, loads = run.s, run.cases, run.loads
    i = int(s[R.CASE + l])
    scale, V0, row = cases.scale[i], cases.V0[i], cases.loading[i]
    k, last = int(s[R.SEGMENT + l]), loads.t.shape[0] - 1
    while k < last and loads.t[k + 1] * scale <= s[R.T + l]:
        k += 1
    s[R.SEGMENT + l] = k
    w_lp = loads.V[row, k] / V0
    # A kink leaves dx/dT continuous; only a jump restarts the step size and the cycle count.
    jump = k == 0
    if k > 0:
        start = loads.V[row, k - 1]
        end = start + loads.rate[row, k - 1] * (loads.t[k] - loads.t[k - 1])
        jump = abs(loads.V[row, k] - end) > 1e-9 * max(start, loads.V[row, k])
    s[R.W_LP + l] = w_lp
    s[R.RAMP + l] = loads.rate[row, k] / (V0 * scale)
    s[R.LOG_W_LP + l] = log(w_lp) if w_lp > 0.0 else -math.inf
    t_break = s[R.T_END + l]
    if k < last:
        t_break = min(t_break, loads.t[k + 1] * scale)
    s[R.BREAKPOINT + l] = t_break
    stress_jumps, x_jumps = enter_stress(run, l, i, row, k), False
    if run.shape.rigid:
        x = s[R.X + l]
        call_point(run.units.note, s, l, run.work)
        x_jumps = jump or abs(s[R.X + l] - x) > 1e-9  # (as inertia does at a kink)
    if jump or stress_jumps:
        call_point(run.units.first_step, s, l, run.work)
        s[R.CROSS_LOW + l] = math.inf
        s[R.CYCLES + l] = 0.0
    return stress_jumps or x_jumps


def load(run, l, i):
    """Put case i into lane l at t = 0."""
    s, cases, times = run.s, run.cases, run.save_times
    fill(run, l, i, cases, cases.eta0[i], cases.rtol[i])
    s[R.EVERY_STEP + l] = 1.0 if run.path.shape[0] > 0 else 0.0
    s[R.T_END + l] = cases.t_end[i] * cases.scale[i]
    enter_segment(run, l)
    if run.path.shape[0] > 0:
        keep(run, l)
    n, row = 0, cases.times[i]
    while n < times.shape[1] and times[row, n] <= 0.0:
        save_state(run, l, n)
        n += 1
    await_save(run, l, n)


def finish(run, l):
    """Write the outcome of the lane's case; a failed one leaves no states."""
    s, shape, results, work = run.s, run.shape, run.results, run.work
    i, status = int(s[R.CASE + l]), int(s[R.STATUS + l])
    results.status[i] = status
    for k in range(2 + shape.states):
        if status == FINISHED:
            results.final[i, k] = s[R.y_row(shape, k) + l]
        else:
            for n in range(results.saved.shape[1]):
                results.saved[i, n, k] = math.nan
    amplitude, period, returns = last_period(run, l)
    call_point(run.units.orders, s, l, work)
    numbers = Numbers(
        t=(s[R.T + l] + s[R.T_LOW + l]) / run.cases.scale[i],
        steps=s[R.STEPS + l],
        rejected=s[R.REJECTED + l],
        load_work=s[R.LOAD_WORK + l],
        dissipation=s[R.DISSIPATION + l],
        amplitude=amplitude,
        period=period,
        cycles=s[R.CYCLES + l],
        v_max=work[FOUND],
        v_min=work[FOUND + 1],
        g_max=s[R.G_HIGH + l],
        returns=float(returns),
        f_min=s[R.F_LOW + l],
        xf_min=s[R.XF_LOW + l],
    )
    k = 0
    for number in numbers:
        results.numbers[i, k] = number
        k += 1
    s[R.CASE + l] = IDLE


def end_segment(run, l):
    """At a breakpoint: enter the next segment or finish.  Elsewhere: give up, saying why.

    Returns whether the state jumps; a state saved at that time is then the one after the jump.
    """
    s, cases, times = run.s, run.cases, run.save_times
    if s[R.STATUS + l] != RUNNING:
        return False
    if s[R.OK + l] == 0.0 or s[R.STEPS + l] + s[R.REJECTED + l] >= s[R.MAX_STEPS + l]:
        s[R.STATUS + l] = stuck(s, l)
        return False
    if s[R.BREAKPOINT + l] >= s[R.T_END + l]:
        s[R.STATUS + l] = FINISHED
        return False
    s[R.T + l], s[R.T_LOW + l] = s[R.BREAKPOINT + l], 0.0
    jumps = enter_segment(run, l)
    i, n = int(s[R.CASE + l]), int(s[R.SAVED + l])
    if jumps and n > 0 and times[cases.times[i], n - 1] * cases.scale[i] == s[R.T + l]:
        save_state(run, l, n - 1)
    return jumps


def march(run, budget):
    """March cases until the queue is empty (True), the path is full or the budget spent (False).

    budget : int, sweeps over the lanes
    """
    s, shape, units, position = run.s, run.shape, run.units, run.position
    capacity = 2 * R.LANES if run.taylor else R.LANES
    first, n = 0, 0
    vacant = regroup = True
    keeps = run.path.shape[0] > 0
    for _ in range(budget):
        if vacant:
            while position[0] - position[1] < capacity:
                i = next_case(run.queue, position)
                if i < 0:
                    break
                load(run, room(s, shape, 0.0), i)
            vacant = False
        if regroup:
            first, n = next_set(s, shape, run.taylor)
            if n == 0:
                return True
            regroup = False
        call_lanes(units.taylor if first > 0 else units.step, s, first, n)
        for l in range(first, first + R.WIDTH * n):
            if s[R.CALL + l] > 0.0 and s[R.CASE + l] != IDLE:
                handle_events(run, l)
                if saves(s, l):
                    save(run, l)
        if keeps and first > 0:
            keep_inside(run, first)
        call_lanes(units.commit, s, first, n)
        if keeps and s[R.OK + first] > 0.0:
            keep(run, first)
        for l in range(first, first + R.WIDTH * n):
            if s[R.BREAK + l] > 0.0 and s[R.CASE + l] != IDLE:
                jumps = end_segment(run, l)
                if jumps and keeps:
                    keep(run, l)
                if s[R.STATUS + l] != RUNNING:
                    finish(run, l)
                    position[1] += 1
                    vacant = regroup = True
        if run.taylor and (vacant or any_changes(s, first, n)):
            change_sets(s, shape, first)
            regroup = True
        if keeps and position[2] + POINTS + 1 > run.path.shape[0]:
            return False  # (a step needs as many rows, and a jump one more)
    return False
