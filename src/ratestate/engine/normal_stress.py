"""Normal stress in a lane: its segments, and what happens where it jumps.

For a law under constant normal stress `rows.history` is (), and nothing here is compiled.
"""

import math

from ..friction.kinematics import LIMIT
from ..friction.normal_stress import PHASE, S
from . import rows as R
from .equations import exponentials_alone
from .jit import inner, recursive
from .lane_case import take_note
from .model import NOT_FINITE, RUNAWAY
from .rows import rows_of
from .tuples import read_rows, write_rows

# Parts of sigma by which a segment may begin beside the end of the one before, without a jump.
AGREE = 1e-12
# Widest bracket and most iterations in which a speed is sought.
WIDEST, MOST = 4096.0, 200


@recursive
def enter_stress(history, s, l, law, loads, row, k, sigma, scale):
    """Put the lane's normal stress at the start of segment k; whether it jumps there.

    history : `rows.history`; sigma : initial normal stress [Pa]; scale : V0/Dc
    """
    if len(history) == 0:
        return False
    return _enter(s, l, law, loads, row, k, sigma, scale)


@inner
def _enter(s, l, law, loads, row, k, sigma, scale):
    rows = rows_of(law)
    start, end = loads.sigma[row, k] / sigma, loads.sigma_end[row, k] / sigma
    rate = 0.0
    if end != start:
        rate = (end - start) / ((loads.t[k + 1] - loads.t[k]) * scale)
    p = read_rows(s, rows.p, l)
    before, phase = p[S], p[PHASE]
    p = law.at_time(p, start, rate, phase)
    write_rows(s, rows.history, l, law.history(p))
    if abs(p[S] - before) <= AGREE * p[S]:
        return False
    jump(s, l, law, math.log(p[S] / before))
    return True


@inner
def jump(s, l, law, rise):
    """Change the lane's state as a jump of ln sigma by `rise` changes it."""
    rows = rows_of(law)
    y, e, p = read_rows(s, rows.y, l), read_rows(s, rows.e, l), read_rows(s, rows.p, l)
    w = s[R.W + l]
    psi = law.after_jump(y[1], w, y[2:], e, p, rise)
    v = v_at_speed(law.jump_exponents(y[1], y[2:], p), y[1], w, psi, law, p)
    if s[R.ETA0 + l] == 0.0:
        v = balanced(y[0], v, psi, law, p)
        log_w = law.log_of_faster(v, psi, p)
        if log_w > LIMIT:  # of a slider without mass or damping that nothing holds
            away = law.runs_away(log_w, psi, law.stiffness(s[R.KAPPA + l], p), p)
            s[R.STATUS + l] = RUNAWAY if away else NOT_FINITE
    after = (y[0], v, *psi)
    w, e = exponentials_alone(after, law, p)
    write_rows(s, rows.y, l, after)
    s[R.W + l] = w
    write_rows(s, rows.e, l, e)
    take_note(s, l, law)


@recursive
def v_at_speed(jumps, v, w, psi, law, p):
    """v of the same speed w under another psi; jumps : the law's `jump_exponents`."""
    if len(jumps) == 0:
        return v
    return law.v_at(w, psi, p)


@inner
def force(x, v, psi, law, p):
    """x - S."""
    w, _ = exponentials_alone((x, v, *psi), law, p)
    return x - law.stress_in_v(v, w, psi, p)


@inner
def balanced(x, v, psi, law, p):
    """v at which the stress that opposes motion is the spring's, from another, by bisection.

    Where there is none, a speed beyond all: friction that no longer rises with speed.
    """
    pulls = force(x, v, psi, law, p) > 0.0
    reach = 1.0
    while reach < WIDEST:
        beyond = v + reach if pulls else v - reach
        if (force(x, beyond, psi, law, p) > 0.0) != pulls:
            break
        reach *= 2.0
    low, high = (v, v + reach) if pulls else (v - reach, v)
    for _ in range(MOST):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if force(x, middle, psi, law, p) > 0.0:
            low = middle
        else:
            high = middle
    return low
