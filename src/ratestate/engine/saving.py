"""What a march keeps of a motion: states at saved times, or a path, its own steps."""

import math

from . import rows as R
from .calls import FOUND, call_point
from .dense_output import state_at

#: points of a path in a step of the Taylor method: its ends are too few to draw or to interpolate
POINTS = 8


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
        state_at(run, l, at, work, 1)
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
    if s[R.OK + l] == 0.0:
        return
    for j in range(1, POINTS):
        at, row = j / POINTS, run.position[2]
        path[row, 0] = s[R.T + l] + (s[R.T_LOW + l] + at * s[R.H_USED + l])
        state_at(run, l, at, run.work, 0)
        for k in range(2 + run.shape.states):
            path[row, 1 + k] = run.work[k]
        run.position[2] += 1
