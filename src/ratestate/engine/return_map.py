"""The return map: from a point of the section V = V_lp to the next, with its derivative.

Speeds are in units of a constant V_lp and times in Dc/V_lp, so the section is w = 1: v = 0, where v
is ln(V/V_lp), but v = mu/a under regularized friction.  On it dx/dT vanishes: an upward crossing is
a maximum of the stress and the point to return to, a downward one its minimum.

A step that holds a crossing of the section is taken back, and repeated to end there: so the map
is as accurate as the steps are.
"""

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from . import events
from . import rows as R
from .control import Kernel, fill, leave, stuck
from .model import FINISHED, RUNAWAY, RUNNING, STEADY_SLIDING
from .rows import FOUND, call_lanes, call_point
from .units import ReturnUnits
from .waveform import SLOW_BELOW

# A crossing nearer to the start of a step than this part of it is landed on by extrapolation.
NEAREST = 1e-6
SECTION, SLOW = (1.0, 0.0), (SLOW_BELOW, 0.0)


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
    period: np.ndarray  # assumed for the waveform; not > 0 if none is known
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
    status: np.ndarray  # (n,)


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
DERIVATIVES = "period", "x", "x_low", "v_max", "v_min"


def empty_return_results(y):
    """`ReturnResults` of cases that are to run from y: NaN, status RUNNING."""
    n, size = y.shape
    shapes = (len(RETURN_NUMBERS),), (size - 2,), (size - 1, len(DERIVATIVES)), (size - 1, size - 2)
    numbers, psi, along, psi_along = (np.full((n, *shape), np.nan) for shape in shapes)
    return ReturnResults(numbers, psi, along, psi_along, np.full(n, RUNNING))


def load(run, l, i):
    """Put case i into lane l."""
    s, shape, starts = run.s, run.shape, run.cases
    n = 2 + shape.states
    fill(run, l, i, starts.eta[i], starts.atol[i])
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


def end(run, l):
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
    for j in range(states + 1):
        z = shape.z + j * (2 + states) * R.LANES + l
        shift = work[FOUND + 3 + j]  # in time, to the section
        at = j * R.LANES + l
        high, low = s[shape.v_high + at], s[shape.v_low + at]
        results.along[i, j] = -(shift + s[shape.early + at]), s[z], s[shape.x_low + at], high, low
        for k in range(states):
            rate = work[FOUND + 4 + states + k]
            results.psi_along[i, j, k] = s[z + (2 + k) * R.LANES] - shift * rate
    for k in range(states):
        results.psi[i, k] = s[R.y_row(shape, 2 + k) + l]
    leave(run, l, numbers)


def commit(run, first, n, taylor):
    """Commit steps, and add them to the integrals of the waveform if it is wanted."""
    s, units = run.s, run.units
    call_lanes(units.commit, s, first, n)
    if run.waveform > 0:
        if taylor:
            call_lanes(units.add_taylor, s, first, n)
        else:
            call_lanes(units.add_rodas5p, s, first, n)


# What happens inside an accepted step


def split(run, l):
    """Set SLOW_PART, where it is wanted, if the step crosses the speed that is slow."""
    s = run.s
    slow = s[R.W_NEW + l] < SLOW_BELOW
    if s[R.GUESS + l] > 0.0 and slow != (s[R.W + l] < SLOW_BELOW):
        at = events.crossing(run, l, SLOW, 0.0, 1.0)
        s[R.SLOW_PART + l] = 1.0 - at if slow else at


def end_at_crossing(run, l):
    """Move the end of a step that was cut at a crossing onto the section, and record it."""
    s, shape = run.s, run.shape
    call_point(run.units.land, s, l, run.work)
    s[R.H_NEXT + l] = s[R.H_PLANNED + l]
    s[R.LANDING_STEP + l], s[R.SINCE + l] = 0.0, -1.0  # 0 once this step is committed
    s[R.EVERY_STEP + l] = 0.0
    if s[R.W + l] < 1.0:  # it rises
        s[R.STATUS + l] = FINISHED
    else:
        s[R.X_LOW + l] = s[R.X_NEW + l]
        for j in range(shape.states + 1):
            of_x = s[shape.z_new + j * (2 + shape.states) * R.LANES + l]
            s[shape.x_low + j * R.LANES + l] = of_x


def perturbed(run, l, at, row):
    """Put the perturbations of the speed at a place in the step into rows: `changes_of_order`.

    By the dense output of the Taylor method; that of Rodas5P has none of perturbations, and its
    step is repeated.

    row : the first of them
    """
    s, shape, work = run.s, run.shape, run.work
    n = 2 + shape.states
    if s[R.TAYLOR + l] > 0.0:
        events.state_at(run, l, at, work, 0)
        for i in range(n, n * n):
            work[i], _ = events.component(run, l, i, at)
        call_point(run.units.perturbed_taylor, s, l, work)
    else:
        work[0] = at
        call_point(run.units.perturbed, s, l, work)
    for j in range(n - 1):
        s[row + j * R.LANES + l] = work[FOUND + j]


def observe_step(run, l):
    """`observe`, with the derivatives of what it finds of V.

    They are those of V at that time: where it is extreme, a shift along the orbit does not count.
    Where V stops falling at once, as at a sudden arrest, they hang on where in the step that is
    thought to be, and may be off by a factor of 4.
    """
    s, shape = run.s, run.shape
    high, low = s[R.V_HIGH + l], s[R.V_LOW + l]
    at = events.observe(run, l)
    if s[R.V_HIGH + l] > high:
        perturbed(run, l, at, shape.v_high)
    elif s[R.V_LOW + l] < low:
        perturbed(run, l, at, shape.v_low)


def handle(run, l):
    """Record what happens in the lane's step, or take it back, to end it at a crossing."""
    s = run.s
    split(run, l)
    landing_step = s[R.LANDING_STEP + l]
    if landing_step > 0.0 and s[R.H_USED + l] >= landing_step:
        if s[R.OBSERVE + l] > 0.0:
            observe_step(run, l)
        end_at_crossing(run, l)
        return
    s[R.LANDING_STEP + l] = 0.0
    rises = s[R.W_NEW + l] >= 1.0
    if (s[R.W + l] < 1.0) == rises and s[R.SINCE + l] > 0.0:
        at = max(events.crossing(run, l, SECTION, 0.0, 1.0), NEAREST)
        s[R.H_PLANNED + l] = s[R.H_NEXT + l]
        s[R.H_NEXT + l] = s[R.LANDING_STEP + l] = at * s[R.H_USED + l]
        s[R.EVERY_STEP + l], s[R.OK + l], s[R.CHANGES + l] = 1.0, 0.0, 0.0
        return
    s[R.EVERY_STEP + l] = 0.0
    if s[R.OBSERVE + l] > 0.0:
        observe_step(run, l)
    found = int(s[R.EVENTS + l])
    if found & R.BEYOND > 0:
        # Where steady sliding is unstable what turns back once more runs away at last.
        if s[R.UNSTABLE + l] > 0.0:
            s[R.STATUS + l] = RUNAWAY
        else:
            call_point(run.units.outrun, s, l, run.work)
    elif found & R.STEADIES > 0:
        s[R.STATUS + l] = STEADY_SLIDING


RETURN_MAP = Kernel(ReturnUnits, load, handle, commit, end)
