"""Normal stress in a lane: its segments, and what happens where it jumps."""

from ..friction.expressions import LIMIT
from ..friction.functions import log
from . import rows as R
from .model import NOT_FINITE, RUNAWAY
from .rows import FOUND, call_point

# Parts of sigma by which a segment may begin beside the end of the one before, without a jump.
AGREE = 1e-12
# Widest bracket and most iterations in which a speed is sought.
WIDEST, MOST = 4096.0, 200


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
        work[0] = v
        call_point(run.units.pull, s, l, work)
        if work[FOUND + 1] > LIMIT:  # of a slider without mass or damping that nothing holds
            s[R.STATUS + l] = RUNAWAY if work[FOUND + 2] > 0.0 else NOT_FINITE
    s[R.V + l] = v
    call_point(run.units.note, s, l, work)


def force(run, l, v):
    """x - S at another v."""
    run.work[0] = v
    call_point(run.units.pull, run.s, l, run.work)
    return run.work[FOUND]


def balanced(run, l, v):
    """v at which the stress that opposes motion is the spring's, from another, by bisection.

    Where there is none, a speed beyond all: friction that no longer rises with speed.
    """
    pulls = force(run, l, v) > 0.0
    reach = 1.0
    while reach < WIDEST:
        beyond = v + reach if pulls else v - reach
        if (force(run, l, beyond) > 0.0) != pulls:
            break
        reach *= 2.0
    low, high = (v, v + reach) if pulls else (v - reach, v)
    for _ in range(MOST):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if force(run, l, middle) > 0.0:
            low = middle
        else:
            high = middle
    return low
