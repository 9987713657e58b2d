"""The return map: from a point of the section V = V_lp to the next, with its derivative.

Speeds are in units of a constant V_lp and times in Dc/V_lp, so the section is w = 1: v = 0, where v
is ln(V/V_lp), but v = mu/a under regularized friction.  On it dx/dT vanishes: an upward crossing is
a maximum of the stress and the point to return to, a downward one its minimum.
"""

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from . import lanes as L
from . import rows as R
from .jit import inner, kernel, recursive
from .lane_case import IDLE, choose_first_step, enter_inertia, fill, next_case, stuck
from .lane_sets import any_changes, change_sets, next_set, room
from .model import RUNNING
from .return_events import handle_events, rates
from .return_lanes import changes_of_speed, commit
from .return_taylor_lanes import advance
from .rows import rows_of
from .tuples import dot_onto, load_each, load_rows, of_each, plus, read_rows, times, write
from .waveform import add_rodas5p, add_taylor, find_slow_lanes


class Starts(NamedTuple):
    """From where each slider sets out; arrays of one value a case unless a shape is given."""

    kappa: np.ndarray
    p: np.ndarray  # (n, number of coefficients) of the law
    eta: np.ndarray
    y: np.ndarray  # (n, len(y)) x, v, psi
    along: np.ndarray  # (n, len(y) - 1, len(y)) perturbations of it
    steady: np.ndarray  # (n, len(y)) steady sliding
    unstable: np.ndarray  # 1 where steady sliding is
    atol: np.ndarray  # of a step in x, v and psi
    steady_tol: np.ndarray
    observe: np.ndarray  # 1 where extremes are wanted
    period: np.ndarray  # assumed for the waveform; all 0 if none is wanted
    v_limit: np.ndarray  # ln(V/V_lp) beyond which an orbit that does not turn back has run away
    max_steps: np.ndarray


class ReturnResults(NamedTuple):
    """Where each slider came back to the section, and what happened on the way.

    Where the status is not FINISHED, the numbers are those of where it stopped.
    """

    numbers: np.ndarray  # (n, len(RETURN_NUMBERS))
    psi: np.ndarray  # (n, number of states)
    along: np.ndarray  # (n, perturbations, len(DERIVATIVES)): derivatives along each
    psi_along: np.ndarray  # (n, perturbations, number of states)
    status: np.ndarray  # (n,) int8


#: Dimensionless; G is d ln V/dT at the return, v_max and v_min are v, at psi = 0, of the extreme
#: speeds (ln(V/V_lp), but mu/a under regularized friction), slow is the time below V_lp/10, and the
#: four after it integrals over T of x, x^2, x cos and x sin (2 pi T/`Starts.period`).  x_low is NaN
#: without a stress minimum.  Where `Starts.observe` is 0, extremes are those of the ends of steps;
#: without a waveform slow and the integrals are 0.
ReturnNumbers = namedtuple(
    "ReturnNumbers",
    "period x G x_low trace v_max v_min g_max slow mean square cosine sine steps f_min xf_min",
)
RETURN_NUMBERS = ReturnNumbers._fields
#: those of which the derivatives are found
Derivatives = namedtuple("Derivatives", "period x x_low v_max v_min")
DERIVATIVES = Derivatives._fields


def empty_return_results(y):
    """`ReturnResults` of cases that are to run from y: NaN, status RUNNING."""
    n, size = y.shape
    shapes = (len(RETURN_NUMBERS),), (size - 2,), (size - 1, len(DERIVATIVES)), (size - 1, size - 2)
    numbers, psi, along, psi_along = (np.full((n, *shape), np.nan) for shape in shapes)
    return ReturnResults(numbers, psi, along, psi_along, np.full(n, RUNNING, np.int8))


@inner
def load(s, l, law, i, starts):
    """Put case i into lane l."""
    rows = rows_of(law)
    fill(s, l, law, i, starts)
    enter_inertia(s, l, starts.eta[i], starts.atol[i])
    for k in range(len(rows.z)):
        load_rows(s, rows.z[k], l, starts.along[i, k])
    load_rows(s, rows.steady, l, starts.steady[i])
    s[R.UNSTABLE + l] = starts.unstable[i]
    s[R.W_LP + l] = 1.0
    s[R.T_END + l] = s[R.BREAKPOINT + l] = s[R.SAVE_AT + l] = math.inf
    s[R.STEADY + l], s[R.GUESS + l] = starts.steady_tol[i], starts.period[i]
    s[R.X_LOW + l] = math.nan
    for row in rows.x_low:
        s[row + l] = math.nan
    # SINCE is 0: the first step is too short to reach a crossing.  If it begins on the section,
    # rounding may put V below V_lp there.
    choose_first_step(s, l, law)


@recursive
def write_psi_along(z, shifts, f_psi, out):
    """Write the derivatives of psi at the return along each of the perturbations z."""
    if len(z) > 0:
        write(out[0], 0, plus(z[0][2:], -shifts[0], f_psi))
        write_psi_along(z[1:], shifts[1:], f_psi, out[1:])


@inner
def finish(s, l, law, results):
    """Write the outcome of the lane's case; derivatives are those of the section's points."""
    i = int(s[R.CASE + l])
    status = int(s[R.STATUS + l])
    results.status[i] = status if status != RUNNING else stuck(s, l)
    rows = rows_of(law)
    y, e, p = read_rows(s, rows.y, l), read_rows(s, rows.e, l), read_rows(s, rows.p, l)
    speeds = rates(s, l, law, y, s[R.W + l], e)
    shares = law.shares(s[R.W + l], 1.0 / law.speed_slope(s[R.W + l], e), p)
    omega = dot_onto(speeds[1], shares, speeds[2:])
    numbers = ReturnNumbers(
        period=s[R.T + l] + s[R.T_LOW + l],
        x=y[0],
        G=omega * law.speed_slope(s[R.W + l], e),
        x_low=s[R.X_LOW + l],
        trace=s[R.TRACE + l],
        v_max=law.v_of_order(s[R.V_HIGH + l], y[2:], p),
        v_min=law.v_of_order(s[R.V_LOW + l], y[2:], p),
        g_max=s[R.G_HIGH + l],
        slow=s[R.SLOW + l],
        mean=s[R.MEAN + l],
        square=s[R.SQUARE + l],
        cosine=s[R.COSINE + l],
        sine=s[R.SINE + l],
        steps=s[R.STEPS + l] + s[R.REJECTED + l],
        f_min=s[R.F_LOW + l],
        xf_min=s[R.XF_LOW + l],
    )
    for k in range(len(numbers)):
        results.numbers[i, k] = numbers[k]
    write(results.psi[i], 0, y[2:])
    z = load_each(s, rows.z, l)
    shifts = times(1.0 / omega, changes_of_speed(z, shares))
    early = read_rows(s, rows.early, l)
    derivatives = Derivatives(
        period=times(-1.0, plus(shifts, 1.0, early)),
        x=of_each(z, 0),
        x_low=read_rows(s, rows.x_low, l),
        v_max=read_rows(s, rows.v_high, l),
        v_min=read_rows(s, rows.v_low, l),
    )
    for k in range(len(derivatives)):
        write(results.along[i, :, k], 0, derivatives[k])
    write_psi_along(z, shifts, speeds[2:], results.psi_along[i])
    s[R.CASE + l] = IDLE


@kernel
def march_to_section(law, taylor, s, queue, position, starts, results, budget):
    """Take the cases of a queue to their next upward crossing of the section; whether all are done.

    Parameters as for `march.march`.
    """
    rows = rows_of(law)
    capacity = 2 * R.LANES if taylor else R.LANES
    first, n, lanes = 0, 0, s[: rows.size]
    vacant = regroup = True
    waveform = starts.period[0] > 0.0
    for _ in range(budget):
        if vacant:
            while position[0] - position[1] < capacity:
                i = next_case(queue, position)
                if i < 0:
                    break
                load(s, room(s, law, 0.0), law, i, starts)
            vacant = False
        if regroup:
            first, n = next_set(s, law, taylor)
            if n == 0:
                return True
            lanes, regroup = s[first : first + rows.size], False
        advance(rows.c[0], lanes, law, n, first > 0)
        if waveform:
            find_slow_lanes(lanes, n)
        for l in range(first, first + R.WIDTH * n):
            if s[R.CALL + l] > 0.0 and s[R.CASE + l] != IDLE:
                handle_events(s, l, law)
        L.commit(lanes, law, n)
        commit(lanes, law, n)
        if waveform and first > 0:
            add_taylor(lanes, law, n)
        elif waveform:
            add_rodas5p(lanes, law, n)
        for l in range(first, first + R.WIDTH * n):
            if s[R.BREAK + l] > 0.0 and s[R.CASE + l] != IDLE:
                finish(s, l, law, results)
                position[1] += 1
                vacant = regroup = True
        if taylor and (vacant or any_changes(lanes, n)):
            change_sets(s, law, first)
            regroup = True
    return False
