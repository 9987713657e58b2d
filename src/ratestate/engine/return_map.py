"""Compiled return map: from one point of the section V = V_lp to the next.

Speeds are in units of a constant V_lp and times in units of Dc/V_lp, so the section is w = 1.
There v is 0 if v = ln(V/V_lp), but under regularized friction v is mu/a.  At the section dx/dT = 0.
An upward crossing is a stress maximum and ends the return; a downward crossing is a stress minimum.

A step in which V crosses the section is repeated with a length that ends at the crossing.  So the
map is as accurate as the steps.  The derivative of the map is computed along with it.
"""

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from . import rows as R
from . import step_events
from .control import Kernel, close_case, failure_status, fill_lane
from .model import FINISHED, RUNAWAY, RUNNING, STEADY_SLIDING
from .rows import OUTPUT, call_lanes, call_point
from .units import ReturnUnits
from .waveform import SLOW_BELOW

# Smallest length of a step that is repeated to end at a crossing, as a fraction of the step.
NEAREST = 1e-6
SECTION, SLOW = (1.0, 0.0), (SLOW_BELOW, 0.0)


class Starts(NamedTuple):
    """Start of each slider; arrays of one value a case unless a shape is given."""

    kappa: np.ndarray
    p: np.ndarray  # (n, number of coefficients) of the law
    eta: np.ndarray
    y: np.ndarray  # (n, len(y)) x, v, psi
    perturbations: np.ndarray  # (n, len(y) - 1, len(y)) perturbations of y
    steady: np.ndarray  # (n, len(y)) steady sliding
    unstable: np.ndarray  # 1 if steady sliding is unstable
    atol: np.ndarray  # tolerance of a step in x, v and psi
    steady_tol: np.ndarray  # distance from steady sliding below which a slider counts as steady
    observe: np.ndarray  # 1 if extremes are wanted
    period: np.ndarray  # assumed for the waveform; not > 0 if none is known
    v_limit: np.ndarray  # ln(V/V_lp) beyond which an orbit that does not turn back has run away
    max_steps: np.ndarray


class ReturnResults(NamedTuple):
    """Points at which the sliders returned to the section, and numbers of the way there.

    If the status is not FINISHED, the numbers are those at the point where the slider stopped.
    """

    numbers: np.ndarray  # (n, len(RETURN_NUMBERS))
    psi: np.ndarray  # (n, number of states)
    gradients: np.ndarray  # (n, perturbations, len(DERIVATIVES)): along each perturbation
    psi_gradients: np.ndarray  # (n, perturbations, number of states): of psi
    status: np.ndarray  # (n,)


#: Dimensionless numbers of a return.  G is d ln V/dT at the return.  v_max and v_min are v, at
#: psi = 0, at the extreme speeds (ln(V/V_lp), but mu/a under regularized friction).  slow is the
#: time below V_lp/10, followed by the integrals over T of x, x^2, x cos and x sin (2 pi
#: T/`Starts.period`), all 0 without a waveform.  x_low is NaN without a stress minimum.  If
#: `Starts.observe` is 0, extremes are taken over the ends of steps alone.
ReturnNumbers = namedtuple(
    "ReturnNumbers",
    "period x G x_low trace v_max v_min g_max slow mean square cosine sine steps f_min xf_min",
)
RETURN_NUMBERS = ReturnNumbers._fields
#: numbers whose derivatives are computed
DERIVATIVES = "period", "x", "x_low", "v_max", "v_min"


def empty_return_results(y):
    """Return `ReturnResults` before a run from y: NaN, status RUNNING."""
    n, size = y.shape
    shapes = (len(RETURN_NUMBERS),), (size - 2,), (size - 1, len(DERIVATIVES)), (size - 1, size - 2)
    numbers, psi, gradients, psi_gradients = (np.full((n, *shape), np.nan) for shape in shapes)
    return ReturnResults(numbers, psi, gradients, psi_gradients, np.full(n, RUNNING))


def load(run, l, i):
    """Put case i into lane l."""
    s, shape, starts = run.s, run.shape, run.cases
    n = 2 + shape.states
    fill_lane(run, l, i, starts.eta[i], starts.atol[i])
    for k in range(n):
        s[shape.steady + k * R.LANES + l] = starts.steady[i, k]
        for j in range(n - 1):
            s[shape.z + (j * n + k) * R.LANES + l] = starts.perturbations[i, j, k]
    s[R.UNSTABLE + l], s[R.W_LP + l] = starts.unstable[i], 1.0
    s[R.T_END + l] = s[R.BREAKPOINT + l] = s[R.SAVE_AT + l] = math.inf
    s[R.STEADY + l], s[R.PERIOD_GUESS + l] = starts.steady_tol[i], starts.period[i]
    s[R.X_LOW + l] = math.nan
    for j in range(n - 1):
        s[shape.x_low + j * R.LANES + l] = math.nan
    # SINCE_CROSSING is 0, so the first step, which is very short, cannot end at a crossing: if it
    # begins on the section, rounding may put V below V_lp.
    call_point(run.units.first_step, s, l, run.work)


def end(run, l):
    """Store the outcome of the lane's case.

    Derivatives are corrected to points on the section.
    """
    s, shape, results, work = run.s, run.shape, run.results, run.work
    i, status, states = int(s[R.CASE + l]), int(s[R.STATUS + l]), shape.states
    results.status[i] = status if status != RUNNING else failure_status(s, l)
    call_point(run.units.outcome, s, l, work)
    numbers = ReturnNumbers(
        period=s[R.T + l] + s[R.T_LOW + l],
        x=s[R.X + l],
        G=work[OUTPUT],
        x_low=s[R.X_LOW + l],
        trace=s[R.TRACE + l],
        v_max=work[OUTPUT + 1],
        v_min=work[OUTPUT + 2],
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
        dt = work[OUTPUT + 3 + j]  # in time, to the section
        at = j * R.LANES + l
        high, low = s[shape.v_high + at], s[shape.v_low + at]
        results.gradients[i, j] = -(dt + s[shape.shifts + at]), s[z], s[shape.x_low + at], high, low
        for k in range(states):
            rate = work[OUTPUT + 4 + states + k]
            results.psi_gradients[i, j, k] = s[z + (2 + k) * R.LANES] - dt * rate
    for k in range(states):
        results.psi[i, k] = s[R.y_row(shape, 2 + k) + l]
    close_case(run, l, numbers)


def commit(run, first, n, taylor):
    """Commit steps, and add them to the integrals of the waveform if it is wanted."""
    s, units = run.s, run.units
    call_lanes(units.commit, s, first, n)
    if run.waveform > 0:
        if taylor:
            call_lanes(units.add_taylor, s, first, n)
        else:
            call_lanes(units.add_rodas5p, s, first, n)


# Events inside an accepted step


def refine_slow_part(run, l):
    """Set SLOW_PART, if it is wanted and the step crosses the slow limit of speed."""
    s = run.s
    slow = s[R.W_NEW + l] < SLOW_BELOW
    if s[R.PERIOD_GUESS + l] > 0.0 and slow != (s[R.W + l] < SLOW_BELOW):
        fraction = step_events.crossing(run, l, SLOW, 0.0, 1.0)
        s[R.SLOW_PART + l] = 1.0 - fraction if slow else fraction


def end_at_crossing(run, l):
    """Move the end of a step that was cut at a crossing onto the section; record it."""
    s, shape = run.s, run.shape
    call_point(run.units.move_to_section, s, l, run.work)
    s[R.H_NEXT + l] = s[R.H_PLANNED + l]
    s[R.LANDING_STEP + l], s[R.SINCE_CROSSING + l] = 0.0, -1.0  # 0 once this step is committed
    s[R.EVERY_STEP + l] = 0.0
    if s[R.W + l] < 1.0:  # V rises
        s[R.STATUS + l] = FINISHED
    else:
        s[R.X_LOW + l] = s[R.X_NEW + l]
        for j in range(shape.states + 1):
            of_x = s[shape.z_new + j * (2 + shape.states) * R.LANES + l]
            s[shape.x_low + j * R.LANES + l] = of_x


def store_speed_derivatives(run, l, fraction, row):
    """Store the changes of v (`units.v_changes`) by the perturbations at a fraction.

    Taylor steps have dense output of the perturbations.  Rodas5P does not, so its step is repeated.

    row : the first row for the changes
    """
    s, work = run.s, run.work
    work[0] = fraction
    if s[R.TAYLOR + l] > 0.0:
        call_point(run.units.speed_derivatives_taylor, s, l, work)
    else:
        call_point(run.units.speed_derivatives, s, l, work)
    for j in range(run.shape.states + 1):
        s[row + j * R.LANES + l] = work[OUTPUT + j]


def record_extremes(run, l):
    """Record extremes inside the step, and derivatives of the extremes of V.

    The derivatives are taken at a fixed time: at an extreme of V a shift along the orbit has no
    effect.  If V stops falling within the step, as at a sudden arrest, they depend on the exact
    fraction of the step, and may be wrong by a factor of 4.
    """
    s, shape = run.s, run.shape
    high, low = s[R.V_HIGH + l], s[R.V_LOW + l]
    fraction = step_events.record_extremes(run, l)
    if s[R.V_HIGH + l] > high:
        store_speed_derivatives(run, l, fraction, shape.v_high)
    elif s[R.V_LOW + l] < low:
        store_speed_derivatives(run, l, fraction, shape.v_low)


def handle(run, l):
    """Handle the events of the step, or reject it and repeat it to end at a crossing."""
    s = run.s
    refine_slow_part(run, l)
    landing_step = s[R.LANDING_STEP + l]
    if landing_step > 0.0 and s[R.H_USED + l] >= landing_step:
        if s[R.OBSERVE + l] > 0.0:
            record_extremes(run, l)
        end_at_crossing(run, l)
        return
    s[R.LANDING_STEP + l] = 0.0
    is_above = s[R.W_NEW + l] >= 1.0
    if (s[R.W + l] < 1.0) == is_above and s[R.SINCE_CROSSING + l] > 0.0:
        fraction = max(step_events.crossing(run, l, SECTION, 0.0, 1.0), NEAREST)
        s[R.H_PLANNED + l] = s[R.H_NEXT + l]
        s[R.H_NEXT + l] = s[R.LANDING_STEP + l] = fraction * s[R.H_USED + l]
        s[R.EVERY_STEP + l], s[R.OK + l], s[R.CHANGES + l] = 1.0, 0.0, 0.0
        return
    s[R.EVERY_STEP + l] = 0.0
    if s[R.OBSERVE + l] > 0.0:
        record_extremes(run, l)
    event_bits = int(s[R.EVENTS + l])
    if event_bits & R.OVER_V_LIMIT > 0:
        # If steady sliding is unstable, a motion that turns back once more still runs away later.
        if s[R.UNSTABLE + l] > 0.0:
            s[R.STATUS + l] = RUNAWAY
        else:
            call_point(run.units.check_runaway, s, l, run.work)
    elif event_bits & R.IS_STEADY > 0:
        s[R.STATUS + l] = STEADY_SLIDING


RETURN_MAP = Kernel(ReturnUnits, load, handle, commit, end)
