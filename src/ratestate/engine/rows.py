"""The layout of the lane buffer, and calls of the units that work on it.

A lane is a column of the buffer `s`, a flat array in which row R of lane l is ``s[R + l]``.  One
buffer with constant row offsets, rather than an array a row, is what lets LLVM see that no row
aliases another, so that it vectorises.  How many rows there are of some kinds depends on the law:
`rows_of` it lists them.  They are constants of its units; the control reads them from `Shape`.
"""

import functools
import itertools
from collections import namedtuple
from typing import Any, NamedTuple

from .machine_code import doubles_of_vector
from .taylor import ORDER, has_recurrences

LANES = 16
#: most lanes that go together; a slider alone takes no more than its own
WIDTH = doubles_of_vector()
OF_RODAS5P = 5  # coefficients of a polynomial over one of its steps
RING = 64  # returns to V = V_lp of which a march keeps stress maxima, minima and durations
COMMON_ROWS = 71

# fmt: off
(
    HOME,                                   # a column that keeps returns (`highs`): each has one
    X, V, W,                                # stress, ln w, w
    KAPPA, ETA0,                            # parameters (model.py)
    W_LP, RAMP,                             # load point: speed, its rate
    T, T_LOW, BREAKPOINT, H,                # time in two parts, next breakpoint, next step size
    TOLERANCE, MEMORY,                      # of x, v and psi; err**(1/16) of the last good step
    SAVE_AT, V_LIMIT, STEADY,               # next saved time, runaway ln w, steady-state tolerance
    OBSERVE, EVERY_STEP,                    # 1 where extremes are wanted; where each step is
    X_NEW, V_NEW, W_NEW,                    # the step's outcome
    D_LOAD, D_FRICTION,                     # its works
    ERROR, H_USED, H_NEXT, MEMORY_NEW,      # for step control
    OK, CALL, BAD, BREAK,                   # 1 if accepted; eventful; not finite; at a break;
    EVENTS,                                 # what the step holds, as a sum of `BITS`
    TAYLOR, CHANGES,                        # 1 where steps are Taylor's; where the next is of the
    LIMITED,                                # other method; steps in a row cut short to be stable
    FREQUENCY, RATE,                        # of free vibrations, sqrt(kappa/eta0); the fastest one
    LOAD_WORK, DISSIPATION,                 # accumulated works
    STEPS, REJECTED, FAILURES,              # counts; rejections in a row
    V_HIGH, V_LOW, G_HIGH,                  # extremes of ln w and |g|
    F_LOW, XF_LOW,                          # smallest friction f and x + N (model.py)
    X_LOW,                                  # last stress minimum
    STATUS, CASE, MAX_STEPS,
    # of a march
    CROSS_T, CROSS_LOW,                     # time in two parts of the last rise of V through V_lp
    CYCLES,                                 # number of returns
    SEGMENT, SAVED, T_END,
    # of a return map
    UNSTABLE,                               # 1 where steady sliding is
    TRACE, D_TRACE,                         # integral of the trace of J; the step's part
    SINCE, LANDING_STEP, H_PLANNED,         # steps since a crossing; length of the step cut to one
    GUESS,                                  # period assumed for the waveform; > 0 if known
    SLOW, MEAN, SQUARE, COSINE, SINE,       # its integrals
    SLOW_PART,                              # how much of the step is slow
) = range(0, COMMON_ROWS * LANES, LANES)
# fmt: on

#: of EVENTS: extremes of V, |g|, f and x + N; V may reach V_lp and turn back; the step ends beyond
#: the limit of speed; in steady sliding
BITS = V_EXTREME, G_EXTREME, F_EXTREME, XF_EXTREME, GRAZES, BEYOND, STEADIES = [
    2**k for k in range(7)
]


class LawRows(NamedTuple):
    """Rows whose number depends on the law: tuples of them, and where some begin.

    y is the state (x, v, psi), with a psi for each of the law's variables.
    """

    p: tuple  # the law's coefficients,
    history: tuple  # and the last of them, if normal stress varies
    e: tuple  # its exponentials, before and after a step
    e_new: tuple
    psi: tuple
    y: tuple  # before and after a step
    y_new: tuple
    steady: tuple  # y of steady sliding, from which STEADY is measured
    # of a return map: one more perturbation of the state than the law has variables
    z: tuple  # each a tuple
    early: tuple  # how much earlier each is: shifts along the orbit
    x_low: tuple  # what each makes of the stress minimum,
    v_high: tuple  # and of the extremes of v
    v_low: tuple
    kept: int  # where those begin that hold nothing between steps
    z_new: tuple  # z after a step
    c: tuple  # dense output of a step, coefficients of each of y: `ORDER` + 1 where the law has
    # recurrences, else `OF_RODAS5P`
    c_z: tuple  # directly behind, if the law has recurrences, those of each number of z
    # of a march: of each return, in turn, its stress maximum, the minimum before, how long it took;
    # these stay in the column HOME where the rest moves to another (control.py)
    highs: int
    lows: int
    spans: int
    size: int  # of the buffer


# How many psi, p, and numbers in each of c and c_z; 1 if slip may reverse, if normal stress varies,
# if K = inf.
COUNTS = ["states", "coefficients", "terms", "reverses", "varies", "rigid"]
#: what the control knows of a law: these, and where the rows of each kind begin (`LawRows`)
# (of names that mypy cannot read)
Shape: Any = namedtuple("Shape", [*COUNTS, *LawRows._fields])  # type: ignore[misc]


@functools.cache
def shape_of(law):
    """`Shape` of a law, on a spring."""
    rows = rows_of(law)
    counts = len(law.states), len(rows.p), len(rows.c[0])
    kinds = int(law.reverses), int(len(rows.history) > 0), 0
    return Shape._make((*counts, *kinds, *map(_first, rows)))


def _first(rows):
    """The first row of a kind, all of which follow each other; 0 if there is none."""
    while isinstance(rows, tuple):
        rows = rows[0] if rows else 0
    return rows


def y_row(shape, k):
    """The row of number k of the state (x, v, psi...)."""
    return X + k * LANES if k < 2 else shape.psi + (k - 2) * LANES


@functools.cache
def rows_of(law):
    """`LawRows` of a law."""
    place = itertools.count(COMMON_ROWS * LANES, LANES)

    def take(n):
        return tuple(itertools.islice(place, n))

    n = len(law.states)
    p, e, e_new = take(law.n_coefficients), take(law.n_stored), take(law.n_stored)
    psi, psi_new, steady = take(n), take(n), take(2 + n)
    z = tuple(take(2 + n) for _ in range(n + 1))
    early, x_low, v_high, v_low = (take(n + 1) for _ in range(4))
    kept = next(place)
    place = itertools.count(kept, LANES)
    z_new = tuple(take(2 + n) for _ in range(n + 1))
    terms = ORDER + 1 if has_recurrences(law) else OF_RODAS5P
    c = tuple(take(terms) for _ in range(2 + n))
    c_z = tuple(take(terms) for one in z for _ in one) if terms > OF_RODAS5P else ()
    highs, ring = next(place), RING * LANES
    return LawRows(
        p=p,
        history=law.history(p),
        e=e,
        e_new=e_new,
        psi=psi,
        y=(X, V, *psi),
        y_new=(X_NEW, V_NEW, *psi_new),
        steady=steady,
        z=z,
        early=early,
        x_low=x_low,
        v_high=v_high,
        v_low=v_low,
        kept=kept,
        z_new=z_new,
        c=c,
        c_z=c_z,
        highs=highs,
        lows=highs + ring,
        spans=highs + 2 * ring,
        size=highs + 3 * ring,
    )


def read_rows(s, rows, l):
    """What stands in these rows of lane l."""
    return tuple(s[row + l] for row in rows)


def write_rows(s, rows, l, values):
    """Put values into these rows of lane l, or the first of them."""
    for row, value in zip(rows, values, strict=False):
        s[row + l] = value


def load_each(s, rows, l):
    """What stands in these tuples of rows of lane l."""
    return tuple(read_rows(s, one, l) for one in rows)


def store_each(s, rows, l, values):
    """Put tuples into these tuples of rows of lane l."""
    for one, of_one in zip(rows, values, strict=True):
        write_rows(s, one, l, of_one)


# Calls of a law's units (units.py) from the control, which is the same for all laws.  In compiled
# code a unit is an address (compiler.py); in Python it is a function of these arguments.

#: places in `work`: what a unit of one lane is given comes first, what it finds begins here
FOUND = 128
#: numbers of `work`
WORK = 160


def call_lanes(unit, s, first, n):
    """Call a unit of lanes for n of them, whole vectors, from the column `first` on."""
    for l in range(first, first + n):
        unit(s, l)


def call_point(unit, s, l, work):
    """Call a unit of the lane l; what it is given stands in `work`, and what it finds after it."""
    unit(s, l, work)


def add(array, k, x):
    """Add x to item k of an array that threads share; return the item before."""
    before = array[k]
    array[k] += x
    return before
