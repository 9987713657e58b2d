"""The march: a slider's motion from start to end, with jumps of speed and normal stress."""

import math

from ..friction.expressions import LIMIT
from ..friction.functions import log
from . import lanes, step_events
from . import rows as R
from .control import Kernel, close_case, failure_status, fill_lane
from .model import FINISHED, NOT_FINITE, RUNAWAY, RUNNING, Numbers
from .rows import OUTPUT, call_lanes, call_point
from .units import MarchUnits, RigidUnits

#: points of a path in a Taylor step, which is too long to be drawn from its ends alone
POINTS_PER_STEP = 8


# Largest relative change of sigma between two segments that does not count as a jump.
SAME_STRESS = 1e-12
# Widest bracket, and largest number of bisections, in the search for a speed.
WIDEST_BRACKET, MAX_BISECTIONS = 4096.0, 200


def enter_segment(run, l):
    """Put the lane at the start of the segment that holds its time.

    Skips segments of zero length.  Returns whether normal stress or, if K = inf, x jumps.
    """
    s, cases, loads = run.s, run.cases, run.loads
    i = int(s[R.CASE + l])
    scale, V0, row = cases.scale[i], cases.V0[i], cases.loading[i]
    k, last = int(s[R.SEGMENT + l]), loads.t.shape[0] - 1
    while k < last and loads.t[k + 1] * scale <= s[R.T + l]:
        k += 1
    s[R.SEGMENT + l] = k
    # dx/dT is continuous at a kink of V_lp: only a jump restarts the step size and cycle count.
    speed_jumps = k == 0
    if k > 0:
        start = loads.V[row, k - 1]
        end = start + loads.rate[row, k - 1] * (loads.t[k] - loads.t[k - 1])
        speed_jumps = abs(loads.V[row, k] - end) > 1e-9 * max(start, loads.V[row, k])
    s[R.W_LP + l] = loads.V[row, k] / V0
    s[R.RAMP + l] = loads.rate[row, k] / (V0 * scale)
    t_break = s[R.T_END + l]
    if k < last:
        t_break = min(t_break, loads.t[k + 1] * scale)
    s[R.BREAKPOINT + l] = t_break
    stress_jumps, x_jumps = enter_stress(run, l, i, row, k), False
    if run.shape.rigid:
        x = s[R.X + l]
        call_point(run.units.refresh, s, l, run.work)
        x_jumps = speed_jumps or abs(s[R.X + l] - x) > 1e-9  # (inertia jumps at a kink too)
    if speed_jumps or stress_jumps:
        call_point(run.units.first_step, s, l, run.work)
        s[R.CROSS_T_LOW + l] = math.inf
        s[R.CYCLES + l] = 0.0
    return stress_jumps or x_jumps


def enter_stress(run, l, i, row, k):
    """Start segment k of normal stress in case i's lane; return whether sigma jumps.

    row : of the loading's history
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
    previous_ratio, ratio = work[OUTPUT], work[OUTPUT + 1]
    if abs(ratio - previous_ratio) <= SAME_STRESS * ratio:
        return False
    apply_stress_jump(run, l, log(ratio / previous_ratio))
    return True


def apply_stress_jump(run, l, rise):
    """Change the lane's state as a jump of ln sigma by `rise` does."""
    s, work = run.s, run.work
    work[0] = rise
    call_point(run.units.stress_jump, s, l, work)  # changes psi; returns v of the same speed
    v = work[OUTPUT]
    if s[R.ETA0 + l] == 0.0 and not run.shape.rigid:
        v = balanced_v(run, l, v)
        excess_stress(run, l, v)
        if work[OUTPUT + 1] > LIMIT:  # without mass or damping, nothing balances the spring
            s[R.STATUS + l] = RUNAWAY if work[OUTPUT + 2] > 0.0 else NOT_FINITE
    s[R.V + l] = v
    call_point(run.units.refresh, s, l, work)


def excess_stress(run, l, v):
    """Return x - S at another v."""
    run.work[0] = v
    call_point(run.units.excess_stress, run.s, l, run.work)
    return run.work[OUTPUT]


def balanced_v(run, l, v):
    """Solve x = S for v by bisection, starting from another v.

    If friction no longer rises with speed, no v solves it, and the result is far above LIMIT.
    """
    too_slow = excess_stress(run, l, v) > 0.0
    reach = 1.0 if too_slow else -1.0
    while abs(reach) < WIDEST_BRACKET and (excess_stress(run, l, v + reach) > 0.0) == too_slow:
        reach *= 2.0
    low, high = min(v, v + reach), max(v, v + reach)
    for _ in range(MAX_BISECTIONS):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if excess_stress(run, l, middle) > 0.0:
            low = middle
        else:
            high = middle
    return low


def load(run, l, i):
    """Put case i into lane l, at t = 0."""
    s, cases, times = run.s, run.cases, run.save_times
    fill_lane(run, l, i, cases.eta0[i], cases.rtol[i])
    s[R.EVERY_STEP + l] = 1.0 if run.path.shape[0] > 0 else 0.0
    s[R.T_END + l] = cases.t_end[i] * cases.scale[i]
    enter_segment(run, l)
    if run.path.shape[0] > 0:
        append_to_path(run, l)
    n, row = 0, cases.times[i]
    while n < times.shape[1] and times[row, n] <= 0.0:
        save_state(run, l, n)
        n += 1
    set_next_save(run, l, n)


def handle(run, l):
    """Handle the events of the lane's step, and save states at times inside it."""
    step_events.handle(run, l)
    if lanes.has_save_time(run.s, l):
        save_inside_step(run, l)


def commit(run, first, n, taylor):
    """Commit steps; if a path is wanted, append the accepted step of its only slider."""
    extends_path = run.path.shape[0] > 0 and run.s[R.OK + first] > 0.0
    if extends_path and taylor:
        append_inside_step(run, first)
    call_lanes(run.units.commit, run.s, first, n)
    if extends_path:
        append_to_path(run, first)


def finish(run, l):
    """Store the outcome of the lane's case, without states if the case failed."""
    s, shape, results, work = run.s, run.shape, run.results, run.work
    i, status = int(s[R.CASE + l]), int(s[R.STATUS + l])
    results.status[i] = status
    for k in range(2 + shape.states):
        if status == FINISHED:
            results.final[i, k] = s[R.y_row(shape, k) + l]
        else:
            for n in range(results.saved.shape[1]):
                results.saved[i, n, k] = math.nan
    amplitude, period, returns = step_events.last_period(run, l)
    call_point(run.units.v_extremes, s, l, work)
    numbers = Numbers(
        t=(s[R.T + l] + s[R.T_LOW + l]) / run.cases.scale[i],
        steps=s[R.STEPS + l],
        rejected=s[R.REJECTED + l],
        load_work=s[R.LOAD_WORK + l],
        dissipation=s[R.DISSIPATION + l],
        amplitude=amplitude,
        period=period,
        cycles=s[R.CYCLES + l],
        v_max=work[OUTPUT],
        v_min=work[OUTPUT + 1],
        g_max=s[R.G_HIGH + l],
        returns=float(returns),
        f_min=s[R.F_LOW + l],
        xf_min=s[R.XF_LOW + l],
    )
    close_case(run, l, numbers)


def end(run, l):
    """Enter the next segment, or finish the case: at its end, or because it failed.

    If the state jumps at a saved time, the state after the jump is saved.
    """
    s, cases, times = run.s, run.cases, run.save_times
    if s[R.STATUS + l] == RUNNING:
        if s[R.OK + l] == 0.0 or s[R.STEPS + l] + s[R.REJECTED + l] >= s[R.MAX_STEPS + l]:
            s[R.STATUS + l] = failure_status(s, l)
        elif s[R.BREAKPOINT + l] >= s[R.T_END + l]:
            s[R.STATUS + l] = FINISHED
        else:
            s[R.T + l], s[R.T_LOW + l] = s[R.BREAKPOINT + l], 0.0
            i, n = int(s[R.CASE + l]), int(s[R.SAVED + l])
            if enter_segment(run, l):
                if n > 0 and times[cases.times[i], n - 1] * cases.scale[i] == s[R.T + l]:
                    save_state(run, l, n - 1)
                if run.path.shape[0] > 0:
                    append_to_path(run, l)
    if s[R.STATUS + l] != RUNNING:
        finish(run, l)


# Saved times, and the path of a slider's own steps


def set_next_save(run, l, n):
    """Make saved time n the next one at which the lane saves its state."""
    s, cases, times = run.s, run.cases, run.save_times
    i = int(s[R.CASE + l])
    s[R.SAVED + l], s[R.SAVE_AT + l] = n, math.inf
    if n < times.shape[1]:
        s[R.SAVE_AT + l] = times[cases.times[i], n] * cases.scale[i]


def save_inside_step(run, l):
    """Store the state at each saved time inside the lane's accepted step."""
    s, cases, times, work = run.s, run.cases, run.save_times, run.work
    i = int(s[R.CASE + l])
    row, scale, h = cases.times[i], cases.scale[i], s[R.H_USED + l]
    n = int(s[R.SAVED + l])
    while n < times.shape[1]:
        fraction = ((times[row, n] * scale - s[R.T + l]) - s[R.T_LOW + l]) / h
        if fraction > 1.0:
            break
        fraction = max(fraction, 0.0)
        work[0] = fraction
        call_point(run.units.state, s, l, work)
        for k in range(2 + run.shape.states):
            run.results.saved[i, n, k] = work[OUTPUT + k]
        n += 1
    set_next_save(run, l, n)


def save_state(run, l, n):
    """Store the lane's state as the one at saved time n."""
    i = int(run.s[R.CASE + l])
    for k in range(2 + run.shape.states):
        run.results.saved[i, n, k] = run.s[R.y_row(run.shape, k) + l]


def append_to_path(run, l):
    """Append T, x, v and psi of the lane to the path."""
    s, path, row = run.s, run.path, run.position[2]
    path[row, 0] = s[R.T + l] + s[R.T_LOW + l]
    for k in range(2 + run.shape.states):
        path[row, 1 + k] = s[R.y_row(run.shape, k) + l]
    run.position[2] += 1


def append_inside_step(run, l):
    """Append points inside the lane's Taylor step to the path, before the commit."""
    s, path, work = run.s, run.path, run.work
    for j in range(1, POINTS_PER_STEP):
        fraction, row = j / POINTS_PER_STEP, run.position[2]
        path[row, 0] = s[R.T + l] + (s[R.T_LOW + l] + fraction * s[R.H_USED + l])
        work[0] = fraction
        call_point(run.units.state, s, l, work)
        for k in range(2 + run.shape.states):
            path[row, 1 + k] = work[OUTPUT + k]
        run.position[2] += 1


MARCH = Kernel(MarchUnits, load, handle, commit, end)
#: march of sliders that move with their load points (K = inf)
RIGID_MARCH = MARCH._replace(units=RigidUnits)
