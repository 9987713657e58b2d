"""The march: lanes are filled from a queue, step to breakpoints and events, and are written out.

`march` can be left and entered again: all it knows is in the lane buffer and the queue
position.  So the caller stays in control of a long run: progress, interruption, output.
"""

import math

import numpy as np

from . import lanes as L
from . import rows as R
from .events import handle_events
from .im2017 import take_step as take_im2017_step
from .jit import inner, kernel
from .lane_case import IDLE, choose_first_step, enter_inertia, fill, next_case, stuck
from .lane_sets import any_changes, change_sets, next_set, room
from .model import FINISHED, RUNNING, Numbers
from .normal_stress import enter_stress
from .periodicity import last_period
from .rows import rows_of
from .saving import POINTS, await_save, keep, keep_inside, save
from .taylor_lanes import advance
from .tuples import read_rows, write


@inner
def enter_segment(s, l, law, cases, loads):
    """Put the lane at the start of the segment that holds its time (zero-length ones pass).

    Returns whether its state jumps there, as normal stress does.
    """
    i = int(s[R.CASE + l])
    scale, V0, row = cases.scale[i], cases.V0[i], cases.loading[i]
    k, last = int(s[R.SEGMENT + l]), loads.t.size - 1
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
    s[R.LOG_W_LP + l] = math.log(w_lp) if w_lp > 0.0 else -math.inf
    t_break = s[R.T_END + l]
    if k < last:
        t_break = min(t_break, loads.t[k + 1] * scale)
    s[R.BREAKPOINT + l] = t_break
    history = rows_of(law).history
    stress_jumps = enter_stress(history, s, l, law, loads, row, k, cases.sigma[i], scale)
    if jump or stress_jumps:
        choose_first_step(s, l, law)
        s[R.CROSS_LOW + l] = math.inf
        s[R.CYCLES + l] = 0.0
    return stress_jumps


@inner
def load(s, l, law, i, cases, loads, save_times, results):
    """Put case i into lane l at t = 0."""
    fill(s, l, law, i, cases)
    enter_inertia(s, l, cases.eta0[i], cases.rtol[i])
    scale = cases.scale[i]
    s[R.T_END + l] = cases.t_end[i] * scale
    s[R.DT + l] = cases.dt[i] * scale
    enter_segment(s, l, law, cases, loads)
    n, row = 0, cases.times[i]
    while n < save_times.shape[1] and save_times[row, n] <= 0.0:
        write(results.saved[i, n], 0, read_rows(s, rows_of(law).y, l))
        n += 1
    await_save(s, l, n, save_times, row, scale)


@inner
def finish(s, l, law, cases, results):
    """Write the outcome of the lane's case; a failed one leaves no states."""
    i = int(s[R.CASE + l])
    status = int(s[R.STATUS + l])
    results.status[i] = status
    if status == FINISHED:
        write(results.final[i], 0, read_rows(s, rows_of(law).y, l))
    else:
        results.saved[i] = np.nan
    amplitude, period, returns = last_period(s, l, law)
    rows = rows_of(law)
    y, p = read_rows(s, rows.y, l), read_rows(s, rows.p, l)
    numbers = Numbers(
        t=(s[R.T + l] + s[R.T_LOW + l]) / cases.scale[i],
        steps=s[R.STEPS + l],
        rejected=s[R.REJECTED + l],
        load_work=s[R.LOAD_WORK + l],
        dissipation=s[R.DISSIPATION + l],
        amplitude=amplitude,
        period=period,
        cycles=s[R.CYCLES + l],
        v_max=law.v_of_order(s[R.V_HIGH + l], y[2:], p),
        v_min=law.v_of_order(s[R.V_LOW + l], y[2:], p),
        g_max=s[R.G_HIGH + l],
        returns=float(returns),
        f_min=s[R.F_LOW + l],
        xf_min=s[R.XF_LOW + l],
    )
    for k in range(len(numbers)):
        results.numbers[i, k] = numbers[k]
    s[R.CASE + l] = IDLE


@inner
def end_segment(s, l, law, cases, loads, save_times, saved):
    """At a breakpoint: enter the next segment or finish.  Elsewhere: give up, saying why.

    Returns whether the state jumps; a state saved at that time is then the one after the jump.
    """
    if s[R.STATUS + l] != RUNNING:
        return False
    if s[R.OK + l] == 0.0 or s[R.STEPS + l] + s[R.REJECTED + l] >= s[R.MAX_STEPS + l]:
        s[R.STATUS + l] = stuck(s, l)
        return False
    if s[R.BREAKPOINT + l] >= s[R.T_END + l]:
        s[R.STATUS + l] = FINISHED
        return False
    s[R.T + l], s[R.T_LOW + l] = s[R.BREAKPOINT + l], 0.0
    jumps = enter_segment(s, l, law, cases, loads)
    i, n = int(s[R.CASE + l]), int(s[R.SAVED + l])
    if jumps and n > 0 and save_times[cases.times[i], n - 1] * cases.scale[i] == s[R.T + l]:
        write(saved[i, n - 1], 0, read_rows(s, rows_of(law).y, l))
    return jumps


def _march(
    method, law, taylor, s, queue, position, cases, loads, save_times, results, path, budget
):
    """March cases until the queue is empty (True), `path` is full or the budget is spent (False).

    method : a code (model.py); by its type the compiler leaves out Rodas5P, or all else
    law : of `friction.laws.LAWS`, for which this is compiled
    taylor : bool, whether steps that are not stiff are of the Taylor method, which the law allows
    s : (sets * size,) the lanes, in `SETS` if `taylor` (lane_sets.py), else in one set;
        CASE = IDLE in those that are free
    queue : (n,) case numbers, in the order in which to start them
    position : (3,) int64: next in queue; cases done; rows of `path` filled
    path : (m, 1 + len(y)) T, x, v, psi after each step of the only slider, inside Taylor steps, and
        after each jump; empty if not wanted
    budget : int, sweeps over the lanes
    """
    rows = rows_of(law)
    capacity = 2 * R.LANES if taylor else R.LANES
    first, n, lanes = 0, 0, s[: rows.size]
    vacant = regroup = True
    for _ in range(budget):
        if vacant:
            while position[0] - position[1] < capacity:
                i = next_case(queue, position)
                if i < 0:
                    break
                l = room(s, law, 0.0)
                load(s, l, law, i, cases, loads, save_times, results)
                s[R.EVERY_STEP + l] = 1.0 if path.size > 0 else 0.0
            vacant = False
        if regroup:
            first, n = next_set(s, law, taylor)
            if n == 0:
                return True
            lanes, regroup = s[first : first + rows.size], False
        if method is None:
            advance(rows.c[0], lanes, law, n, first > 0)
        else:
            for l in range(R.WIDTH * n):
                if s[R.CASE + l] != IDLE:
                    take_im2017_step(s, l, law, method)
        for l in range(first, first + R.WIDTH * n):
            if s[R.CALL + l] > 0.0 and s[R.CASE + l] != IDLE:
                handle_events(s, l, law)
                if L.saves(s, l):
                    save(s, l, law, cases, save_times, results.saved)
        if path.size > 0 and first > 0:
            keep_inside(s, first, law, path, position)
        L.commit(lanes, law, n)
        if path.size > 0 and s[R.OK + first] > 0.0:
            keep(s, first, law, path, position)
        for l in range(first, first + R.WIDTH * n):
            if s[R.BREAK + l] > 0.0 and s[R.CASE + l] != IDLE:
                jumps = end_segment(s, l, law, cases, loads, save_times, results.saved)
                if jumps and path.size > 0:
                    keep(s, l, law, path, position)
                if s[R.STATUS + l] != RUNNING:
                    finish(s, l, law, cases, results)
                    position[1] += 1
                    vacant = regroup = True
        if taylor and (vacant or any_changes(lanes, n)):
            change_sets(s, law, first)
            regroup = True
        if path.size > 0 and position[2] + POINTS + 1 > path.shape[0]:
            return False  # (a step needs as many rows, and a jump one more)
    return False


#: the march by Rodas5P, its method None
march = kernel(_march, "march")
#: and by the paper's scheme, which few users need: it is compiled apart
march_im2017 = kernel(_march, "march_im2017")
