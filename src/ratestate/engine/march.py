"""The march: a slider's motion from start to end, by segments of its loading, with saved times."""

import math

from ..friction.expressions import LIMIT
from ..friction.functions import log
from . import events, lanes
from . import rows as R
from .control import Kernel, fill, leave, stuck
from .model import FINISHED, NOT_FINITE, RUNAWAY, RUNNING, Numbers
from .rows import FOUND, call_lanes, call_point
from .units import MarchUnits, RigidUnits

#: points of a path in a step of the Taylor method: its ends are too few to draw or to interpolate
POINTS = 8


# Parts of sigma by which a segment may begin beside the end of the one before, without a jump.
AGREE = 1e-12
# Widest bracket and most iterations in which a speed is sought.
WIDEST, MOST = 4096.0, 200


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
    # A kink leaves dx/dT continuous; only a jump restarts the step size and the cycle count.
    jump = k == 0
    if k > 0:
        start = loads.V[row, k - 1]
        end = start + loads.rate[row, k - 1] * (loads.t[k] - loads.t[k - 1])
        jump = abs(loads.V[row, k] - end) > 1e-9 * max(start, loads.V[row, k])
    s[R.W_LP + l] = loads.V[row, k] / V0
    s[R.RAMP + l] = loads.rate[row, k] / (V0 * scale)
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


def enter_stress(run, l, i, row, k):
    """Put the lane's normal stress, of case i, at the start of segment k; whether it jumps there.

    row : of the history of the loading
    """
    if run.shape.varies == 0:
        return False
    loads, work = run.loads, run.work
    sigma = run.cases.sigma[i]
    start, end = loads.sigma[row, k] / sigma, loads.sigma_end[row, k] / sigma
    rate = 0.0
    if end != start:
        rate = (end - start) / ((loads.t[k + 1] - loads.t[k]) * run.cases.scale[i])
    work[0], work[1] = start, rate
    call_point(run.units.enter_stress, run.s, l, work)
    before, now = work[FOUND], work[FOUND + 1]
    if abs(now - before) <= AGREE * now:
        return False
    jump(run, l, log(now / before))
    return True


def jump(run, l, rise):
    """Change the lane's state as a jump of ln sigma by `rise` changes it."""
    s, work = run.s, run.work
    work[0] = rise
    call_point(run.units.jump, s, l, work)  # psi, and v at the same speed
    v = work[FOUND]
    if s[R.ETA0 + l] == 0.0 and not run.shape.rigid:
        v = balanced(run, l, v)
        pull(run, l, v)
        if work[FOUND + 1] > LIMIT:  # of a slider without mass or damping that nothing holds
            s[R.STATUS + l] = RUNAWAY if work[FOUND + 2] > 0.0 else NOT_FINITE
    s[R.V + l] = v
    call_point(run.units.note, s, l, work)


def pull(run, l, v):
    """x - S at another v."""
    run.work[0] = v
    call_point(run.units.pull, run.s, l, run.work)
    return run.work[FOUND]


def balanced(run, l, v):
    """v at which the stress that opposes motion is the spring's, from another, by bisection.

    Where there is none, a speed beyond all: friction that no longer rises with speed.
    """
    pulls = pull(run, l, v) > 0.0
    reach = 1.0 if pulls else -1.0
    while abs(reach) < WIDEST and (pull(run, l, v + reach) > 0.0) == pulls:
        reach *= 2.0
    low, high = min(v, v + reach), max(v, v + reach)
    for _ in range(MOST):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if pull(run, l, middle) > 0.0:
            low = middle
        else:
            high = middle
    return low


def load(run, l, i):
    """Put case i into lane l at t = 0."""
    s, cases, times = run.s, run.cases, run.save_times
    fill(run, l, i, cases.eta0[i], cases.rtol[i])
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


def handle(run, l):
    """See to events in the lane's step, and save states at times in it."""
    events.handle(run, l)
    if lanes.saves(run.s, l):
        save(run, l)


def commit(run, first, n, taylor):
    """Commit steps; if a path is wanted, keep the accepted step of its only slider."""
    keeps = run.path.shape[0] > 0 and run.s[R.OK + first] > 0.0
    if keeps and taylor:
        keep_inside(run, first)
    call_lanes(run.units.commit, run.s, first, n)
    if keeps:
        keep(run, first)


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
    amplitude, period, returns = events.last_period(run, l)
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
    leave(run, l, numbers)


def end(run, l):
    """At a breakpoint: enter the next segment or finish.  Elsewhere: give up, saying why.

    A state saved at that time is the one after a jump.
    """
    s, cases, times = run.s, run.cases, run.save_times
    if s[R.STATUS + l] == RUNNING:
        if s[R.OK + l] == 0.0 or s[R.STEPS + l] + s[R.REJECTED + l] >= s[R.MAX_STEPS + l]:
            s[R.STATUS + l] = stuck(s, l)
        elif s[R.BREAKPOINT + l] >= s[R.T_END + l]:
            s[R.STATUS + l] = FINISHED
        else:
            s[R.T + l], s[R.T_LOW + l] = s[R.BREAKPOINT + l], 0.0
            i, n = int(s[R.CASE + l]), int(s[R.SAVED + l])
            if enter_segment(run, l):
                if n > 0 and times[cases.times[i], n - 1] * cases.scale[i] == s[R.T + l]:
                    save_state(run, l, n - 1)
                if run.path.shape[0] > 0:
                    keep(run, l)
    if s[R.STATUS + l] != RUNNING:
        finish(run, l)


# Saved times, and the path of a slider's own steps


def await_save(run, l, n):
    """Let saved time n be the next one the lane waits for."""
    s, cases, times = run.s, run.cases, run.save_times
    i = int(s[R.CASE + l])
    s[R.SAVED + l], s[R.SAVE_AT + l] = n, math.inf
    if n < times.shape[1]:
        s[R.SAVE_AT + l] = times[cases.times[i], n] * cases.scale[i]


def save(run, l):
    """Write the state at each saved time inside the lane's accepted step."""
    s, cases, times, work = run.s, run.cases, run.save_times, run.work
    i = int(s[R.CASE + l])
    row, scale, h = cases.times[i], cases.scale[i], s[R.H_USED + l]
    n = int(s[R.SAVED + l])
    while n < times.shape[1]:
        at = ((times[row, n] * scale - s[R.T + l]) - s[R.T_LOW + l]) / h
        if at > 1.0:
            break
        at = max(at, 0.0)
        work[0] = at
        events.state_at(run, l, at, work, 1)
        if run.shape.rigid:
            call_point(run.units.state, s, l, work)
            work[1], work[2] = work[FOUND], work[FOUND + 1]
        for k in range(2 + run.shape.states):
            run.results.saved[i, n, k] = work[1 + k]
        n += 1
    await_save(run, l, n)


def save_state(run, l, n):
    """Write the lane's state as that at saved time n."""
    i = int(run.s[R.CASE + l])
    for k in range(2 + run.shape.states):
        run.results.saved[i, n, k] = run.s[R.y_row(run.shape, k) + l]


def keep(run, l):
    """Put T, x, v and psi of the lane at the end of the path."""
    s, path, row = run.s, run.path, run.position[2]
    path[row, 0] = s[R.T + l] + s[R.T_LOW + l]
    for k in range(2 + run.shape.states):
        path[row, 1 + k] = s[R.y_row(run.shape, k) + l]
    run.position[2] += 1


def keep_inside(run, l):
    """`keep` the motion inside the lane's step of the Taylor method, before it is committed."""
    s, path = run.s, run.path
    for j in range(1, POINTS):
        at, row = j / POINTS, run.position[2]
        path[row, 0] = s[R.T + l] + (s[R.T_LOW + l] + at * s[R.H_USED + l])
        events.state_at(run, l, at, run.work, 0)
        for k in range(2 + run.shape.states):
            path[row, 1 + k] = run.work[k]
        run.position[2] += 1


MARCH = Kernel(MarchUnits, load, handle, commit, end)
#: of sliders that move with their load points (K = inf)
RIGID_MARCH = MARCH._replace(units=RigidUnits)
