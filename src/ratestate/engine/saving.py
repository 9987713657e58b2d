"""What a march keeps of a motion: states at saved times, or a path, its own steps."""

import math

from . import rows as R
from .dense_output import state
from .jit import inner
from .rows import rows_of
from .tuples import read_rows, write

#: points of a path in a step of the Taylor method: its ends are too few to draw or to interpolate
POINTS = 8


@inner
def await_save(s, l, n, save_times, row, scale):
    """Let saved time n be the next one the lane waits for."""
    s[R.SAVED + l] = n
    s[R.SAVE_AT + l] = save_times[row, n] * scale if n < save_times.shape[1] else math.inf


@inner
def save(s, l, law, cases, save_times, saved):
    """Write the state at each saved time inside the lane's accepted step."""
    i = int(s[R.CASE + l])
    row, scale = cases.times[i], cases.scale[i]
    h = s[R.H_USED + l]
    n = int(s[R.SAVED + l])
    while n < save_times.shape[1]:
        at = ((save_times[row, n] * scale - s[R.T + l]) - s[R.T_LOW + l]) / h
        if at > 1.0:
            break
        at = max(at, 0.0)
        write(saved[i, n], 0, state(s, l, law, at))
        n += 1
    await_save(s, l, n, save_times, row, scale)


@inner
def keep(s, l, law, path, position):
    """Put T, x, v and psi of the lane at the end of a path."""
    path[position[2], 0] = s[R.T + l] + s[R.T_LOW + l]
    write(path[position[2]], 1, read_rows(s, rows_of(law).y, l))
    position[2] += 1


@inner
def keep_inside(s, l, law, path, position):
    """`keep` the motion inside the lane's step of the Taylor method, before it is committed."""
    if s[R.OK + l] == 0.0:
        return
    for k in range(1, POINTS):
        at = k / POINTS
        path[position[2], 0] = s[R.T + l] + (s[R.T_LOW + l] + at * s[R.H_USED + l])
        write(path[position[2]], 1, state(s, l, law, at))
        position[2] += 1
