"""Sets of lanes: one for each method of a march, and one in which sliders wait.

A loop over lanes takes steps of one method.  A slider that changes its method moves to the other's
set, or waits until there is room.  With twice as many sliders under way as a set has lanes, one of
the two is always full: the fuller one goes next.

A set is a lane buffer (rows.py) of its own, behind the one before.  So a slider's place is known by
one number, its column: its lane, and where its set begins.
"""

import numpy as np

from . import rows as R
from .lane_case import IDLE

#: sets of a march that may take steps of the Taylor method: for Rodas5P, for these, to wait in
SETS = 3


def idle_lanes(shape, sets):
    """A lane buffer of free lanes, and the columns of each of its sets."""
    s = np.zeros(sets * shape.size)
    columns = np.add.outer(shape.size * np.arange(sets), np.arange(R.LANES))
    s[R.CASE + columns] = IDLE
    s[R.HOME + columns] = columns
    return s, columns


def idle_column(s, first):
    """The first column of a set that holds no slider, or -1."""
    for l in range(first, first + R.LANES):
        if s[R.CASE + l] == IDLE:
            return l
    return -1


def busy_columns(s, first):
    """How many columns of a set hold a slider."""
    busy = 0
    for l in range(first, first + R.LANES):
        busy += s[R.CASE + l] != IDLE
    return busy


def room(s, shape, taylor):
    """A column for one more slider.

    taylor : 1.0 if it takes steps of the Taylor method, 0.0 if of Rodas5P
    """
    l = idle_column(s, shape.size if taylor > 0.0 else 0)
    return l if l >= 0 else idle_column(s, 2 * shape.size)


def next_set(s, shape, taylor):
    """Where the set begins that goes next, and how many vectors of its lanes: 0 without sliders.

    Of the two of the methods, or without `taylor` of the only one, that of which more lanes are
    busy, as a part of those that go.  Its sliders are then in these.
    """
    first, busy = 0, busy_columns(s, 0)
    n = vectors_for(busy)
    if taylor:
        others = busy_columns(s, shape.size)
        n_others = vectors_for(others)
        more = others * n - busy * n_others
        if more > 0 or (more == 0 and others > busy):
            first, n = shape.size, n_others
    for l in range(first + R.WIDTH * n, first + R.LANES):
        if s[R.CASE + l] != IDLE:
            move(s, shape, l, idle_column(s, first))
    return first, n


def vectors_for(busy):
    """How many vectors of lanes go if so many lanes are busy, the first ones."""
    return (busy + R.WIDTH - 1) // R.WIDTH


def move(s, shape, l, to):
    """Move the slider of column l to another, which is idle."""
    for row in range(R.HOME + R.LANES, shape.kept, R.LANES):
        s[row + to] = s[row + l]
    s[R.HOME + l], s[R.HOME + to] = s[R.HOME + to], s[R.HOME + l]
    s[R.CASE + l] = IDLE


def any_changes(s, first, n):
    """Whether a slider in the first n vectors of lanes of a set changes its method."""
    for l in range(first, first + R.WIDTH * n):
        if s[R.CHANGES + l] > 0.0 and s[R.CASE + l] != IDLE:
            return True
    return False


def change_sets(s, shape, first):
    """Move those of a set that change their method, and call in sliders that wait for its lanes."""
    size = shape.size
    taylor = 1.0 if first == size else 0.0
    for l in range(first, first + R.LANES):
        if s[R.CHANGES + l] > 0.0 and s[R.CASE + l] != IDLE:
            s[R.TAYLOR + l] = 1.0 - taylor
            move(s, shape, l, room(s, shape, 1.0 - taylor))
    for l in range(2 * size, 2 * size + R.LANES):
        if s[R.CASE + l] != IDLE and s[R.TAYLOR + l] == taylor:
            to = idle_column(s, first)
            if to < 0:
                break
            move(s, shape, l, to)
