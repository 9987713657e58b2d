"""The layout of the lane buffer, and calls of the units that work on it.

A lane is a column of the buffer `s`, a flat array in which row R of lane l is ``s[R + l]``.  The
buffer is one array with constant row offsets, not an array for each row.  So LLVM can see that no
row aliases another, and vectorises.  The number of some rows depends on the law, as `rows_of` lists
them.  In units these offsets are constants; the control reads them from `Shape`.
"""

import functools
import itertools
from collections import namedtuple
from typing import Any, NamedTuple

from .machine_code import doubles_of_vector

LANES = 16
#: lanes of a vector; a slider alone is computed with vectors of 1
WIDTH = doubles_of_vector()
RODAS5P_TERMS = 5  # coefficients of the dense output of Rodas5P, for each variable
ORDER = 12  # of the Taylor method: degree of its polynomials in time
RING = 64  # number of returns whose stress maxima, minima and durations a march keeps
COMMON_ROWS = 71

# fmt: off
(
    RING_COLUMN,                            # column that keeps the slider's returns (`highs`)
    X, V, W,                                # stress, ln w, w
    KAPPA, ETA0,                            # parameters (model.py)
    W_LP, RAMP,                             # load point: speed, its rate
    T, T_LOW, BREAKPOINT, H,                # time in two parts, next breakpoint, next step size
    TOLERANCE, MEMORY,                      # of x, v and psi; err**(1/16) of last accepted step
    SAVE_AT, V_LIMIT, STEADY,               # next saved time, runaway ln w, steady-state tolerance
    OBSERVE, EVERY_STEP,                    # 1 if extremes are wanted; if CALL is for each step
    X_NEW, V_NEW, W_NEW,                    # state at the end of the step
    D_LOAD, D_FRICTION,                     # works in the step
    ERROR, H_USED, H_NEXT, MEMORY_NEW,      # for step control
    OK, CALL, BAD, BREAK,                   # 1 if accepted; to be handled; not finite; at a break
    EVENTS,                                 # events in the step, as a sum of `BITS`
    TAYLOR, CHANGES,                        # 1 for Taylor steps; 1 if the next method is the other
    LIMITED,                                # steps in a row whose length stability has limited
    FREQUENCY, RATE,                        # of free vibration, sqrt(kappa/eta0); fastest rate
    LOAD_WORK, DISSIPATION,                 # accumulated works
    STEPS, REJECTED, FAILURES,              # counts; rejections in a row
    V_HIGH, V_LOW, G_HIGH,                  # extremes of ln w and |g|
    F_LOW, XF_LOW,                          # smallest friction f and x + N (model.py)
    X_LOW,                                  # last stress minimum
    STATUS, CASE, MAX_STEPS,
    # only for a march:
    CROSS_T, CROSS_T_LOW,                   # time in two parts of the last rise of V through V_lp
    CYCLES,                                 # number of returns
    SEGMENT, SAVED, T_END,
    # only for a return map:
    UNSTABLE,                               # 1 if steady sliding is unstable
    TRACE, D_TRACE,                         # integral of the trace of J; its part in the step
    SINCE_CROSSING,                         # steps since the last crossing of the section
    LANDING_STEP, H_PLANNED,                # length of a step cut at a crossing; H_NEXT before
    PERIOD_GUESS,                           # period assumed for the waveform; > 0 if known
    SLOW, MEAN, SQUARE, COSINE, SINE,       # integrals of the waveform
    SLOW_PART,                              # fraction of the step that is slow
) = range(0, COMMON_ROWS * LANES, LANES)
# fmt: on

#: bits of EVENTS: extremes of V, |g|, f and x + N; V may reach V_lp and turn back; the step ends
#: beyond the speed limit; the step ends in steady sliding
BITS = V_EXTREME, G_EXTREME, F_EXTREME, XF_EXTREME, GRAZES, OVER_V_LIMIT, IS_STEADY = [
    2**k for k in range(7)
]


class LawRows(NamedTuple):
    """Rows whose number depends on the law; an int is the first of several rows.

    y is the state (x, v, psi), with one psi for each state variable of the law.
    """

    p: tuple  # the law's coefficients
    history: tuple  # the last of p, if normal stress varies
    e: tuple  # the law's exponentials at the start of a step
    e_new: tuple  # and at the end
    psi: tuple
    y: tuple  # at the start of a step
    y_new: tuple  # and at the end
    steady: tuple  # y of steady sliding, to which STEADY is the largest distance
    # only for a return map: perturbations, one more than the law has state variables
    z: tuple  # a tuple for each perturbation
    shifts: tuple  # removed shift of each perturbation along the orbit: > 0 if earlier
    x_low: tuple  # change of the stress minimum by each perturbation
    v_high: tuple  # change of the extremes of v
    v_low: tuple
    z_new: tuple  # z at the end of a step; no row from here on is used after the step
    c: tuple  # dense output: coefficients of each of y, `ORDER` + 1 if the law has recurrences,
    # else `RODAS5P_TERMS`
    c_z: tuple  # dense output of each number of z, if the law has recurrences; directly after c
    # only for a march: stress maximum, preceding minimum and duration of each return, in a ring.
    # They stay in the column RING_COLUMN when the slider moves to another column (control.py).
    highs: int
    lows: int
    durations: int
    size: int  # of the buffer


# Numbers of psi, of p, and of coefficients in each of c and c_z; 1 if normal stress varies, if
# K = inf.
COUNTS = ["states", "coefficients", "terms", "varies", "rigid"]
#: numbers that the control needs of a law: `COUNTS`, and the first row of each kind (`LawRows`)
# (mypy cannot read these names)
Shape: Any = namedtuple("Shape", [*COUNTS, *LawRows._fields])  # type: ignore[misc]


@functools.cache
def shape_of(law):
    """Return the `Shape` of a law for a slider on a spring."""
    rows = rows_of(law)
    counts = len(law.states), len(rows.p), len(rows.c[0])
    return Shape._make((*counts, int(len(rows.history) > 0), 0, *map(_first, rows)))


def _first(rows):
    """Return the first of consecutive rows; 0 if there are none."""
    while isinstance(rows, tuple):
        rows = rows[0] if rows else 0
    return rows


def y_row(shape, k):
    """Return the row of number k of the state (x, v, psi...)."""
    return X + k * LANES if k < 2 else shape.psi + (k - 2) * LANES


@functools.cache
def rows_of(law):
    """Return the `LawRows` of a law."""
    offsets = itertools.count(COMMON_ROWS * LANES, LANES)

    def reserve(n):
        return tuple(itertools.islice(offsets, n))

    n, ring = len(law.states), RING * LANES
    terms = ORDER + 1 if law.has_recurrences else RODAS5P_TERMS
    terms_z = terms if terms > RODAS5P_TERMS else 0
    return LawRows(
        p=(p := reserve(law.n_coefficients)),
        history=law.history(p),
        e=reserve(law.n_stored),
        e_new=reserve(law.n_stored),
        psi=(psi := reserve(n)),
        y=(X, V, *psi),
        y_new=(X_NEW, V_NEW, *reserve(n)),
        steady=reserve(2 + n),
        z=tuple(reserve(2 + n) for _ in range(n + 1)),
        shifts=reserve(n + 1),
        x_low=reserve(n + 1),
        v_high=reserve(n + 1),
        v_low=reserve(n + 1),
        z_new=tuple(reserve(2 + n) for _ in range(n + 1)),
        c=tuple(reserve(terms) for _ in range(2 + n)),
        c_z=tuple(reserve(terms_z) for _ in range((2 + n) * (n + 1))),
        highs=(highs := next(offsets)),
        lows=highs + ring,
        durations=highs + 2 * ring,
        size=highs + 3 * ring,
    )


def read_rows(s, rows, l):
    return tuple(s[row + l] for row in rows)


def write_rows(s, rows, l, values):
    """Write values into these rows of lane l; surplus rows stay as they are."""
    for row, value in zip(rows, values, strict=False):
        s[row + l] = value


def load_each(s, rows, l):
    """Return the numbers in tuples of rows of lane l."""
    return tuple(read_rows(s, group, l) for group in rows)


def store_each(s, rows, l, values):
    """Write tuples of values into tuples of rows of lane l."""
    for group, numbers in zip(rows, values, strict=True):
        write_rows(s, group, l, numbers)


# The control calls a law's units (units.py) by these functions.  In compiled code a unit is an
# address (compiler.py).  In Python it is a function of these arguments.

#: index in `work` at which the output of a unit of one lane begins; the input begins at 0
OUTPUT = 8
#: length of `work`
WORK_SIZE = 64


def call_lanes(unit, s, first, n):
    """Call a unit of lanes for n lanes, in whole vectors, from the column `first` on."""
    for l in range(first, first + n):
        unit(s, l)


def call_point(unit, s, l, work):
    """Call a unit of one lane; `work` holds its input, and from OUTPUT on its output."""
    unit(s, l, work)


def add(array, k, x):
    """Add x to item k of an array that threads share; return the previous value."""
    previous = array[k]
    array[k] += x
    return previous
