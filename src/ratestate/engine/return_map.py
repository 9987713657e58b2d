"""The return map: from a point of the section V = V_lp to the next, with its derivative.

Speeds are in units of a constant V_lp and times in Dc/V_lp, so the section is w = 1: v = 0, where v
is ln(V/V_lp), but v = mu/a under regularized friction.  On it dx/dT vanishes: an upward crossing is
a maximum of the stress and the point to return to, a downward one its minimum.
"""

import math
from collections import namedtuple
from typing import Any, NamedTuple

import numpy as np

from . import rows as R
from .calls import FOUND, call_lanes, call_point
from .lane_case import IDLE, fill, next_case, stuck
from .lane_sets import any_changes, change_sets, next_set, room
from .model import RUNNING
from .return_events import handle_events


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


class ReturnRun(NamedTuple):
    """All that a return map works on, as `march.Run`."""

    shape: R.Shape
    units: Any  # `units.ReturnUnits`
    taylor: int
    s: np.ndarray
    queue: np.ndarray
    position: np.ndarray
    work: np.ndarray
    starts: Starts
    results: ReturnResults


def load(run, l, i):
    """Put case i into lane l."""
    s, shape, starts = run.s, run.shape, run.starts
    n = 2 + shape.states
    fill(run, l, i, starts, starts.eta[i], starts.atol[i])
    for k in range(n):
        s[shape.steady + k * R.LANES + l] = starts.steady[i, k]
        for j in range(n - 1):
            s[shape.z + (j * n + k) * R.LANES + l] = starts.along[i, j, k]
    s[R.UNSTABLE + l], s[R.W_LP + l] = starts.unstable[i], 1.0
    s[R.T_END + l] = s[R.BREAKPOINT + l] = s[R.SAVE_AT + l] = math.inf
    s[R.STEADY + l], s[R.GUESS + l] = starts.steady_tol[i], starts.period[i]
    s[R.X_LOW + l] = math.nan
    for j in range(n - 1):
        s[shape.x_low + j * R.LANES + l] = math.nan
    # SINCE is 0: the first step is too short to reach a crossing.  If it begins on the section,
    # rounding may put V below V_lp there.
    call_point(run.units.first_step, s, l, run.work)


def finish(run, l):
    """Write the outcome of the lane's case; derivatives are those of the section's points."""
    s, shape, results, work = run.s, run.shape, run.results, run.work
    i, status, states = int(s[R.CASE + l]), int(s[R.STATUS + l]), shape.states
    results.status[i] = status if status != RUNNING else stuck(s, l)
    call_point(run.units.outcome, s, l, work)
    numbers = ReturnNumbers(
        period=s[R.T + l] + s[R.T_LOW + l],
        x=s[R.X + l],
        G=work[FOUND],
        x_low=s[R.X_LOW + l],
        trace=s[R.TRACE + l],
        v_max=work[FOUND + 1],
        v_min=work[FOUND + 2],
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
    k = 0
    for number in numbers:
        results.numbers[i, k] = number
        k += 1
    for j in range(states + 1):
        z = shape.z + j * (2 + states) * R.LANES + l
        shift = work[FOUND + 3 + j]  # in time, to the section
        results.along[i, j, 0] = -(shift + s[shape.early + j * R.LANES + l])
        results.along[i, j, 1] = s[z]
        results.along[i, j, 2] = s[shape.x_low + j * R.LANES + l]
        results.along[i, j, 3] = s[shape.v_high + j * R.LANES + l]
        results.along[i, j, 4] = s[shape.v_low + j * R.LANES + l]
        for k in range(states):
            rate = work[FOUND + 4 + states + k]
            results.psi_along[i, j, k] = s[z + (2 + k) * R.LANES] - shift * rate
    for k in range(states):
        results.psi[i, k] = s[R.y_row(shape, 2 + k) + l]
    s[R.CASE + l] = IDLE


def march_to_section(run, budget):
    """Take the cases of a queue to their next upward crossing of the section; whether all are done.

    budget : int, sweeps over the lanes
    """
    s, shape, units, position = run.s, run.shape, run.units, run.position
    capacity = 2 * R.LANES if run.taylor else R.LANES
    first, n = 0, 0
    vacant = regroup = True
    waveform = run.starts.period[0] > 0.0
    for _ in range(budget):
        if vacant:
            while position[0] - position[1] < capacity:
                i = next_case(run.queue, position)
                if i < 0:
                    break
                load(run, room(s, shape, 0.0), i)
            vacant = False
        if regroup:
            first, n = next_set(s, shape, run.taylor)
            if n == 0:
                return True
            regroup = False
        call_lanes(units.taylor if first > 0 else units.step, s, first, n)
        if waveform:
            call_lanes(units.find_slow, s, first, n)
        for l in range(first, first + R.WIDTH * n):
            if s[R.CALL + l] > 0.0 and s[R.CASE + l] != IDLE:
                handle_events(run, l)
        call_lanes(units.commit, s, first, n)
        if waveform:
            call_lanes(units.add_taylor if first > 0 else units.add_rodas5p, s, first, n)
        for l in range(first, first + R.WIDTH * n):
            if s[R.BREAK + l] > 0.0 and s[R.CASE + l] != IDLE:
                finish(run, l)
                position[1] += 1
                vacant = regroup = True
        if run.taylor and (vacant or any_changes(s, first, n)):
            change_sets(s, shape, first)
            regroup = True
    return False
