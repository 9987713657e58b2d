"""The case in a lane: taken from a queue, its state and first step, and why it cannot go on."""

import math

from . import rows as R
from .equations import exponentials_alone
from .jit import inner
from .lanes import TOO_MANY_FAILURES
from .model import NOT_FINITE, RUNNING, STEP_LIMIT, STEP_UNDERFLOW
from .rows import rows_of
from .tuples import load_rows, read_rows, sum_of_sizes, write_rows

# The case of a lane that is free.
IDLE = -1.0


@inner
def next_case(queue, position):
    """Number of the next case of the queue, which so is taken; -1 if there is none."""
    if position[0] == queue.size:
        return -1
    position[0] += 1
    return queue[position[0] - 1]


@inner
def fill(s, l, law, i, cases):
    """Put what `Cases` and `Starts` have in common of case i into lane l; all else there is 0."""
    rows = rows_of(law)
    for row in range(R.HOME + R.LANES, rows.kept, R.LANES):
        s[row + l] = 0.0
    s[R.CASE + l], s[R.STATUS + l] = i, RUNNING
    s[R.KAPPA + l] = cases.kappa[i]
    load_rows(s, rows.p, l, cases.p[i])
    load_rows(s, rows.y, l, cases.y[i])
    p, y = read_rows(s, rows.p, l), read_rows(s, rows.y, l)
    w, e = exponentials_alone(y, law, p)
    s[R.W + l] = w
    write_rows(s, rows.e, l, e)
    s[R.OBSERVE + l], s[R.V_LIMIT + l] = cases.observe[i], law.resolved(cases.v_limit[i], p)
    s[R.MAX_STEPS + l] = cases.max_steps[i]
    s[R.V_HIGH + l], s[R.V_LOW + l] = -math.inf, math.inf
    s[R.F_LOW + l] = s[R.XF_LOW + l] = math.inf
    take_note(s, l, law)


@inner
def enter_inertia(s, l, eta0, tolerance):
    """Set the lane's inertia, and how accurate its steps are to be."""
    s[R.ETA0 + l], s[R.TOLERANCE + l] = eta0, tolerance
    s[R.FREQUENCY + l] = math.sqrt(s[R.KAPPA + l] / eta0) if eta0 > 0.0 else math.inf


@inner
def take_note(s, l, law):
    """Let the extremes of V, |g|, f and x + N be those of the lane's state too."""
    rows = rows_of(law)
    y, w, p = read_rows(s, rows.y, l), s[R.W + l], read_rows(s, rows.p, l)
    speed = law.order_of_speed(y[1], w)
    s[R.V_HIGH + l], s[R.V_LOW + l] = max(s[R.V_HIGH + l], speed), min(s[R.V_LOW + l], speed)
    friction = law.resistance_in_v(y[1], w, y[2:], p)
    strength = law.strength_in_v(y[1], w, y[2:], p)
    s[R.F_LOW + l] = min(s[R.F_LOW + l], friction)
    s[R.XF_LOW + l] = min(s[R.XF_LOW + l], y[0] + strength)
    force = y[0] - law.stress_in_v(y[1], w, y[2:], p)
    s[R.G_HIGH + l] = max(s[R.G_HIGH + l], abs(force))


@inner
def choose_first_step(s, l, law):
    """Set the lane's next step: small beside the time in which the state, or the load, changes."""
    w, w_lp = s[R.W + l], s[R.W_LP + l]
    f_x = s[R.KAPPA + l] * (w_lp - w)
    rows = rows_of(law)
    y, e, p = read_rows(s, rows.y, l), read_rows(s, rows.e, l), read_rows(s, rows.p, l)
    f_psi = law.rates_in_v(y[1], w, y[2:], e, p)
    fastest = abs(f_x) + sum_of_sizes(f_psi) + law.speed_slope(w, e) + abs(w_lp)
    fastest += sum_of_sizes(law.strength_drift(y[1], w, y[2:], p))
    h = 0.1 * math.sqrt(math.sqrt(s[R.TOLERANCE + l])) / fastest
    s[R.H + l], s[R.MEMORY + l] = min(s[R.BREAKPOINT + l] - s[R.T + l], h), 1.0


@inner
def stuck(s, l):
    """Status of a case given up.

    NOT_FINITE or STEP_UNDERFLOW after too many rejections in a row; else its steps are spent,
    STEP_LIMIT.
    """
    if s[R.FAILURES + l] > TOO_MANY_FAILURES:
        return NOT_FINITE if s[R.BAD + l] > 0.0 else STEP_UNDERFLOW
    return STEP_LIMIT
