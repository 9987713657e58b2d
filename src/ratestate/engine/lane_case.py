"""The case in a lane: taken from a queue, its state and first step, and why it cannot go on."""

import math

from ..friction.functions import sqrt
from . import rows as R
from .calls import call_point
from .lanes import TOO_MANY_FAILURES
from .model import NOT_FINITE, RUNNING, STEP_LIMIT, STEP_UNDERFLOW

# Most error of a step if K = inf: small steps cost little where only states evolve.
TOLERANCE_OF_RIGID = 1e-12
# The case of a lane that is free.
IDLE = -1.0


def next_case(queue, position):
    """Number of the next case of the queue, which so is taken; -1 if there is none."""
    if position[0] == queue.shape[0]:
        return -1
    position[0] += 1
    return queue[position[0] - 1]


def fill(run, l, i, cases, eta0, tolerance):
    """Put what `Cases` and `Starts` have in common of case i into lane l; all else there is 0."""
    s, shape = run.s, run.shape
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


def stuck(s, l):
    """Status of a case given up.

    NOT_FINITE or STEP_UNDERFLOW after too many rejections in a row; else its steps are spent,
    STEP_LIMIT.
    """
    if s[R.FAILURES + l] > TOO_MANY_FAILURES:
        return NOT_FINITE if s[R.BAD + l] > 0.0 else STEP_UNDERFLOW
    return STEP_LIMIT
